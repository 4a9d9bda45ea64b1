// Which filter lies over a sensor's sample, by the name that cameras give the grid of filters (GenICam PFNC): "Mono",
// "BayerRG" (upper left corner red, beside it green), "BayerGR", "BayerGB", "BayerBG"; or by its corner, row by row, as
// the manifest's cameras state it: "RGGB", "GRBG", "GBRG", "BGGR". "polarizers" are those of polarizers.h.
#pragma once
#include <array>
#include <string>

namespace gonio::photograph {

bool is_bayer(const std::string& corner);  // "RGGB", "GRBG", "GBRG" or "BGGR"

class Mosaic {
 public:
  // Error(data) at `place` for other names.
  static Mosaic named(const std::string& name, const std::string& place);
  bool mono() const { return kind_ == Kind::mono; }
  bool polarizers() const { return kind_ == Kind::polarizers; }
  bool operator==(const Mosaic&) const = default;
  int period_px() const { return mono() ? 1 : 2; }
  // 0 R, 1 G, 2 B; of polarizers 0 to 3, row by row.
  int colour(int x, int y) const { return corner_[static_cast<std::size_t>((y & 1) * 2 + (x & 1))]; }

 private:
  enum class Kind { bayer, mono, polarizers };
  Kind kind_ = Kind::bayer;
  std::array<int, 4> corner_{};  // row by row
};

}  // namespace gonio::photograph
