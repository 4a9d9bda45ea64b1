// Style and script of the views of points that move (point_motion.h), as text; in pages that have one. Private to
// page.cpp.
#pragma once
#include <string_view>

namespace gonio::report {

extern const std::string_view motion_style, motion_script;

}  // namespace gonio::report
