// Light between a base and the inside of the clear interface over it. For every direction w' inside, of which the base
// reflects some, per band and with absorption A(w') = exp(-depth / w'z) on each way through the coat:
//   escapes(w')  = integral of f_base cos T A        leaves at once
//   trapped(w')  = integral of f_base cos (1 - T) A^2   comes down again
// What is trapped is taken as diffuse from then on; of diffuse light (cosine-weighted means, marked by a bar) the share
// escapes_bar / (1 - trapped_bar) leaves in the end. Sent out in proportion to T A trapped, which keeps the whole
// reciprocal, its law is
//   T(wo) T(wi) A A trapped(wo') trapped(wi') / (pi eta^2) * gain,   gain = escapes_bar / ((1 - trapped_bar) mean(T A
//   trapped))
// Exact for a Lambertian base (then it sums the series albedo^n R^n), nothing for a mirror under a smooth coat; energy
// is never made, as escapes + trapped <= albedo of the base.
#pragma once
#include <array>

#include "surface/interface_coat.h"
#include "surface/surface.h"

namespace gonio::surface {

class InterfaceTrap {
 public:
  InterfaceTrap() = default;
  // By samples of the base's own, at fixed numbers: the same every time (some tens of microseconds).
  InterfaceTrap(const CoatInterface& interface, Rgb depth, const Layer& base);
  Rgb escapes(double cosine_inside) const { return at(escapes_, cosine_inside); }
  Rgb trapped(double cosine_inside) const { return at(trapped_, cosine_inside); }
  Rgb gain() const { return gain_; }
  // Of diffuse light inside, what leaves in the end.
  Rgb leaves() const { return leaves_; }

 private:
  static constexpr std::size_t nodes = 9;
  using Nodes = std::array<Rgb, nodes>;
  static Rgb at(const Nodes& values, double cosine) {
    const double p = std::clamp(cosine, 0.0, 1.0) * (nodes - 1);
    const std::size_t low = std::min(static_cast<std::size_t>(p), nodes - 2);
    return values[low] + (values[low + 1] - values[low]) * (p - static_cast<double>(low));
  }
  Nodes escapes_, trapped_;
  Rgb gain_, leaves_;
};

inline Rgb exp_of(Rgb v) {
  return {std::exp(v.x), std::exp(v.y), std::exp(v.z)};
}

// The trap of this interface over this base, remembered by each thread while neither changes.
const InterfaceTrap& trap_of(double eta, double alpha, Rgb depth, const Layer& base);

}  // namespace gonio::surface
