// See matter.h. Oren & Nayar, SIGGRAPH 1994, equations 30 to 32; Walter et al. 2007 for the coat.
#include "sealed/matter.h"

#include <algorithm>
#include <cmath>

namespace gonio::sealed {

double fresnel(double cosine, double f0) {  // dielectric, unpolarized, exact
  const double eta = (1 + std::sqrt(f0)) / (1 - std::sqrt(f0));
  const double cos_t = std::sqrt(1 - (1 - cosine * cosine) / (eta * eta));
  const double s = (cosine - eta * cos_t) / (cosine + eta * cos_t), p = (eta * cosine - cos_t) / (eta * cosine + cos_t);
  return 0.5 * (s * s + p * p);
}

// GGX facets, stretched along x (Heitz 2014, equations 71 and 86), height-correlated shadowing.
double facets(double ax, double ay, Vec3 n, Vec3 x, Vec3 wi, Vec3 wo) {
  const Vec3 y = cross(n, x), h = normalized(wi + wo);
  const double u = dot(h, x) / ax, v = dot(h, y) / ay, w = dot(h, n), sum = u * u + v * v + w * w;
  const double d = 1 / (pi * ax * ay * sum * sum);
  const auto lambda = [&](Vec3 k) {
    const double p = ax * dot(k, x), q = ay * dot(k, y), c = dot(k, n);
    return 0.5 * (std::sqrt(1 + (p * p + q * q) / (c * c)) - 1);
  };
  return d / (1 + lambda(wi) + lambda(wo)) / (4 * dot(n, wi) * dot(n, wo));
}

namespace {

double oren_nayar(Vec3 n, Vec3 wi, Vec3 wo, double slope, double albedo) {  // times pi / albedo
  if (!(slope > 0)) return 1;
  const double ci = dot(n, wi), co = dot(n, wo), ti = std::acos(std::min(1.0, ci)), to = std::acos(std::min(1.0, co));
  const Vec3 pi_ = wi - n * ci, po = wo - n * co;
  const double lengths = norm(pi_) * norm(po), cos_phi = lengths > 1e-12 ? dot(pi_, po) / lengths : 0;
  const double s2 = slope * slope, a = std::max(ti, to), b = std::min(ti, to);
  const double c1 = 1 - 0.5 * s2 / (s2 + 0.33);
  double c2 = 0.45 * s2 / (s2 + 0.09);
  c2 *= cos_phi >= 0 ? std::sin(a) : std::sin(a) - std::pow(2 * b / pi, 3);
  const double c3 = 0.125 * s2 / (s2 + 0.09) * std::pow(4 * a * b / (pi * pi), 2);
  const double one = c1 + cos_phi * c2 * std::tan(b) + (1 - std::abs(cos_phi)) * c3 * std::tan(0.5 * (a + b));
  const double two = 0.17 * albedo * s2 / (s2 + 0.13) * (1 - cos_phi * std::pow(2 * b / pi, 2));
  return one + two;
}

double gloss(const Matter& m, Vec3 n, Vec3 x, Vec3 wi, Vec3 wo) {
  const double root = std::sqrt(m.stretch);
  double f = (1 - m.tail) * facets(m.alpha * root, m.alpha / root, n, x, wi, wo);
  if (m.tail > 0) f += m.tail * facets(m.tail_alpha, m.tail_alpha, n, x, wi, wo);
  return fresnel(dot(wi, normalized(wi + wo)), m.f0) * f;
}

// What a coat lets through, there and back; smooth enough a coat that its own roughness does not matter for this.
double base_share(const Matter& m, Vec3 n, Vec3 wi, Vec3 wo) {
  if (!(m.f0 > 0)) return 1;
  const double mean_loss = m.f0 + (1 - m.f0) / 21;  // Schlick's law, averaged over the hemisphere
  return (1 - fresnel(dot(n, wi), m.f0)) * (1 - fresnel(dot(n, wo), m.f0)) / (1 - mean_loss);
}

// A Gaussian lobe about the lamp, normalised so that `retro` is the share of normally incident light.
double sent_to_lamp(const Matter& m, Vec3 n, Vec3 wi, Vec3 wo) {
  const double angle = std::acos(std::clamp(dot(wi, wo), -1.0, 1.0)), w2 = m.retro_width * m.retro_width;
  return m.retro * std::exp(-0.5 * angle * angle / w2) / (2 * pi * w2) / std::max(0.1, dot(n, wi));
}

}  // namespace

Scattering scatter(const Matter& m, Vec3 n, Vec3 x, Vec3 wi, Vec3 wo) {
  Scattering f;
  const double share = base_share(m, n, wi, wo) / pi;
  f.base = {share * oren_nayar(n, wi, wo, m.slope_rad, m.albedo.x),
            share * oren_nayar(n, wi, wo, m.slope_rad, m.albedo.y),
            share * oren_nayar(n, wi, wo, m.slope_rad, m.albedo.z)};
  if (m.f0 > 0) f.coat = gloss(m, n, x, wi, wo);
  if (m.retro > 0) {
    f.base *= 1 - m.retro;
    f.coat = (1 - m.retro) * f.coat + sent_to_lamp(m, n, wi, wo);
  }
  return f;
}

}  // namespace gonio::sealed
