// Which recordings want the path tracer: pictures of what the fast model of lib/relighting has no light for.
#pragma once
#include <string>
#include <vector>

#include "manifest/sections/forward.h"
#include "scene/scene.h"

namespace gonio::explain::traced {

// Surfaces of objects: glass and other things that light passes, bodies that scatter by a model of their own, metals,
// and what follows a law over the object. Places in scene.appearance.surfaces.
std::vector<std::size_t> surfaces_in_question(const manifest::Document& document, const scene::Scene& scene);

// Has the document recordings of such surfaces, under lamps (surroundings are asked by nobody yet)? By what it says,
// without building the scene.
bool wants_tracing(const manifest::Document& document);
// Of those that the fast model cannot be asked of at all: glass, laws, mirrors, bodies by models of their own.
bool beyond_the_fast_model(const manifest::Document& document);

// Mechanisms of the manifest that act behind the lens (render/link.h), which sampled pixels know nothing of.
std::vector<std::string> behind_the_lens(const manifest::Document& document);
// Error(data) where there is one.
void check_reach(const manifest::Document& document);

}  // namespace gonio::explain::traced
