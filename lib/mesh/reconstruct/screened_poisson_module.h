// The module screened_poisson (base/loaded_library.h): PCL's copy of Kazhdan's code.
#pragma once
#include <cstdint>
#include <vector>

extern "C" {
// Six floats a point, position and normal; appended: three floats a vertex, and polygons, each its number of corners
// and these. What bites stands in screened_poisson.cpp.
void gonio_screened_poisson(const std::vector<float>& points, int depth, bool by_length, std::vector<float>& vertices,
                            std::vector<std::uint32_t>& polygons);
}
