// Numbers in the byte order of the instruments' files, wherever the program runs.
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <string>
#include <string_view>

namespace gonio::io {

// The caller has checked that the bytes are there.
template <class T>
T stored_at(std::string_view file, std::size_t offset) {
  std::array<char, sizeof(T)> bytes{};
  std::memcpy(bytes.data(), file.data() + offset, sizeof(T));
  if constexpr (std::endian::native == std::endian::big) std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<T>(bytes);
}

template <class T>
void store_at(std::string& file, std::size_t offset, T value) {
  auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if constexpr (std::endian::native == std::endian::big) std::reverse(bytes.begin(), bytes.end());
  std::memcpy(file.data() + offset, bytes.data(), sizeof(T));
}

}  // namespace gonio::io
