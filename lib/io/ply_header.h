// The header of a PLY file, and its scalars. Behind io/ply.h.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gonio::io {

enum class PlyFormat { ascii, little_endian, big_endian };
enum class PlyScalar { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::size_t size_of(PlyScalar type);

struct PlyProperty {
  std::string name;
  PlyScalar type = PlyScalar::float32;
  std::optional<PlyScalar> count_type;  // set: a list whose length has this type
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
  std::size_t body = 0;  // where the data begins
};

// Error(data) at `place` where the header is malformed, or claims more elements than the rest of the file can hold.
PlyHeader read_ply_header(std::string_view file, const std::string& place);

}  // namespace gonio::io
