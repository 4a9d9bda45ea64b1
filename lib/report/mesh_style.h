// Style and script of the views of surfaces (mesh_view.h), as text; in pages that have one. Private to page.cpp.
#pragma once
#include <string_view>

namespace gonio::report {

extern const std::string_view solid_style, solid_script;

}  // namespace gonio::report
