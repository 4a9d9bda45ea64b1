// Bytes as a file of a volume, for the fuzz targets of its readers: a file in memory, which is opened, read forwards
// and back again. What comes out is a volume of as many voxels as its size says, all of them numbers, or Error(data |
// no_input).
#pragma once
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "io/volume.h"

namespace gonio::fuzz {

class MemoryFile {
 public:
  MemoryFile() : fd_(::memfd_create("volume", 0)) {}
  ~MemoryFile() { ::close(fd_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  std::filesystem::path hold(const std::uint8_t* bytes, std::size_t size) const {
    if (::ftruncate(fd_, 0) != 0 || ::pwrite(fd_, bytes, size, 0) != static_cast<ssize_t>(size)) __builtin_trap();
    return "/proc/self/fd/" + std::to_string(fd_);
  }

 private:
  int fd_;
};

// At most 8192 voxels are read: a deflated stream may promise a thousand times its length and keep it, which takes time
// and finds nothing new.
inline void read_all(io::VolumeSource& source) {
  const io::VolumeHead& head = source.head();
  const std::size_t slice = head.size[0] * head.size[1];
  if (slice == 0 || head.size[2] == 0) __builtin_trap();
  if (head.spacing_m && !(head.spacing_m->x > 0 && head.spacing_m->y > 0 && head.spacing_m->z > 0)) __builtin_trap();
  if (slice > (std::size_t{1} << 13)) return;
  std::vector<float> values(slice);
  const std::size_t slices = std::min(head.size[2], (std::size_t{1} << 13) / slice);
  const auto read = [&](std::size_t k) {
    source.read(k, 1, values);
    for (const float v : values)
      if (!std::isfinite(v)) __builtin_trap();
  };
  for (std::size_t k = 0; k < slices; ++k) read(k);
  if (slices > 1) read(slices / 2);
}

inline int open_and_read(const io::VolumeFormat& format, const std::uint8_t* bytes, std::size_t size,
                         const io::VolumeWish& wish = {}) {
  static const MemoryFile file;
  const auto path = file.hold(bytes, size);
  try {
    const std::string_view beginning(reinterpret_cast<const char*>(bytes), std::min<std::size_t>(size, 1024));
    if (!format.mine(path, beginning, wish)) return 0;
    const auto source = format.open(path, wish);
    read_all(*source);
  } catch (const Error& error) {
    if (error.code() != Exit::data && error.code() != Exit::no_input) __builtin_trap();
  }
  return 0;
}

}  // namespace gonio::fuzz
