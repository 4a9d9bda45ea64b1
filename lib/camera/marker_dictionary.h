// Dictionaries of square markers (Garrido-Jurado et al., Pattern Recognition 47, 2014), as OpenCV publishes them.
#pragma once
#include <string>
#include <vector>

namespace gonio::camera {

// "4X4_50" for any of 4X4_50, 4x4_50, DICT_4X4_50. Error(data) at `place` for names that do not exist.
std::string dictionary_name(const std::string& name, const std::string& place);
const std::vector<std::string>& dictionary_names();
int dictionary_size(const std::string& name);  // markers in it; `name` as dictionary_name() returns it

// Cells of a marker with its black border, row by row from the top: true is black. side * side values.
struct MarkerCells {
  int side = 0;
  std::vector<bool> black;
};
MarkerCells marker_cells(const std::string& dictionary, int id);

}  // namespace gonio::camera
