// Power spectra of the tiles of a height map. Every tile of n x n points is levelled by a plane, weighted with Hann's
// window w along both axes and transformed; at the frequencies (kx, ky) / (n step)
//   P = |sum w z exp(-2 pi i k.r / n)|^2 dx dy / sum w^2        m^4, two-sided
// An estimate of the spectral density S with one degree of freedom pair: P / S is exponentially distributed, so that
// ln P has the mean ln S - 0.5772 and the standard deviation pi / sqrt(6), whatever S (Bartlett & Kendall 1946).
// Neighbouring frequencies are correlated by the window; they share blocks.
//
// Tiles overlap by half: with Hann's window their powers are correlated by 1 / 36 (Welch 1967), which counts as nothing
// here. One tile in four is set apart, in a fixed pattern: what has to be searched for (the period of a grating) is
// searched there, and judged on the others alone.
#pragma once
#include <cstdint>
#include <vector>

#include "io/height_map.h"

namespace gonio::explain::heights {

inline constexpr double euler_gamma = 0.57721566490153286;
inline constexpr double log_sigma = 1.2825498301618641;  // pi / sqrt(6)

struct Ordinate {
  int kx = 0, ky = 0;     // cycles per tile
  double fx = 0, fy = 0;  // 1/m: x along rows, y down the columns
  std::uint32_t block = 0;
};
struct Tile {
  std::size_t x = 0, y = 0;       // its first point
  std::vector<double> log_power;  // one per ordinate
};
struct TileSpectra {
  std::size_t n = 0;
  double step_x_m = 0, step_y_m = 0;
  std::vector<Ordinate> ordinates;  // of one half plane, from 2 to 40 cycles a tile, at most 1/4 a point
  std::uint32_t blocks = 0;
  std::vector<Tile> judged, searched;
  std::size_t left_out = 0;  // tiles in which more than one point in fifty is missing
  // Power that z = A cos(2 pi f.r) puts at its own frequency, over A^2.
  double line_gain() const;
};

// Tiles are as large as leaves at least eight of them, 32 to 256 points a side. Error(data) at `place` where a map has
// too few points.
TileSpectra tile_spectra(const io::HeightMap& map, const std::string& place);

// Hann's window in frequency, `bins` from the line: 1 at 0, 0 from 2 at the integers.
double hann_response(double bins);

}  // namespace gonio::explain::heights
