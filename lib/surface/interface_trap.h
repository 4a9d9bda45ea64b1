// Light between a base and the inside of the clear interface over it. For every direction w' inside, of which the base
// reflects some, per band and with absorption A(w') = exp(-depth / w'z) on each way through the coat:
//   escapes(w')  = integral of f_base cos T A        leaves at once
//   trapped(w')  = integral of f_base cos (1 - T) A^2   comes down again
// What is trapped is taken as diffuse from then on; of diffuse light (cosine-weighted means, marked by a bar) the share
// escapes_bar / (1 - trapped_bar) leaves in the end. Sent out in proportion to T A trapped, which keeps the whole
// reciprocal, its law is
//   T(wo) T(wi) A A trapped(wo') trapped(wi') / (pi eta^2) * gain,   gain = escapes_bar / ((1 - trapped_bar) mean(T A
//   trapped))
// Exact for a Lambertian base (then it sums the series albedo^n R^n), nothing for a mirror under a smooth coat.
// Both integrals are tabulated, per azimuth where the base depends on it, with a break at the critical angle, and rest
// on fixed samples of the base, scaled to its albedo: a coat over white mirrors returns all light to 5e-2, over
// strongly anisotropic ones to 6e-2 (test: RoughCoat.OverWhiteMirrorsReturnsAllLight).
#pragma once
#include <cstddef>
#include <vector>

#include "surface/interface_coat.h"
#include "surface/surface.h"

namespace gonio::surface {

class InterfaceTrap {
 public:
  InterfaceTrap() = default;
  // By samples of the base's own, at fixed numbers: the same every time. A tenth of a millisecond or two; some twenty
  // times that where the base depends on the azimuth, of which most is spared while the base and eta stay.
  InterfaceTrap(const CoatInterface& interface, Rgb depth, const Layer& base);
  // Of unit directions inside, above the base.
  Rgb escapes(Vec3 inside) const { return at(escapes_, inside); }
  Rgb trapped(Vec3 inside) const { return at(trapped_, inside); }
  Rgb gain() const { return gain_; }
  // Of diffuse light inside, what leaves in the end.
  Rgb leaves() const { return leaves_; }

 private:
  // Nodes of the cosine: `below` from the horizon to the critical angle; `above` from there to the normal, equally
  // spaced in the root of the cosine outside.
  static constexpr std::size_t below = 4, above = 9, cosines = below + above, turns = 16;
  using Nodes = std::vector<Rgb>;  // by azimuth, then by cosine
  struct Drawn;
  static const Drawn& drawn_of(double eta, const Layer& base);
  static Vec3 node(double eta, std::size_t cosine, double azimuth_rad);
  void sum_node(std::size_t at, const Drawn& all, bool scaled, const CoatInterface& interface, Rgb depth);
  Rgb at(const Nodes& values, Vec3 inside) const;
  std::size_t azimuths_ = 1;
  double eta_ = 1, critical_ = 0;  // critical: cosine of that angle
  Nodes escapes_, trapped_;
  Rgb gain_, leaves_;
};

inline Rgb exp_of(Rgb v) {
  return {std::exp(v.x), std::exp(v.y), std::exp(v.z)};
}

// The trap of this interface over this base, remembered by each thread while neither changes.
const InterfaceTrap& trap_of(double eta, double alpha, Rgb depth, const Layer& base);

}  // namespace gonio::surface
