#include "surface/sheen.h"

#include <array>

namespace gonio::surface {
namespace {

constexpr std::size_t cosines = 25, widths = 15;

// Integral of f cos over the hemisphere, cosines spaced evenly.
template <class F>
double returned(double cosine, const F& f) {
  constexpr int rings = 96, turns = 48;
  const double z = std::max(2e-3, cosine);
  const Vec3 wo{std::sqrt(1 - z * z), 0, z};
  double sum = 0;
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < turns; ++j) {
      const double c = (i + 0.5) / rings, s = std::sqrt(1 - c * c), phi = pi * (j + 0.5) / turns;
      sum += f(wo, Vec3{s * std::cos(phi), s * std::sin(phi), c}) * c;
    }
  return sum * 2 * pi / (rings * turns);
}

// Nodes lie denser towards the horizon, where what is returned changes most.
double cosine_of(std::size_t i) {
  const double x = static_cast<double>(i) / (cosines - 1);
  return x * x;
}
double width_of(std::size_t i) {
  return least_sheen_width + (largest_sheen_width - least_sheen_width) * static_cast<double>(i) / (widths - 1);
}

struct Tables {
  std::array<std::array<double, cosines>, widths> velvet_of{};
  std::array<double, cosines> forward_of{};
  Tables() {
    for (std::size_t i = 0; i < cosines; ++i) {
      forward_of[i] = returned(cosine_of(i), forward_sheen);
      for (std::size_t k = 0; k < widths; ++k)
        velvet_of[k][i] = returned(cosine_of(i), [&](Vec3 wo, Vec3 wi) { return velvet(wo, wi, width_of(k)); });
    }
  }
};
const Tables& tables() {
  static const Tables all;
  return all;
}

double between(const std::array<double, cosines>& at, double cosine) {
  const double x = std::sqrt(std::clamp(cosine, 0.0, 1.0)) * (cosines - 1);
  const auto i = std::min<std::size_t>(cosines - 2, static_cast<std::size_t>(x));
  return at[i] + (x - static_cast<double>(i)) * (at[i + 1] - at[i]);
}

}  // namespace

double velvet_albedo(double cosine, double width) {
  const double x = (std::clamp(width, least_sheen_width, largest_sheen_width) - least_sheen_width) /
                   (largest_sheen_width - least_sheen_width) * (widths - 1);
  const auto k = std::min<std::size_t>(widths - 2, static_cast<std::size_t>(x));
  const double t = x - static_cast<double>(k);
  return (1 - t) * between(tables().velvet_of[k], cosine) + t * between(tables().velvet_of[k + 1], cosine);
}

double forward_sheen_albedo(double cosine) {
  return between(tables().forward_of, cosine);
}

}  // namespace gonio::surface
