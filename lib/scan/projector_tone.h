// What a projector makes of what is sent to it, 0 to 1: light = (sent, at least `dark` and at most `bright`)^gamma. One
// whose contrast is turned too far shows all above a level alike, and all below another.
//
// Five shifts and more of a cosine have more readings than it has unknowns (its light from elsewhere D, what it sends
// back W, its phase t): of many pixels together, whose phases differ, what is left over tells the tone,
//   v_k = D + W light((1 + cos(t - shift_k)) / 2),
// fitted with each pixel's own D, W and t taken away at each step (variable projection; Golub & Pereyra 1973), outliers
// by Cauchy's weights. Standard deviations are from the scatter over tiles of the picture. Three shifts leave nothing
// over, four no more than an exponent explains. For this room.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gonio::scan {

struct FlatLevel {  // of what is sent
  double level = 0, sigma = 0;
};

struct ProjectorTone {
  double gamma = 1, gamma_sigma = 0;
  std::optional<FlatLevel> below, above;  // which all is shown alike; nothing: not told, or not so
  bool bends() const;                     // gamma beyond three standard deviations, and 2 %; or a level
  double light(double sent) const;
  // As it is, and with each of its numbers that has one a standard deviation larger.
  std::vector<ProjectorTone> varied() const;
};

// Of pixels, one after the other, the readings at all shifts.
struct ToneReadings {
  std::vector<double> shifts_rad;
  std::vector<float> readings, sigmas;  // sigma: by pixel, of a reading
  std::vector<std::uint32_t> tiles;     // by pixel, below 64
};
// `gamma`: known; else found beside the levels. Nothing where the projector has no level within its noise, 1.5 % at
// least, or where shifts or pixels are too few.
std::optional<ProjectorTone> flat_tone(const ToneReadings& seen, std::optional<FlatLevel> gamma);

}  // namespace gonio::scan
