// A half space of a medium behind a smooth interface, by the dipole models and by photons.
#pragma once
#include <cmath>
#include <memory>
#include <vector>

#include "subsurface_photons.h"
#include "surface/dipole_model.h"

namespace gonio::tests {

inline Rgb grey(double x) {
  return {x, x, x};
}

struct Built {  // a model in one medium
  const surface::Model* model;
  surface::Values values;
  std::shared_ptr<const surface::Prepared> prepared;
  Built(const char* id, const HalfSpace& m, double alpha = 0) : model(surface::find(id)) {
    values.v = {grey(m.eta), grey(alpha), grey(m.sigma_a), grey(m.sigma_s), grey(m.g)};
    prepared = model->prepare(values, {}, "test");
    values.prepared = prepared.get();
  }
  const surface::DipoleSubsurface& beneath() const { return static_cast<const surface::DipoleSubsurface&>(*prepared); }
  // Exitance per flux that enters at the origin along `inward`.
  double exitance(Vec3 inward, Vec3 exit) const {
    const double passes = surface::InteriorFresnel(values.v[0].x).transmits_in;
    return pi * passes * beneath().evaluate({{}, {0, 0, 1}, inward}, exit, {0, 0, 1}).x;
  }
  // The same over the ring between two radii.
  double ring(Vec3 inward, double inner, double outer) const {
    constexpr int radii = 40, angles = 24;
    double sum = 0;
    for (int k = 0; k < radii; ++k)
      for (int a = 0; a < angles; ++a) {
        const double r = inner + (outer - inner) * (k + 0.5) / radii, phi = 2 * pi * (a + 0.5) / angles;
        sum += exitance(inward, {r * std::cos(phi), r * std::sin(phi), 0}) * r;
      }
    return sum * 2 * pi * (outer - inner) / (radii * angles);
  }
};

inline Vec3 inwards(double cosine, double eta) {
  return surface::refracted_inwards({std::sqrt(1 - cosine * cosine), 0, cosine}, {0, 0, 1}, eta);
}

struct Photographed {  // what photons say, per flux that enters
  double whole = 0, sigma = 0;
  std::vector<double> rings;
};
inline Photographed photographed(const HalfSpace& m, double cosine, const std::vector<double>& edges, int count) {
  Photons photons(m, 31);
  Photographed result{0, 0, std::vector<double>(edges.size() - 1)};
  double squares = 0;
  for (int i = 0; i < count; ++i) {
    const Escape escape = photons.trace(inwards(cosine, m.eta));
    result.whole += escape.weight / count;
    squares += escape.weight * escape.weight / count;
    const double r = std::hypot(escape.position.x, escape.position.y);
    for (std::size_t b = 0; b + 1 < edges.size(); ++b)
      if (r >= edges[b] && r < edges[b + 1]) result.rings[b] += escape.weight / count;
  }
  result.sigma = std::sqrt((squares - result.whole * result.whole) / count);
  return result;
}

}  // namespace gonio::tests
