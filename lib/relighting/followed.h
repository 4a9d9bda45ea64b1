// How far the fast image model follows light at a surface, by what the manifest says of it.
#pragma once
#include <string>

#include "manifest/sections/forward.h"
#include "surface/surface.h"

namespace gonio::relighting {

// fast: as well as a path tracer does; roughly: what it leaves out (lobes of metals seen in each other, bodies that
// scatter beneath) may matter; not_at_all: glass and what else light passes, laws over the object, mirrors, bodies that
// scatter by a model of their own.
enum class Followed { fast, roughly, not_at_all };
Followed followed(const manifest::Document& document, const std::string& surface);

}  // namespace gonio::relighting
