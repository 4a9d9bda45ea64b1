// Which samples of an exposure say something: those that are full, and what light spills into about them, do not.
#pragma once
#include <cstdint>
#include <vector>

namespace gonio::photograph {

// One exposure's samples, row by row; black taken off. `unusable`: defects, and what light spilled into; else empty.
struct RawPlane {
  std::vector<float> codes;
  std::vector<std::uint8_t> unusable;
};

// What a sample says: a reading, that it is full, or nothing (defects, and what lies within `blooming_px` of full
// ones).
enum class SampleKind : std::uint8_t { read, full, unusable };
std::vector<SampleKind> kinds_of(const RawPlane& plane, int width, int height, double full_scale, int blooming_px);

}  // namespace gonio::photograph
