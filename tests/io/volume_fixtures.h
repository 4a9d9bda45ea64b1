// Small volumes and their bytes, for the tests of the readers of volumes.
#pragma once
#include <gtest/gtest.h>
#include <zlib.h>

#include <cstring>
#include <string>
#include <vector>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/random.h"
#include "data.h"
#include "io/volume.h"

namespace gonio::io {

// Where and why reading is refused: "PLACE: PROBLEM; REMEDY", or "none". Samples are read, too: shortage may show only
// there.
inline std::string volume_refusal(const std::filesystem::path& path, const VolumeWish& wish = {},
                                  Exit code = Exit::data) {
  try {
    read_volume(path, wish);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return error.what();
  }
  return "none";
}

inline std::string gzipped(const std::string& bytes, int window_bits = 15 + 16) {
  z_stream stream{};
  deflateInit2(&stream, 6, Z_DEFLATED, window_bits, 8, Z_DEFAULT_STRATEGY);
  std::string out(deflateBound(&stream, bytes.size()) + 64, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

// Values as they lie in a file, in either order of bytes.
template <class T>
std::string stored(const std::vector<float>& values, bool big_endian = false) {
  std::string bytes;
  for (const float value : values) {
    const T v = static_cast<T>(value);
    std::string one(sizeof v, '\0');
    std::memcpy(one.data(), &v, sizeof v);
    bytes += big_endian ? std::string(one.rbegin(), one.rend()) : one;
  }
  return bytes;
}

// Whole numbers from 0 to `most`, another in every voxel's neighbourhood; no side equals another.
inline VolumeData random_volume(VoxelType type, std::array<std::size_t, 3> size = {5, 4, 3}, std::uint32_t most = 120) {
  VolumeData volume{{.size = size, .type = type}, {}};
  Random random(7);
  for (std::size_t n = 0; n < volume.head.voxels(); ++n)
    volume.values.push_back(static_cast<float>(random.below(most + 1)));
  return volume;
}

}  // namespace gonio::io
