// The head of an .npy array: a Python literal with descr, fortran_order and shape. NEP 1 of NumPy has it.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace gonio::io {

struct NpyHead {
  char kind = 0;          // of numbers: f, i, u, b; of text U, S; of objects O
  std::size_t bytes = 0;  // of an element
  bool swapped = false;   // big endian
  bool fortran = false;   // first index fastest
  std::vector<std::size_t> size;
  std::size_t count = 1;
};

// The head at the beginning of `bytes`, which is removed from them. Error(data) at `place`: no array, a head that ends
// early or cannot be read, more than `most_elements` elements.
NpyHead npy_head(std::string_view& bytes, const std::string& place, std::uint64_t most_elements);

[[noreturn]] void refuse_npy(const std::string& place, const std::string& problem,
                             const std::string& hint = "write it anew with numpy.savez");

}  // namespace gonio::io
