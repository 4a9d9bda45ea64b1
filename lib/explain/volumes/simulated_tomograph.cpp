// See simulated_tomograph.h.
#include "explain/volumes/simulated_tomograph.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "volume/mechanisms/ct_scatter.h"

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

}  // namespace

Tomograph::Tomograph(const Body& body, std::size_t views)
    : slices_(body.size[2]),
      views_(views),
      across_(body.size[0]),
      cell_(std::min(body.cell_m.x, body.cell_m.y)),
      first_z_(body.first_m.z),
      cell_z_(body.cell_m.z) {
  const double reach = std::hypot(body.first_m.x, body.first_m.y);
  bins_ = 2 * (static_cast<std::size_t>(reach / cell_) + 3) + 1;
  for (std::size_t a = 0; a < views; ++a) {
    const double angle = pi * static_cast<double>(a) / static_cast<double>(views);
    cosine_.push_back(std::cos(angle)), sine_.push_back(std::sin(angle));
  }
  paths_.assign(slices_ * views_ * bins_, 0);
  const double middle = static_cast<double>(bins_ / 2), length = body.cell_m.x * body.cell_m.y / cell_;
  parallel_for(0, slices_, [&](std::size_t k) {
    for (std::size_t j = 0; j < body.size[1]; ++j)
      for (std::size_t i = 0; i < body.size[0]; ++i) {
        const float share = body.share[(k * body.size[1] + j) * body.size[0] + i];
        if (!(share > 0)) continue;
        const double x = (body.first_m.x + body.cell_m.x * static_cast<double>(i)) / cell_,
                     y = (body.first_m.y + body.cell_m.y * static_cast<double>(j)) / cell_;
        for (std::size_t a = 0; a < views_; ++a) {
          const double u = x * cosine_[a] + y * sine_[a] + middle;
          const auto low = static_cast<std::size_t>(u);
          const auto f = static_cast<float>(u - static_cast<double>(low));
          float* row = paths_.data() + (k * views_ + a) * bins_ + low;
          row[0] += (1 - f) * share * static_cast<float>(length);
          row[1] += f * share * static_cast<float>(length);
        }
      }
  });
  // Cells that are shared out to bins beat with them, most along the diagonals, and a ramp makes much of that: twice
  // (1 2 1) / 4 takes it away. Nothing is asked of the reconstruction next to a wall.
  parallel_for(0, slices_ * views_, [&](std::size_t line) {
    float* p = paths_.data() + line * bins_;
    for (int pass = 0; pass < 2; ++pass) {
      float before = 0;
      for (std::size_t n = 0; n + 1 < bins_; ++n) {
        const float own = p[n];
        p[n] = 0.25f * before + 0.5f * own + 0.25f * p[n + 1];
        before = own;
      }
    }
  });
  for (const float p : paths_) longest_ = std::max(longest_, static_cast<double>(p));
}

// Linear between bins and between slices, summed over the views.
std::vector<double> Tomograph::gathered(const std::vector<float>& sinogram, std::span<const Vec3> places_m) const {
  std::vector<double> result(places_m.size(), 0.0);
  const double middle = static_cast<double>(bins_ / 2), last = static_cast<double>(slices_) - 1;
  parallel_for(
      0, places_m.size(),
      [&](std::size_t n) {
        const double z = std::clamp((places_m[n].z - first_z_) / cell_z_, 0.0, last);
        const auto k = std::min(static_cast<std::size_t>(z), slices_ - 1);
        for (std::size_t s = 0; s < 2; ++s) {
          const double weight = s == 0 ? 1 - (z - static_cast<double>(k)) : z - static_cast<double>(k);
          if (!(weight > 0) || k + s >= slices_) continue;
          double sum = 0;
          for (std::size_t a = 0; a < views_; ++a) {
            const double u = std::clamp((places_m[n].x * cosine_[a] + places_m[n].y * sine_[a]) / cell_ + middle, 0.0,
                                        static_cast<double>(bins_) - 1.001);
            const auto low = static_cast<std::size_t>(u);
            const double f = u - static_cast<double>(low);
            const float* row = sinogram.data() + ((k + s) * views_ + a) * bins_ + low;
            sum += (1 - f) * static_cast<double>(row[0]) + f * static_cast<double>(row[1]);
          }
          result[n] += weight * sum;
        }
      },
      64);
  return result;
}

std::vector<double> Tomograph::back_projected(const std::vector<float>& lines, std::span<const Vec3> places_m) const {
  std::vector<float> filtered(lines.size());
  parallel_for(0, slices_ * views_, [&](std::size_t line) {
    const float* value = lines.data() + line * bins_;
    float* q = filtered.data() + line * bins_;
    if (std::all_of(value, value + bins_, [](float v) { return v == 0; })) return;
    for (std::size_t n = 0; n < bins_; ++n) {
      double sum = static_cast<double>(value[n]) / 4;
      for (std::size_t m = (n + 1) % 2; m < bins_; m += 2) {
        const double d = static_cast<double>(n) - static_cast<double>(m);
        sum -= static_cast<double>(value[m]) / (pi * pi * d * d);
      }
      q[n] = static_cast<float>(sum / cell_);
    }
  });
  std::vector<double> result = gathered(filtered, places_m);
  for (double& v : result) v *= pi / static_cast<double>(views_);
  return result;
}

std::vector<double> Tomograph::reconstructed(const std::function<double(double)>& g,
                                             std::span<const Vec3> places_m) const {
  std::vector<float> lines(paths_.size());
  std::ranges::transform(paths_, lines.begin(), [&](float p) { return static_cast<float>(g(static_cast<double>(p))); });
  return back_projected(lines, places_m);
}

// Three running means of the same width have the variance of one Gaussian: (width^2 - 1) / 4.
std::vector<std::vector<double>> Tomograph::scattered(double per_m, std::span<const double> shares,
                                                      std::span<const Vec3> places_m) const {
  std::vector<float> lines(paths_.size());
  std::ranges::transform(paths_, lines.begin(), [&](float path) {
    return static_cast<float>(equation::ct_scatter_lost(per_m * static_cast<double>(path)));
  });
  const double sd = static_cast<double>(across_) / 8;
  const auto half = static_cast<std::size_t>(0.5 * (std::sqrt(4 * sd * sd + 1) - 1) + 0.5);
  parallel_for(0, views_ * slices_, [&](std::size_t line) {
    const std::size_t k = line / views_, a = line % views_;
    smooth(lines.data() + (k * views_ + a) * bins_, bins_, 1, half);
  });
  const double scale = cell_ / cell_z_;
  parallel_for(0, views_ * bins_, [&](std::size_t line) {
    smooth(lines.data() + line, slices_, views_ * bins_,
           static_cast<std::size_t>(static_cast<double>(half) * scale + 0.5));
  });
  std::vector<std::vector<double>> result;
  for (const double share : shares) {
    std::vector<float> lacking(lines.size());
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const double p = per_m * static_cast<double>(paths_[i]);
      lacking[i] = static_cast<float>(equation::ct_scatter_lacks(p, share, static_cast<double>(lines[i])) / per_m);
    }
    result.push_back(back_projected(lacking, places_m));
  }
  return result;
}

std::vector<double> Tomograph::mean_path(std::span<const Vec3> places_m) const {
  std::vector<double> result = gathered(paths_, places_m);
  for (double& v : result) v /= static_cast<double>(views_);
  return result;
}

}  // namespace gonio::explain::volumes
