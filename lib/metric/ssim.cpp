#include "metric/ssim.h"

#include <array>
#include <cmath>
#include <limits>

#include "base/parallel.h"

namespace gonio::metric {
namespace {

constexpr int taps = 2 * ssim_radius_px + 1;
constexpr std::size_t moments = 5;  // a, b, a^2, b^2, ab
using Moments = std::array<double, moments>;

std::array<double, taps> gaussian() {
  std::array<double, taps> w{};
  double sum = 0;
  for (int k = 0; k < taps; ++k)
    sum += w[static_cast<std::size_t>(k)] = std::exp(-0.5 * std::pow((k - ssim_radius_px) / 1.5, 2));
  for (double& v : w) v /= sum;
  return w;
}

double similarity(const Moments& m, double c1, double c2) {
  const double aa = m[2] - m[0] * m[0], bb = m[3] - m[1] * m[1], ab = m[4] - m[0] * m[1];
  return (2 * m[0] * m[1] + c1) * (2 * ab + c2) / ((m[0] * m[0] + m[1] * m[1] + c1) * (aa + bb + c2));
}

}  // namespace

std::vector<float> ssim_map(std::span<const float> a, std::span<const float> b, std::span<const std::uint8_t> counts,
                            int width, int height, double data_range) {
  const auto w = static_cast<std::size_t>(width), h = static_cast<std::size_t>(height);
  std::vector<float> map(w * h, std::numeric_limits<float>::quiet_NaN());
  if (width < taps || height < taps) return map;
  const auto weights = gaussian();
  const double c1 = std::pow(0.01 * data_range, 2), c2 = std::pow(0.03 * data_range, 2);
  parallel_for(
      ssim_radius_px, h - ssim_radius_px,
      [&](std::size_t y) {
        std::vector<Moments> column(w);  // the window's rows already summed, per column
        std::vector<std::uint8_t> complete(w);
        for (std::size_t x = 0; x < w; ++x) {
          Moments m{};
          bool all = true;
          for (std::size_t k = 0; k < taps; ++k) {
            const std::size_t i = (y + k - ssim_radius_px) * w + x;
            all = all && counts[i];
            const double u = a[i], v = b[i];
            const double wk = weights[k];
            const Moments terms{u, v, u * u, v * v, u * v};
            for (std::size_t t = 0; t < moments; ++t) m[t] += wk * terms[t];
          }
          column[x] = m;
          complete[x] = all;
        }
        for (std::size_t x = ssim_radius_px; x + ssim_radius_px < w; ++x) {
          Moments m{};
          bool all = true;
          for (std::size_t k = 0; k < taps; ++k) {
            const std::size_t at = x + k - ssim_radius_px;
            all = all && complete[at];
            for (std::size_t t = 0; t < moments; ++t) m[t] += weights[k] * column[at][t];
          }
          if (all) map[y * w + x] = static_cast<float>(similarity(m, c1, c2));
        }
      },
      16);
  return map;
}

}  // namespace gonio::metric
