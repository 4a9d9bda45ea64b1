// See matter.h. Oren & Nayar, SIGGRAPH 1994, equations 30 to 32; Walter et al. 2007 for the coat.
#include "sealed/matter.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace gonio::sealed {

namespace {

// Of light that swings across the plane of incidence, and in it.
std::array<double, 2> fresnel_both(double cosine, double f0) {
  const double eta = (1 + std::sqrt(f0)) / (1 - std::sqrt(f0));
  const double cos_t = std::sqrt(1 - (1 - cosine * cosine) / (eta * eta));
  const double s = (cosine - eta * cos_t) / (cosine + eta * cos_t), p = (eta * cosine - cos_t) / (eta * cosine + cos_t);
  return {s * s, p * p};
}

}  // namespace

double fresnel(double cosine, double f0) {
  const auto [s, p] = fresnel_both(cosine, f0);
  return 0.5 * (s + p);
}

double fresnel(const Polarized& light, Vec3 wi, Vec3 h, double f0) {
  const auto [s, p] = fresnel_both(dot(wi, h), f0);
  const Vec3 across = cross(wi, h), swings = light.axis - wi * dot(light.axis, wi);
  const double lengths = norm(across) * norm(swings);
  if (light.degree == 0 || lengths < 1e-12) return 0.5 * (s + p);
  const double cosine = dot(across, swings) / lengths, towards_s = light.degree * (2 * cosine * cosine - 1);
  return 0.5 * (s * (1 + towards_s) + p * (1 - towards_s));
}

CoatAlbedo::CoatAlbedo(double f0, double alpha) {
  constexpr int count = 3000;
  for (int k = 0; k < nodes; ++k) {
    const double c = (k + 0.5) / nodes;
    const Vec3 wi{std::sqrt(1 - c * c), 0, c};
    double& sum = sent_back_[static_cast<std::size_t>(k)];
    for (int i = 0; i < count; ++i) {
      const double u = (i + 0.5) / count, phi = 2 * pi * std::fmod(i * 0.6180339887498949, 1.0);
      const double tangent = alpha * std::sqrt(u / (1 - u)), z = 1 / std::sqrt(1 + tangent * tangent);
      const Vec3 h{z * tangent * std::cos(phi), z * tangent * std::sin(phi), z};
      const Vec3 wo = h * (2 * dot(wi, h)) - wi;
      if (dot(wi, h) <= 0 || wo.z <= 0) continue;
      const double bend = 1 + tangent * tangent / (alpha * alpha);
      const double density = 1 / (pi * alpha * alpha * z * z * z * bend * bend) / (4 * dot(wi, h));  // of wo, 1/sr
      sum += fresnel(dot(wi, h), f0) * facets(alpha, alpha, {0, 0, 1}, {1, 0, 0}, wi, wo) * wo.z / density / count;
    }
    mean_ += 2 * sum * c / nodes;
  }
}
double CoatAlbedo::at(double cosine) const {
  const double place = std::clamp(cosine * nodes - 0.5, 0.0, nodes - 1.001);
  const auto k = static_cast<std::size_t>(place);
  return sent_back_[k] + (place - static_cast<double>(k)) * (sent_back_[k + 1] - sent_back_[k]);
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

double gloss(const Matter& m, Vec3 n, Vec3 x, Vec3 wi, Vec3 wo, const Polarized& light) {
  const double root = std::sqrt(m.stretch);
  double f = (1 - m.tail) * facets(m.alpha * root, m.alpha / root, n, x, wi, wo);
  if (m.tail > 0) f += m.tail * facets(m.tail_alpha, m.tail_alpha, n, x, wi, wo);
  return fresnel(light, wi, normalized(wi + wo), m.f0) * f;
}

// What a coat lets through, there and back. Where nothing else is given, it is smooth enough that its own roughness
// does not matter for this.
double base_share(const Matter& m, Vec3 n, Vec3 wi, Vec3 wo, const Polarized& light) {
  if (!(m.f0 > 0)) return 1;
  const double more = fresnel(dot(n, wi), m.f0) - fresnel(light, wi, n, m.f0);  // let in of polarized light
  if (m.coat != nullptr)
    return (1 - m.coat->at(dot(n, wi)) + more) * (1 - m.coat->at(dot(n, wo))) / (1 - m.coat->mean());
  const double mean_loss = m.f0 + (1 - m.f0) / 21;  // Schlick's law, averaged over the hemisphere
  return (1 - fresnel(dot(n, wi), m.f0) + more) * (1 - fresnel(dot(n, wo), m.f0)) / (1 - mean_loss);
}

// A Gaussian lobe about the lamp, normalised so that `retro` is the share of normally incident light.
double sent_to_lamp(const Matter& m, Vec3 n, Vec3 wi, Vec3 wo) {
  const double angle = std::acos(std::clamp(dot(wi, wo), -1.0, 1.0)), w2 = m.retro_width * m.retro_width;
  return m.retro * std::exp(-0.5 * angle * angle / w2) / (2 * pi * w2) / std::max(0.1, dot(n, wi));
}

}  // namespace

Scattering scatter(const Matter& m, Vec3 n, Vec3 x, Vec3 wi, Vec3 wo, const Polarized& light) {
  Scattering f;
  const double share = base_share(m, n, wi, wo, light) / pi;
  f.base = {share * oren_nayar(n, wi, wo, m.slope_rad, m.albedo.x),
            share * oren_nayar(n, wi, wo, m.slope_rad, m.albedo.y),
            share * oren_nayar(n, wi, wo, m.slope_rad, m.albedo.z)};
  if (m.f0 > 0) f.coat = gloss(m, n, x, wi, wo, light);
  if (m.retro > 0) {
    f.base *= 1 - m.retro;
    f.coat = (1 - m.retro) * f.coat + sent_to_lamp(m, n, wi, wo);
  }
  return f;
}

}  // namespace gonio::sealed
