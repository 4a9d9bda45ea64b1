// See noise.h.
#include "relief/noise.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"

namespace gonio::relief {
namespace {

const double scale = 4 / (5 * std::cbrt(static_cast<double>(impulses_per_cell)));

double kernel(double r2) {
  const double k = 1 - 4 * r2;
  return k > 0 ? k * k * k : 0;
}

int wrapped(int cell, int period) {
  return period > 0 ? ((cell % period) + period) % period : cell;
}

double summed(const std::vector<SparseNoise::Impulse>& impulses, Vec3 p) {
  double sum = 0;
  for (const auto& impulse : impulses) {
    const Vec3 d = impulse.place - p;
    sum += impulse.height * kernel(dot(d, d));
  }
  return scale * sum;
}

// C(r): midpoint rule over the radius and the axis of cylindrical coordinates.
double overlap(double r) {
  constexpr int cells = 96;
  double sum = 0;
  for (int i = 0; i < cells; ++i) {
    const double z = -0.5 + (i + 0.5) / cells;
    for (int j = 0; j < cells; ++j) {
      const double rho = 0.5 * (j + 0.5) / cells;
      sum += rho * kernel(rho * rho + z * z) * kernel(rho * rho + (z + r) * (z + r));
    }
  }
  return 2 * pi * sum * 0.5 / (cells * cells);
}

// The eight cells about p, remembered while p stays among them.
struct Near {
  int x = 1 << 30, y = 0, z = 0;
  std::vector<SparseNoise::Impulse> impulses;
};
double at(const SparseNoise& noise, Vec3 p, Near& near) {
  const int x = static_cast<int>(std::floor(p.x - 0.5)), y = static_cast<int>(std::floor(p.y - 0.5)),
            z = static_cast<int>(std::floor(p.z - 0.5));
  if (x != near.x || y != near.y || z != near.z) {
    near.x = x, near.y = y, near.z = z;
    near.impulses.clear();
    for (int i = 0; i < 8; ++i) noise.impulses_of(x + i % 2, y + i / 2 % 2, z + i / 4, near.impulses);
  }
  return summed(near.impulses, p);
}

}  // namespace

void SparseNoise::impulses_of(int x, int y, int z, std::vector<Impulse>& list) const {
  const auto part = [](int cell, int period) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(wrapped(cell, period)));
  };
  const std::uint64_t cell =
      split_mix(split_mix(split_mix(part(x, period_[0])) ^ part(y, period_[1])) ^ part(z, period_[2]));
  Random random(seed_, cell);
  for (int j = 0; j < impulses_per_cell; ++j) {
    const double height = random.uniform(-1, 1), u = random.uniform(), v = random.uniform(), w = random.uniform();
    list.push_back({{x + u, y + v, z + w}, height});
  }
}

double SparseNoise::operator()(Vec3 p) const {
  Near near;
  return at(*this, p, near);
}

double noise_sigma() {
  static const double sigma = scale * std::sqrt(impulses_per_cell / 3.0 * overlap(0));
  return sigma;
}

double noise_correlation(double cells) {
  constexpr int steps = 256;
  static const std::array<double, steps + 2> table = [] {
    std::array<double, steps + 2> t{};
    const double all = overlap(0);
    for (std::size_t i = 0; i <= steps; ++i) t[i] = overlap(static_cast<double>(i) / steps) / all;
    return t;
  }();
  const double r = std::abs(cells) * steps;
  if (r >= steps) return 0;
  const auto i = static_cast<std::size_t>(r);
  // Parabola through three points; even about 0.
  const double f = r - static_cast<double>(i), left = i > 0 ? table[i - 1] : table[1];
  return table[i] + 0.5 * f * (table[i + 1] - left + f * (table[i + 1] - 2 * table[i] + left));
}

Relief noise_relief(const NoiseField& field) {
  if (field.parts.empty()) throw Error(Exit::usage, "noise", "has no part", "state Sq and cell of one");
  for (const NoisePart& part : field.parts)
    if (!(part.sq_m >= 0 && part.cell_m > 0 && std::isfinite(part.sq_m) && std::isfinite(part.cell_m)))
      throw Error(Exit::usage, "noise", "a part has no cell or a negative Sq", "state lengths");
  std::vector<double> z(static_cast<std::size_t>(field.nx) * static_cast<std::size_t>(field.ny));
  const double width = field.nx * field.step_m, length = field.ny * field.step_m;
  for (std::size_t k = 0; k < field.parts.size(); ++k) {
    const NoisePart& part = field.parts[k];
    double per_x = 1 / part.cell_m, per_y = per_x;
    std::array<int, 3> period{0, 0, 0};
    if (field.periodic) {
      period = {std::max(2, static_cast<int>(std::lround(width * per_x))),
                std::max(2, static_cast<int>(std::lround(length * per_y))), 0};
      per_x = period[0] / width, per_y = period[1] / length;
    }
    const SparseNoise noise(split_mix(field.seed + 0x632be59bd9b4e019u * (k + 1)), period);
    parallel_for(0, static_cast<std::size_t>(field.ny), [&](std::size_t j) {
      Near near;
      for (int i = 0; i < field.nx; ++i)
        z[j * static_cast<std::size_t>(field.nx) + static_cast<std::size_t>(i)] +=
            part.sq_m / noise_sigma() *
            at(noise, {i * field.step_m * per_x, static_cast<double>(j) * field.step_m * per_y, 0.5}, near);
    });
  }
  return {field.nx, field.ny, field.step_m, field.step_m, std::move(z), field.periodic, "noise"};
}

}  // namespace gonio::relief
