// Structural similarity (Wang, Bovik, Sheikh & Simoncelli, IEEE TIP 13(4), 2004, eq. 13) of two planes of floats.
//
// 11 x 11 Gaussian window, sigma 1.5 px, weights summing to one; variances and covariance with these weights (not N /
// (N - 1)); C1 = (0.01 L)^2, C2 = (0.03 L)^2, where L is the range of the data: 1 for [0, 1] floats. L is never guessed
// here: with L = 255 and [0, 1] floats the constants swamp the signal and everything looks alike. Computed where the
// whole window lies in the picture and on pixels that count; NaN elsewhere.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace gonio::metric {

inline constexpr int ssim_radius_px = 5;

std::vector<float> ssim_map(std::span<const float> a, std::span<const float> b, std::span<const std::uint8_t> counts,
                            int width, int height, double data_range);

}  // namespace gonio::metric
