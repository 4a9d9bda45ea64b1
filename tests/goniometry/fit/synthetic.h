// Samples of a registered surface as a goniometer takes them: known truth, stated noise.
#pragma once
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "base/random.h"
#include "goniometry/samples.h"
#include "surface/surface.h"

namespace gonio::tests {

inline Vec3 direction(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

// Numbers by name; what is left out has its preset.
inline surface::Values values_with(const surface::Model& model, const std::map<std::string, Rgb>& numbers) {
  surface::Values values;
  std::size_t i = 0;
  for (const auto& p : model.info().parameters) {
    const double preset = p.preset.value_or(0.5);
    const auto found = numbers.find(p.name);
    values.v[i++] = found != numbers.end() ? found->second : Rgb{preset, preset, preset};
  }
  return values;
}
inline Rgb grey(double x) {
  return {x, x, x};
}

// Incidences 0.1 to 1.2 rad in steps; directions in a plane and around it, denser about the mirror direction.
inline goniometry::Samples directions_of(int incidences, int per_incidence, std::uint64_t seed) {
  goniometry::Samples s;
  s.name = "synthetic";
  s.band_name = {"r", "g", "b"};
  Random random(seed, 3);
  for (int i = 0; i < incidences; ++i) {
    const double theta = 0.1 + 1.1 * i / std::max(1, incidences - 1);
    for (int k = 0; k < per_incidence; ++k) {
      const bool near = k % 2 == 0;
      double to = near ? theta + 0.25 * random.normal() : random.uniform(0, 1.3);
      double phi = near ? pi + 0.25 * random.normal() : random.uniform(-pi, pi);
      if (to < 0) to = -to, phi += pi;
      if (to > 1.35) to = random.uniform(0, 1.3);
      s.wi.push_back(direction(theta, 0));
      s.wo.push_back(direction(to, phi));
      s.series.push_back(static_cast<std::size_t>(i));
      s.place.push_back("synthetic:" + std::to_string(s.wi.size()));
    }
  }
  return s;
}

// f with noise of `relative` and `floor` (1/sr), stated in sigma where `state`.
inline void measure(goniometry::Samples& s, const surface::Model& model, const surface::Values& truth, double relative,
                    double floor, std::uint64_t seed, bool state) {
  s.f.clear(), s.sigma.clear();
  Random random(seed, 4);
  for (std::size_t r = 0; r < s.rows(); ++r) {
    const Rgb f = model.evaluate(truth, s.wo[r], s.wi[r]);
    for (std::size_t b = 0; b < s.bands(); ++b) {
      const double sigma = std::hypot(relative * f[static_cast<int>(b)], floor);
      s.f.push_back(f[static_cast<int>(b)] + sigma * random.normal());
      if (state) s.sigma.push_back(sigma);
    }
  }
}

}  // namespace gonio::tests
