// A strict reader of MATLAB 5.0 MAT-files as far as recorded tracks need it: little-endian, real arrays of any numeric
// type, struct arrays and cells, compressed elements (zlib, RFC 1950 and 1951). Anything else is refused in words.
// "MAT-File Format", The MathWorks, R2019b, chapter 1.
#pragma once
#include <array>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace gonio::tests {

struct MatArray {
  std::vector<std::size_t> dimensions;
  std::vector<double> numbers;                          // column by column
  std::map<std::string, std::vector<MatArray>> fields;  // of a struct array: one for each of its elements
  std::vector<MatArray> cells;
  std::size_t rows() const { return dimensions.at(0); }
  std::size_t columns() const { return dimensions.at(1); }
  double at(std::size_t row, std::size_t column) const { return numbers.at(column * rows() + row); }
};
// Throws std::runtime_error with the file and what is wrong.
std::map<std::string, MatArray> read_mat(const std::filesystem::path& path);

// One film: pixels and true places in the camera's frame, [frame][point].
struct Film {
  std::vector<std::vector<std::array<double, 2>>> pixels;
  std::vector<std::vector<std::array<double, 3>>> places;
  double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
};
// `data`: p and Pgth; `camera`: a file with K in one of its structs.
Film read_film(const std::filesystem::path& data, const std::filesystem::path& camera);
// The film as a manifest with a table of model "tracks", the camera orthographic with its principal point known;
// places are multiplied by `metres`.
std::string film_manifest(const Film& film, double metres);

}  // namespace gonio::tests
