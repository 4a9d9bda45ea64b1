// MATLAB files, version 5 (and 7.3 where libmatio reads it): numbers, text and structs of them.
#pragma once
#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace gonio::io {

// One variable. Numbers of every class are read as doubles, in MATLAB's order (first index fastest).
struct MatVariable {
  enum class Kind { numbers, logical, text, structure, cells };
  Kind kind = Kind::numbers;
  std::vector<std::size_t> size;                             // at least two
  std::vector<double> values;                                // of numbers and logical
  std::string text;                                          // of text (one row)
  std::vector<std::map<std::string, MatVariable>> elements;  // of a structure, one for each element
  std::vector<MatVariable> cells;
};
using MatFile = std::map<std::string, MatVariable>;

// Error(no_input) or Error(data) (truncated, not MATLAB, larger than the file can hold).
MatFile read_mat(const std::filesystem::path& file);
void write_mat(const MatFile& variables, const std::filesystem::path& file);  // v5, compressed, atomic, no date inside

}  // namespace gonio::io
