// Arrays of floats as .npy files, piece by piece (NEP 1 of NumPy, version 1.0): what numpy.load(path, mmap_mode="r")
// maps into memory without a copy. The head is padded so that numbers begin at a multiple of 64 bytes.
#pragma once
#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include "base/growing_file.h"

namespace gonio::io {

class NpyWriter {
 public:
  // `size`: last index fastest. 32-bit floats, little endian.
  NpyWriter(const std::filesystem::path& path, const std::vector<std::size_t>& size);
  void append(std::span<const float> numbers);
  void commit();  // Error(internal) unless as many numbers came as the size says

 private:
  GrowingFile file_;
  std::size_t left_ = 1;
};

}  // namespace gonio::io
