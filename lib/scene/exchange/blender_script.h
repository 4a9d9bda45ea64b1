// The program that Blender runs to build the scene out of numbers: Python 3 without further modules.
#pragma once
#include <string_view>

namespace gonio::scene {

extern const std::string_view blender_script_head;      // up to the numbers, which follow as JSON in a raw string
extern const std::string_view blender_script_building;  // what makes Blender's objects of them
extern const std::string_view blender_script_rendering;

}  // namespace gonio::scene
