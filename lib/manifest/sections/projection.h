// "projections": what a projector or screen shows, one picture after the other, and what it means.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gonio::manifest {

struct ProjectedFrame {
  std::string file{};                 // file id of the picture
  std::string show{};                 // "white" | "black" | "bit" | "cosine" | "line"
  std::string axis{};                 // of bit, cosine and line: "column" | "row"
  std::optional<std::int64_t> bit{};  // of the Gray code of the column or row: 0 the finest
  std::optional<bool> inverse{};      // bit: dark where the bit is set
  std::optional<double> periods{};    // cosine: over the whole width or height
  std::optional<double> shift_rad{};  // cosine: light = (1 + cos(2 pi periods (u + 1/2) / size - shift)) / 2
  std::optional<std::int64_t> period_px{}, offset_px{};  // line: every period-th column or row, the first at the offset
};
struct Projection {
  std::int64_t width_px = 0, height_px = 0;
  std::vector<ProjectedFrame> frames;  // in the order in which they are shown
};

}  // namespace gonio::manifest
