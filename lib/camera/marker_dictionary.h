// Dictionaries of square markers (Garrido-Jurado et al., Pattern Recognition 47, 2014), as OpenCV publishes them; and
// of the user's own, from files as OpenCV writes them:
//   nmarkers: 35
//   markersize: 6
//   maxCorrectionBits: 2            (may be left out)
//   marker_0: "101011..."           markersize^2 cells row by row, 1 is white, without the black border; up to
//   marker_34
// in YAML, or the same keys in JSON.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
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

struct OwnDictionary {
  std::string name;            // of the file, for messages
  std::filesystem::path file;  // empty where it did not come from one
  int side = 0;                // cells along one side, without the border
  std::vector<std::vector<bool>> white;
  // The least number of cells in which two markers differ however they are turned, or one from itself turned; and how
  // many wrong cells are put right: what the file says, but fewer than half the distance.
  int distance = 0, correctable = 0;
};
// Error(data) at `place` for markers that are incomplete, the same up to a turn, or the same as themselves turned.
OwnDictionary parse_dictionary(std::string_view text, const std::string& name, const std::string& place);
std::shared_ptr<const OwnDictionary> read_dictionary(const std::filesystem::path& path);
MarkerCells marker_cells(const OwnDictionary& dictionary, int id);

}  // namespace gonio::camera
