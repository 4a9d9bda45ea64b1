// NumPy archives: arrays of numbers, booleans and text by name.
#pragma once
#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace gonio::io {

// As doubles in C order (last index fastest), whatever order the file has.
struct NpyArray {
  std::vector<std::size_t> size;  // empty: a single number or text
  std::vector<double> values;
  std::string text;  // of a single text
};

// npy format 1 to 3, either order and endianness. Arrays of objects are passed over: they hold Python code.
// Error(no_input), Error(data) where an array has another length than its head says.
std::map<std::string, NpyArray> read_npz(const std::filesystem::path& file);
// One array; false where it is of a kind that is passed over.
bool parse_npy(std::string_view bytes, const std::string& place, NpyArray& out);

}  // namespace gonio::io
