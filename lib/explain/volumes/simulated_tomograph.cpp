// See simulated_tomograph.h.
#include "explain/volumes/simulated_tomograph.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "volume/mechanisms/ct_beam_hardening.h"
#include "volume/mechanisms/ct_scatter.h"
#include "volume/mechanisms/ct_streak.h"
#include "volume/spectrum.h"

namespace gonio::explain::volumes {
namespace {

// Three running means over 2 half + 1 of `n` numbers that lie `stride` apart; beyond the ends there is nothing.
void smooth(float* values, std::size_t n, std::size_t stride, std::size_t half) {
  std::vector<double> sums(n + 1);
  for (int pass = 0; pass < 3; ++pass) {
    for (std::size_t i = 0; i < n; ++i) sums[i + 1] = sums[i] + static_cast<double>(values[i * stride]);
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t first = i < half ? 0 : i - half, last = std::min(n, i + half + 1);
      values[i * stride] = static_cast<float>((sums[last] - sums[first]) / static_cast<double>(2 * half + 1));
    }
  }
}
// Three running means of the same width have the variance of one Gaussian: (width^2 - 1) / 4.
std::size_t half_of(double sd) {
  return static_cast<std::size_t>(0.5 * (std::sqrt(4 * sd * sd + 1) - 1) + 0.5);
}

// A Gaussian along `n` numbers that lie `stride` apart; beyond the ends there is nothing.
void blur(float* values, std::size_t n, std::size_t stride, const std::vector<float>& half) {
  std::vector<float> line(n + 2 * half.size(), 0.0f);
  for (std::size_t i = 0; i < n; ++i) line[i + half.size()] = values[i * stride];
  for (std::size_t i = 0; i < n; ++i) {
    const float* at = line.data() + i + half.size();
    float sum = half[0] * at[0];
    for (std::size_t m = 1; m < half.size(); ++m) {
      const auto k = static_cast<std::ptrdiff_t>(m);
      sum += half[m] * (at[k] + at[-k]);
    }
    values[i * stride] = sum;
  }
}
std::vector<float> gaussian(double sd) {
  std::vector<float> half;
  double sum = 0;
  for (int m = 0; m <= static_cast<int>(std::ceil(4 * sd)); ++m) {
    half.push_back(static_cast<float>(std::exp(-0.5 * m * m / (sd * sd))));
    sum += (m > 0 ? 2 : 1) * static_cast<double>(half.back());
  }
  for (float& w : half) w = static_cast<float>(static_cast<double>(w) / sum);
  return half;
}

template <class Function>
Readings transformed(const std::vector<float>& values, const Function& function) {
  Readings result(values.size());
  std::ranges::transform(values, result.begin(),
                         [&](float v) { return static_cast<float>(function(static_cast<double>(v))); });
  return result;
}

}  // namespace

Tomograph::Tomograph(const mesh::Mesh& mesh, std::array<std::size_t, 3> size, Vec3 spacing_m, double per_m,
                     std::span<const Ball> markers, std::size_t most)
    : per_m_(per_m) {
  const double larger = std::max(1.0, static_cast<double>(std::ranges::max(size)) / static_cast<double>(most));
  fine_ = larger == 1;
  const auto across = [&](std::size_t a) { return static_cast<double>(size[a]) * spacing_m[static_cast<int>(a)]; };
  detector_.bin_m = larger * std::min(spacing_m.x, spacing_m.y);
  detector_.slices = static_cast<std::size_t>(std::ceil(static_cast<double>(size[2]) / larger));
  detector_.slice_m = across(2) / static_cast<double>(detector_.slices);
  const double widest = std::max(across(0), across(1)) / detector_.bin_m;
  across_ = static_cast<std::size_t>(widest);
  detector_.bins = static_cast<std::size_t>(std::hypot(across(0), across(1)) / detector_.bin_m) + 4;
  detector_.bins += (detector_.bins + across_) % 2;
  detector_.views = static_cast<std::size_t>(std::ceil(pi / 2 * widest));
  intensity_ = intensities(mesh, detector_, per_m);
  if (!markers.empty()) {
    without_ = std::move(intensity_);
    intensity_ = intensities(mesh, detector_, per_m, markers);
  }
  for (const float i : without_.empty() ? intensity_ : without_)
    longest_ = std::max(longest_, -std::log(static_cast<double>(i)) / per_m);
}

