#include "surface/matte.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace gonio::surface {
namespace {

constexpr double evenly = 0.5 - 2 / (3 * pi);  // form 2: what a grazing view of sigma = 1 returns beyond a matte one

// Form 1: pi f / rho of one facet, and pi f / rho^2 of two, without what sigma makes of them:
//   once = C1 + slope (0.45 sides + 0.125 across), twice = 0.17 s / (s + 0.13) pairs
struct Grooves {
  double sides = 0, across = 0, pairs = 0;
};
Grooves grooves(Vec3 wo, Vec3 wi) {
  const double low = std::min(wo.z, wi.z), high = std::max(wo.z, wi.z);
  const double sine_a = std::sqrt(std::max(0.0, 1 - low * low)), sine_b = std::sqrt(std::max(0.0, 1 - high * high));
  const double a = std::acos(std::min(1.0, low)), b = std::acos(std::min(1.0, high)), both = sine_a * sine_b;
  const double c = both > 1e-12 ? std::clamp((wo.x * wi.x + wo.y * wi.y) / both, -1.0, 1.0) : 0;
  const double turned = 2 * b / pi, between = 4 * a * b / (pi * pi);
  return {c * (sine_a - (c < 0 ? turned * turned * turned : 0)) * sine_b / high,
          (1 - std::abs(c)) * between * between * (sine_a + sine_b) / (low + high), 1 - c * turned * turned};
}

// Of a slope sigma, the factors of the above.
struct Sloped {
  double flat, slope, pairs;
  explicit Sloped(double sigma) {
    const double s = sigma * sigma;
    flat = 1 - 0.5 * s / (s + 0.33);
    slope = s / (s + 0.09);
    pairs = 0.17 * s / (s + 0.13);
  }
  double once(const Grooves& g) const { return flat + slope * (0.45 * g.sides + 0.125 * g.across); }
};

// Means of what grooves() says over the cosine-weighted hemisphere, by the cosine of the other direction; and by sigma,
// the most of its albedo that a black and a white surface return.
struct Means {
  static constexpr std::size_t cosines = 65, sigmas = 41;
  std::array<Grooves, cosines> of{};
  std::array<double, sigmas> of_black{}, of_white{};
  Means() {
    constexpr int rings = 64, turns = 64;
    for (std::size_t k = 0; k < cosines; ++k) {
      const double z = std::max(1e-4, static_cast<double>(k) / (cosines - 1));
      const Vec3 wo{std::sqrt(1 - z * z), 0, z};
      for (int i = 0; i < rings; ++i)
        for (int j = 0; j < turns; ++j) {
          const double sine2 = (i + 0.5) / rings, phi = pi * (j + 0.5) / turns, sine = std::sqrt(sine2);
          const Grooves g = grooves(wo, {sine * std::cos(phi), sine * std::sin(phi), std::sqrt(1 - sine2)});
          of[k].sides += g.sides / (rings * turns);
          of[k].across += g.across / (rings * turns);
          of[k].pairs += g.pairs / (rings * turns);
        }
    }
    for (std::size_t i = 0; i < sigmas; ++i) {
      const Sloped by(pi / 2 * static_cast<double>(i) / (sigmas - 1));
      for (const Grooves& g : of) {
        of_black[i] = std::max(of_black[i], by.once(g));
        of_white[i] = std::max(of_white[i], 1.002 * (by.once(g) + by.pairs * g.pairs));
      }
    }
    of_black[0] = of_white[0] = 1;
  }
  Grooves at(double cosine) const {
    const double x = std::clamp(cosine, 0.0, 1.0) * (cosines - 1);
    const auto k = std::min<std::size_t>(cosines - 2, static_cast<std::size_t>(x));
    const double t = x - static_cast<double>(k);
    const auto between = [t](double from, double to) { return from + t * (to - from); };
    return {between(of[k].sides, of[k + 1].sides), between(of[k].across, of[k + 1].across),
            between(of[k].pairs, of[k + 1].pairs)};
  }
  // What the law is divided by: at least 1.
  Rgb most_of(double sigma, Rgb albedo) const {
    const double x = std::clamp(sigma / (pi / 2), 0.0, 1.0) * (sigmas - 1);
    const auto k = std::min<std::size_t>(sigmas - 2, static_cast<std::size_t>(x));
    const double t = x - static_cast<double>(k), black = of_black[k] + t * (of_black[k + 1] - of_black[k]),
                 white = of_white[k] + t * (of_white[k + 1] - of_white[k]);
    const auto of_band = [&](double rho) { return std::max(1.0, black + rho * (white - black)); };
    return {of_band(albedo.x), of_band(albedo.y), of_band(albedo.z)};
  }
};
const Means& means() {
  static const Means table;
  return table;
}

Rgb over(Rgb a, Rgb b) {
  return {a.x / b.x, a.y / b.y, a.z / b.z};
}

// Form 2: the mean over the cosine-weighted hemisphere of t, in closed form as in surface/oren_nayar.h.
double mean_of_improved(double cosine) {
  const double c = std::clamp(cosine, 0.0, 1.0), s = std::sqrt(1 - c * c);
  const double beyond = s * c * (1 + s + s * s) / (1 + s);
  return (s * (std::acos(c) - s * c) + 2.0 / 3 * beyond - 2.0 / 3 * s) / pi;
}

}  // namespace

Matte::Matte(double sigma_rad, double form)
    : sigma_(sigma_rad), form_(sigma_rad > 0 ? static_cast<int>(std::lround(form)) : 0), qualitative_(sigma_rad) {
  if (form_ == 2) sigma_ = std::min(1.0, sigma_);
}

Rgb Matte::brdf(Rgb albedo, Vec3 wo, Vec3 wi) const {
  return form_ == 0 ? albedo * (qualitative_.shape(wo, wi) / pi) : other_weight(albedo, wo, wi) / pi;
}

Rgb Matte::weight(Rgb albedo, Vec3 wo, Vec3 wi) const {
  return form_ == 0 ? albedo * qualitative_.shape(wo, wi) : other_weight(albedo, wo, wi);
}

Rgb Matte::other_weight(Rgb albedo, Vec3 wo, Vec3 wi) const {
  if (form_ == 1) {
    const Sloped by(sigma_);
    const Grooves g = grooves(wo, wi);
    return over(albedo * std::max(0.0, by.once(g)) + albedo * albedo * (by.pairs * g.pairs),
                means().most_of(sigma_, albedo));
  }
  const double q = wi.x * wo.x + wi.y * wo.y;
  const double t = q > 0 ? q / std::max(wi.z, wo.z) : q;
  return albedo * (std::max(0.0, 1 + sigma_ * t) / (1 + evenly * sigma_));
}

Rgb Matte::reflectance(Rgb albedo, double cosine) const {
  if (form_ == 0) return albedo * qualitative_.reflectance(cosine);
  if (form_ == 1) {
    const Sloped by(sigma_);
    const Grooves g = means().at(cosine);
    return over(albedo * by.once(g) + albedo * albedo * (by.pairs * g.pairs), means().most_of(sigma_, albedo));
  }
  return albedo * ((1 + sigma_ * mean_of_improved(cosine)) / (1 + evenly * sigma_));
}

}  // namespace gonio::surface
