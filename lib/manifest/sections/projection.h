// "projections": what a projector or screen shows, one picture after the other, and what it means.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gonio::manifest {

struct ProjectedFrame {
  std::string file{};                 // file id of the picture
  std::string show{};                 // "white" | "black" | "bit" | "cosine"
  std::string axis{};                 // of bit and cosine: "column" | "row"
  std::optional<std::int64_t> bit{};  // of the Gray code of the column or row: 0 the finest
  std::optional<bool> inverse{};      // bit: dark where the bit is set
  std::optional<double> periods{};    // cosine: over the whole width or height
  std::optional<double> shift_rad{};  // cosine: light = (1 + cos(2 pi periods (u + 1/2) / size - shift)) / 2
};
struct Projection {
  std::int64_t width_px = 0, height_px = 0;
  std::vector<ProjectedFrame> frames;  // in the order in which they are shown
};

}  // namespace gonio::manifest
