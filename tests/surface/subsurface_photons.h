// Photons in a homogeneous half space z < 0 behind a smooth interface: an independent Monte Carlo program that shares
// nothing with the renderer (Wang, Jacques & Zheng 1995). Weights lose what is absorbed; roulette ends them; Henyey &
// Greenstein's phase function; Fresnel reflection at the boundary by chance.
#pragma once
#include <cmath>
#include <vector>

#include "base/random.h"
#include "geom/vector.h"

namespace gonio::tests {

struct HalfSpace {
  double sigma_a, sigma_s, g, eta;
};
struct Escape {  // per flux that enters
  Vec3 position, direction;
  double weight;
  int scattered;
};

class Photons {
 public:
  Photons(const HalfSpace& medium, std::uint64_t seed) : m_(medium), random_(seed) {}

  // One photon that has entered at the origin along the unit `direction` (z < 0). weight 0: it was absorbed.
  Escape trace(Vec3 direction) {
    const double sigma_t = m_.sigma_a + m_.sigma_s, albedo = m_.sigma_s / sigma_t;
    Vec3 p{0, 0, 0};
    double weight = 1;
    for (int scattered = 0;; ++scattered) {
      double left = -std::log(1 - random_.uniform()) / sigma_t;
      while (p.z + direction.z * left > 0) {
        const double to_surface = -p.z / direction.z;
        p += direction * to_surface;
        left -= to_surface;
        p.z = 0;
        if (random_.uniform() >= reflectance(direction.z)) return {p, refracted(direction), weight, scattered};
        direction.z = -direction.z;
      }
      p += direction * left;
      weight *= albedo;
      if (weight < 0.05) {
        if (random_.uniform() >= 0.2) return {p, direction, 0, scattered};
        weight *= 5;
      }
      direction = turned(direction);
    }
  }

 private:
  double reflectance(double c) const {  // from within
    const double sine = m_.eta * std::sqrt(std::max(0.0, 1 - c * c));
    if (sine >= 1) return 1;
    const double t = std::sqrt(1 - sine * sine);
    const double s = (m_.eta * c - t) / (m_.eta * c + t), p = (m_.eta * t - c) / (m_.eta * t + c);
    return (s * s + p * p) / 2;
  }
  Vec3 refracted(Vec3 d) const {
    const double x = d.x * m_.eta, y = d.y * m_.eta;
    return {x, y, std::sqrt(std::max(0.0, 1 - x * x - y * y))};
  }
  Vec3 turned(Vec3 d) {
    const double u = random_.uniform(), phi = 2 * pi * random_.uniform(), g = m_.g;
    double c = 2 * u - 1;
    if (g != 0) {
      const double q = (1 - g * g) / (1 - g + 2 * g * u);
      c = (1 + g * g - q * q) / (2 * g);
    }
    const double s = std::sqrt(std::max(0.0, 1 - c * c));
    return normalized(Basis(d).to_world({s * std::cos(phi), s * std::sin(phi), c}));
  }

  HalfSpace m_;
  Random random_;
};

}  // namespace gonio::tests
