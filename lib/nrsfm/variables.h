// Variables of .mat, .npz and .npy files as arrays, and how the field names and lays out what it stores. For files.cpp.
#pragma once
#include <Eigen/Core>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <vector>

#include "io/mat.h"
#include "nrsfm/sequence.h"

namespace gonio::nrsfm {

using Notes = std::vector<std::string>;

class Variables {
 public:
  explicit Variables(const std::filesystem::path& file);  // by its extension; Error(data) for others

  const std::string& place() const { return place_; }
  std::string place(const std::string& name) const { return place_ + "#" + name; }
  const io::MatVariable* find(const std::string& name) const;
  // The user's name, which must exist, else the first of `usual` that does; empty: none.
  std::string named(const std::string& given, std::initializer_list<const char*> usual) const;
  std::string list() const;  // of all names, for messages

  // 3F x P; of a 3F x P matrix, a 3 x P x F, F x 3 x P or F x P x 3 array, a list of 3 x P, or a struct array with a
  // field of 3 x P. `by_frame` is told whether it was an array by frames, which stands in cameras by habit.
  Shapes shapes(const std::string& name, bool* by_frame = nullptr) const;
  Tracks tracks(const std::string& name) const;  // likewise with 2, or 3 where homogeneous
  Eigen::MatrixXd matrix(const std::string& name) const;
  double number(const std::string& name) const;
  std::string text(const std::string& name) const;
  Factors factors(const std::string& name) const;

 private:
  const io::MatVariable& at(const std::string& name) const;
  Eigen::MatrixXd rows_by_frame(const std::string& name, Eigen::Index rows, bool* by_frame) const;

  std::string place_;
  io::MatFile variables_;
};

// A matrix of numbers; Error(data) at `place` otherwise.
Eigen::MatrixXd matrix_of(const io::MatVariable& v, const std::string& place);
io::MatVariable variable_of(const Eigen::MatrixXd& m);
io::MatVariable variable_of(const std::string& text);
std::string size_text(const std::vector<std::size_t>& size);  // "3 x 91 x 240"

// Files of a folder or a pattern (frame_*.ply), numbers in their names compared as numbers. Error(no_input): none.
std::vector<std::filesystem::path> files_in_order(const std::filesystem::path& pattern, const std::string& extension);

}  // namespace gonio::nrsfm
