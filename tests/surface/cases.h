// Parameter values and directions for tests that walk the registry of surfaces: nothing here names a model.
#pragma once
#include <algorithm>
#include <string>
#include <vector>

#include "base/random.h"
#include "surface/surface.h"

namespace gonio::tests {

struct SurfaceCase {
  const surface::Model* model;
  surface::Values values;
  std::string name;
};

// A value inside the bounds, denser towards the lower one, where lobes are narrow.
inline double draw_value(const manifest::ParameterInfo& info, Random& random) {
  const double lower = std::isfinite(info.lower) ? info.lower : -1, upper = std::isfinite(info.upper) ? info.upper : 1;
  const double u = random.uniform();
  return lower + (upper - lower) * u * u;
}

inline surface::Values draw_values(const surface::Model& model, Random& random) {
  surface::Values values;
  std::size_t i = 0;
  for (const auto& info : model.info().parameters) {
    const double x = draw_value(info, random);
    values.v[i++] = info.rgb ? Rgb{x, draw_value(info, random), draw_value(info, random)} : Rgb{x, x, x};
  }
  return values;
}

inline surface::Values at_bound(const surface::Model& model, bool upper) {
  surface::Values values;
  std::size_t i = 0;
  for (const auto& info : model.info().parameters) {
    const double x = upper ? info.upper : info.lower;
    values.v[i++] = {x, x, x};
  }
  return values;
}

// All registered models: every parameter at its lower bound, at its upper bound, one at a time at either, and
// `random_cases` drawn.
inline std::vector<SurfaceCase> surface_cases(int random_cases, std::uint64_t seed) {
  std::vector<SurfaceCase> cases;
  Random random(seed);
  for (const surface::Model* model : surface::all_models()) {
    const std::string id = model->info().id;
    cases.push_back({model, at_bound(*model, false), id + " at lower bounds"});
    cases.push_back({model, at_bound(*model, true), id + " at upper bounds"});
    for (int k = 0; k < random_cases; ++k)
      cases.push_back({model, draw_values(*model, random), id + " drawn " + std::to_string(k)});
    for (std::size_t i = 0; i < model->info().parameters.size(); ++i) {
      SurfaceCase mixed{model, draw_values(*model, random), id + " with low " + model->info().parameters[i].name};
      const double low = model->info().parameters[i].lower;
      mixed.values.v[i] = {low, low, low};
      cases.push_back(mixed);
    }
  }
  return cases;
}

inline Vec3 at_zenith(double degrees, double azimuth_rad = 0.7) {
  const double theta = degrees * pi / 180;
  return {std::sin(theta) * std::cos(azimuth_rad), std::sin(theta) * std::sin(azimuth_rad), std::cos(theta)};
}

// Above the horizon; every fourth one grazes it, down to 1e-300.
inline Vec3 draw_direction(Random& random) {
  const double z = random.below(4) == 0 ? std::pow(10.0, -300 * random.uniform() * random.uniform()) : random.uniform();
  const double r = std::sqrt(std::max(0.0, 1 - z * z)), phi = 2 * pi * random.uniform();
  return {r * std::cos(phi), r * std::sin(phi), z};
}

struct Reflectance {
  Rgb mean, standard_error;
};

// Reflectance by the model's own sampler: the additive recurrence of Roberts 2018 (R3), eight times from random starts.
inline Reflectance reflectance_by_sampling(const surface::Model& model, const surface::Values& values, Vec3 wo,
                                           int count = 5000) {
  constexpr int repeats = 8;
  const auto part = [](double x) { return x - std::floor(x); };
  Random random(99);
  Rgb sum, squares;
  for (int r = 0; r < repeats; ++r) {
    const double a = random.uniform(), b = random.uniform(), c = random.uniform();
    Rgb one;
    for (int i = 0; i < count; ++i) {
      const Vec2 u{part(a + i * 0.8191725133961645), part(b + i * 0.6710436067037893)};
      one += model.sample(values, wo, u, part(c + i * 0.5497004779019703)).weight;
    }
    one = one / count;
    sum += one;
    squares += one * one;
  }
  const Rgb mean = sum / repeats, variance = (squares / repeats - mean * mean) / (repeats - 1);
  const auto root = [](double v) { return std::sqrt(std::max(0.0, v)); };
  return {mean, {root(variance.x), root(variance.y), root(variance.z)}};
}

}  // namespace gonio::tests