Readings Tomograph::read() const {
  return transformed(intensity_, [&](double i) { return -std::log(i) / per_m_; });
}

Readings Tomograph::lack_by_hardening() const {
  return transformed(without_.empty() ? intensity_ : without_, [&](double i) {
    return equation::ct_beam_hardening_lacks(-std::log(i), longest_ * per_m_) / per_m_;
  });
}

Readings Tomograph::lack_by_streak() const {
  Readings result(intensity_.size(), 0.0f);
  for (std::size_t i = 0; i < without_.size(); ++i)
    result[i] = static_cast<float>(equation::ct_streak_lacks(-std::log(static_cast<double>(intensity_[i])),
                                                             -std::log(static_cast<double>(without_[i]))) /
                                   per_m_);
  return result;
}

std::vector<Readings> Tomograph::lack_by_floor(std::span<const double> floors) const {
  std::vector<Readings> result;
  for (const double floor : floors) {
    Readings& lacks = result.emplace_back(intensity_.size(), 0.0f);
    for (std::size_t i = 0; i < without_.size(); ++i)
      lacks[i] = static_cast<float>(
          equation::ct_streak_floor_lacks(static_cast<double>(intensity_[i]), static_cast<double>(without_[i]), floor) /
          per_m_);
  }
  return result;
}

Readings Tomograph::lack_by_blur(double spread, double variance) const {
  std::vector<float> taken =
      transformed(intensity_, [&](double i) { return 1 - volume::intensity_behind(-std::log(i), variance); });
  const std::vector<float> within = gaussian(spread), across = gaussian(spread * detector_.bin_m / detector_.slice_m);
  const std::size_t bins = detector_.bins, views = detector_.views;
  parallel_for(
      0, detector_.slices * views, [&](std::size_t line) { blur(taken.data() + line * bins, bins, 1, within); }, 64);
  parallel_for(
      0, views * bins, [&](std::size_t column) { blur(taken.data() + column, detector_.slices, views * bins, across); },
      64);
  for (std::size_t i = 0; i < taken.size(); ++i) {
    const double blurred = volume::line_integral_of(1 - static_cast<double>(taken[i]), variance);
    taken[i] = static_cast<float>((-std::log(static_cast<double>(intensity_[i])) - blurred) / per_m_);
  }
  return taken;
}

std::vector<Readings> Tomograph::lack_by_scatter(std::span<const double> shares) const {
  const std::vector<float> behind =
      transformed(intensity_, [](double i) { return volume::intensity_behind(-std::log(i), volume::usual_variance); });
  std::vector<float> spread = transformed(behind, [](double i) { return equation::ct_scatter_lost(i); });
  const std::size_t bins = detector_.bins, views = detector_.views;
  const double sd = static_cast<double>(across_) / 8, slices = sd * detector_.bin_m / detector_.slice_m;
  parallel_for(
      0, detector_.slices * views, [&](std::size_t line) { smooth(spread.data() + line * bins, bins, 1, half_of(sd)); },
      64);
  parallel_for(
      0, views * bins,
      [&](std::size_t column) { smooth(spread.data() + column, detector_.slices, views * bins, half_of(slices)); }, 64);
  std::vector<Readings> result;
  for (const double share : shares) {
    Readings& lacks = result.emplace_back(spread.size());
    for (std::size_t i = 0; i < lacks.size(); ++i)
      lacks[i] = static_cast<float>(equation::ct_scatter_lacks(-std::log(static_cast<double>(intensity_[i])), share,
                                                               static_cast<double>(behind[i]),
                                                               static_cast<double>(spread[i])) /
                                    per_m_);
  }
  return result;
}

