// A surface embossed with z = A sin(k_u u) sin(k_v v), whose facets carry Beckmann's roughness. Local frame: u turned
// from +x by the azimuth, v = n x u.
//
// Slopes. With a = A k_u and b = A k_v the slopes of the pattern are a cos(x) sin(y) and b sin(x) cos(y), x and y
// uniform. In s = x + y and t = x - y, uniform and independent too,
//   p = a (sin s - sin t) / 2,   q = b (sin s + sin t) / 2:
// p / a + q / b and q / b - p / a are two independent sines. Roughness adds a slope with variance alpha^2 / 2 on each
// axis. The density P(p, q) of the sum is integrated over s and t by the midpoint rule, which converges exponentially
// for these periodic integrands; steps are half of the roughness, and only those within five standard deviations count.
// The inner integral, a sine blurred by roughness, is a function of one number: BlurredSine keeps it for one pattern.
// Where a = b the integral over the other sine is a factor of the same kind.
// Per unit of the macroscopic area, the density of normals is D(h) = P(-h_u / h_z, -h_v / h_z) / h_z^4.
//
// Masking. What facets show to w is P1(w) = E[(w_z + p w_u + q w_v)^+] over the slopes (facets are (-p, -q, 1));
// masking that does not ask for the facet's normal keeps energy where G1 P1 <= w_z. Smith's takes the equality, and
// with heights correlated (Heitz 2014, equations 14 and 99)
//   f = F D(h) / (4 (wiz P1(wo) + woz P1(wi) - wiz woz)),   integral of f wiz dwi <= 1 for F <= 1.
//
// Luongo et al. 2020, "Microstructure control in 3D printing with digital light processing", appendix B, take for G1(w)
// the product over both axes of the share of a period of A cos(k x) that the projection of w onto the plane of the axis
// and the normal sees: with m = cot(theta) / (A k) < 1 the tangent at sin(k x0) = -m meets the next crest at x1,
//   cos(k x1) = cos(k x0) + m (k x1 - k x0),   G1 = 1 - |k x1 - k x0| / (2 pi),
// a function of m alone, tabulated once. Along one axis it falls like sqrt(m), slower than cos(theta), and knows
// nothing of facets that turn away: there D and this G1 reflect more than arrives, without limit towards grazing
// angles. So it is bounded, G1 = min(published, w_z / P1(w)), and f = F D(h) G1(wi) G1(wo) / (4 wiz woz). `projections`
// mixes the two: 0 is Smith's, 1 the published masking under its bound. Light reflected twice is left out.
// tests/surface/sinusoidal_test.cpp compares both with rays through the actual pattern: the published masking is far
// too dark for two axes, since every direction is masked by both profiles at their full amplitude.
#pragma once
#include <vector>

#include "geom/vector.h"

namespace gonio::surface {

// Slopes above this are taken as this: beyond, light between facets makes most of the reflection.
inline constexpr double steepest_pattern = 4;

// mean of exp(-((x - sin t) / width)^2 / 2) over t; cubic between knots, to 1e-4.
class BlurredSine {
 public:
  explicit BlurredSine(double width);
  double at(double x) const;
  double width() const { return width_; }
  const std::vector<double>& sines() const { return sines_; }  // of the steps over the other sine

 private:
  double width_, steps_per_unit_;
  std::vector<Vec2> knots_;  // value, and derivative times the distance of knots
  std::vector<double> sines_;
};

class Sinusoid {
 public:
  // slope_u, slope_v: a and b. `table` serves where it was made for this pattern's least_width().
  Sinusoid(double slope_u, double slope_v, double alpha, double azimuth_rad, const BlurredSine* table = nullptr);
  double least_width() const;

  double density_of_normals(Vec3 h) const;
  double published_masking(Vec3 w) const;
  double area_seen(Vec3 w) const;  // P1
  // The BRDF for a Fresnel factor of one.
  double lobe(Vec3 wo, Vec3 wi, Vec3 h, double projections) const {
    return density_of_normals(h) * masking(wo, wi, projections) / 4;
  }
  // G / (wiz woz), finite at grazing angles.
  double masking(Vec3 wo, Vec3 wi, double projections) const;
  // A normal drawn with the density D(h) h_z from numbers in [0, 1).
  Vec3 normal(double s, double t, Vec2 roughness) const;

 private:
  double density_of_slopes(double p, double q) const;
  Vec3 turned(Vec3 w) const { return {cos_ * w.x + sin_ * w.y, cos_ * w.y - sin_ * w.x, w.z}; }
  double a_, b_, alpha_, cos_, sin_;
  const BlurredSine* table_;
};

}  // namespace gonio::surface
