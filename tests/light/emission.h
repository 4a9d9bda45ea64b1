// What a light sends out, seen two ways: by its photons (emit) and by the irradiance that its samples give.
#pragma once
#include <functional>
#include <vector>

#include "base/random.h"
#include "light/light.h"

namespace gonio::tests {

// A sum of photons of one bin: mean over all draws of flux that falls in, and the standard deviation of that mean.
class PhotonBin {
 public:
  void add(double flux) {
    sum_ += flux;
    squares_ += flux * flux;
  }
  double mean(double draws) const { return sum_ / draws; }
  double sigma(double draws) const {
    const double m = sum_ / draws;
    return std::sqrt(std::max(0.0, squares_ / draws - m * m) / draws);
  }

 private:
  double sum_ = 0, squares_ = 0;
};

// Irradiance, red, on a plane at `point` with this normal: the mean of cos weight over a grid of random numbers, which
// lies elsewhere each time. A lamp that draws cells of a picture is a step function of them: one and the same grid
// would be wrong by the same share everywhere.
inline double irradiance_at(const light::Emitter& emitter, Vec3 point_m, Vec3 normal, int grid, Random& random) {
  double sum = 0;
  const double right = random.uniform(), down = random.uniform();
  for (int i = 0; i < grid; ++i)
    for (int j = 0; j < grid; ++j) {
      const auto s = emitter.sample(point_m, {(i + right) / grid, (j + down) / grid});
      if (s.valid) sum += s.weight.x * std::max(0.0, dot(normal, s.direction));
    }
  return sum / (1.0 * grid * grid);
}

// A photon's meeting with the square of half-width `half` in the plane through `centre` with unit normal `n`; negative
// where it goes by.
struct Window {
  Vec3 centre_m;
  Basis frame;  // n looks to the light
  double half_m;
  bool meets(const light::Emission& photon) const {
    const double fall = -dot(photon.direction, frame.n);
    if (!(fall > 0)) return false;
    const double t = dot(photon.origin_m - centre_m, frame.n) / fall;
    const Vec3 at = frame.to_local(photon.origin_m + photon.direction * t - centre_m);
    return t > 0 && std::abs(at.x) <= half_m && std::abs(at.y) <= half_m;
  }
  // Power through it by the light's samples, red: midpoint rule over the window.
  double power(const light::Emitter& emitter, int steps, int grid) const {
    double sum = 0;
    Random random(7);
    for (int i = 0; i < steps; ++i)
      for (int j = 0; j < steps; ++j) {
        const Vec3 at = centre_m + frame.t * (half_m * ((2.0 * i + 1) / steps - 1)) +
                        frame.b * (half_m * ((2.0 * j + 1) / steps - 1));
        sum += irradiance_at(emitter, at, frame.n, grid, random);
      }
    return sum * 4 * half_m * half_m / (1.0 * steps * steps);
  }
};

}  // namespace gonio::tests