std::vector<std::array<float, 4>> Tomograph::reconstructed(std::span<const Readings> four,
                                                           std::span<const Vec3> places_m) const {
  using Four = Eigen::Array4f;
  const Detector& d = detector_;
  std::vector<float> ramp(d.bins, 0.0f);  // by distance
  ramp[0] = static_cast<float>(1 / (4 * d.bin_m));
  for (std::size_t n = 1; n < d.bins; n += 2)
    ramp[n] = static_cast<float>(-1 / (pi * pi * static_cast<double>(n * n) * d.bin_m));
  std::vector<float> filtered(4 * d.size(), 0.0f);
  parallel_for(
      0, d.slices * d.views,
      [&](std::size_t line) {
        float* q = filtered.data() + 4 * line * d.bins;
        for (std::size_t m = 0; m < d.bins; ++m) {
          Four value = Four::Zero();
          for (std::size_t r = 0; r < four.size(); ++r)
            value[static_cast<Eigen::Index>(r)] = four[r][line * d.bins + m];
          if ((value == 0).all()) continue;
          Four::Map(q + 4 * m) += value * ramp[0];
          for (std::size_t n = (m + 1) % 2; n < d.bins; n += 2)
            Four::Map(q + 4 * n) += value * ramp[n > m ? n - m : m - n];
        }
      },
      16);
  std::vector<std::array<double, 2>> turn;
  for (std::size_t a = 0; a < d.views; ++a) {
    const double angle = pi * static_cast<double>(a) / static_cast<double>(d.views);
    turn.push_back({std::cos(angle) / d.bin_m, std::sin(angle) / d.bin_m});
  }
  std::vector<std::array<float, 4>> result(places_m.size());
  const double last = static_cast<double>(d.slices) - 1, end = static_cast<double>(d.bins) - 1.001;
  parallel_for(
      0, places_m.size(),
      [&](std::size_t n) {
        const Vec3 p = places_m[n];
        const double z = std::clamp(p.z / d.slice_m + d.half_height(), 0.0, last);
        const auto k = static_cast<std::size_t>(z + 1e-9);
        const double above = std::max(0.0, z - static_cast<double>(k));
        Four sum = Four::Zero();
        for (std::size_t s = 0; s < 2; ++s) {
          const double weight = s == 0 ? 1 - above : above;
          if (!(weight > 1e-9) || k + s >= d.slices) continue;
          Four own = Four::Zero();
          for (std::size_t a = 0; a < d.views; ++a) {
            const double u = std::clamp(p.x * turn[a][0] + p.y * turn[a][1] + d.middle(), 0.0, end);
            const auto low = static_cast<std::size_t>(u);
            const auto f = static_cast<float>(u - static_cast<double>(low));
            const float* row = filtered.data() + 4 * (d.line(k + s, a) + low);
            own += (1 - f) * Four::Map(row) + f * Four::Map(row + 4);
          }
          sum += static_cast<float>(weight) * own;
        }
        sum *= static_cast<float>(pi / static_cast<double>(d.views));
        result[n] = {sum[0], sum[1], sum[2], sum[3]};
      },
      64);
  return result;
}

std::vector<double> Tomograph::mean_reading(const Readings& values, std::span<const Vec3> places_m) const {
  const Detector& d = detector_;
  std::vector<double> result(places_m.size(), 0.0);
  parallel_for(
      0, places_m.size(),
      [&](std::size_t n) {
        const Vec3 p = places_m[n];
        const auto k = static_cast<std::size_t>(
            std::clamp(p.z / d.slice_m + d.half_height() + 0.5, 0.0, static_cast<double>(d.slices) - 1));
        for (std::size_t a = 0; a < d.views; ++a) {
          const double angle = pi * static_cast<double>(a) / static_cast<double>(d.views);
          const double u = (p.x * std::cos(angle) + p.y * std::sin(angle)) / d.bin_m + d.middle();
          const auto bin = static_cast<std::size_t>(std::clamp(u + 0.5, 0.0, static_cast<double>(d.bins) - 1));
          result[n] += static_cast<double>(values[d.line(k, a) + bin]) / static_cast<double>(d.views);
        }
      },
      64);
  return result;
}

}  // namespace gonio::explain::volumes
