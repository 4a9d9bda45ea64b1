// Flight through a homogeneous medium that scatters, and the direction that scattering gives.
//
// Distances are drawn for one band and weighted over all of them: with p_k the probability of band k,
//   density(t) = sum_k p_k sigma_t,k exp(-sigma_t,k t),   survival(d) = sum_k p_k exp(-sigma_t,k d)
// scattering at t weighs sigma_s T(t) / density(t), reaching d weighs T(d) / survival(d) (single-sample balance
// heuristic over the bands: Veach 1997, section 9.2.4). p_k is in proportion to what the path still carries in band k,
// so that a path of one band is sampled exactly. Directions: Henyey & Greenstein 1941,
//   p(cos) = (1 - g^2) / (4 pi (1 + g^2 - 2 g cos)^(3/2)),   cos between the directions of travel
// drawn for one band likewise.
#pragma once
#include <algorithm>
#include <cmath>

#include "render/media.h"

namespace gonio::render {

class FreeFlight {
 public:
  FreeFlight(const surface::Medium& medium, Rgb power)
      : medium_(medium), sigma_t_(medium.sigma_a_per_m + medium.sigma_s_per_m) {
    const double sum = power.x + power.y + power.z;
    share_ = sum > 0 ? power / sum : Rgb{1, 1, 1} / 3;
  }
  double distance_m(double u) const {
    const double sigma = sigma_t_[band(u)];
    return sigma > 0 ? -std::log1p(-u) / sigma : far_away;
  }
  Rgb scatter_weight(double distance_m) const {
    const Rgb t = transmittance(medium_, distance_m);
    return medium_.sigma_s_per_m * t / dot(share_, sigma_t_ * t);
  }
  Rgb reach_weight(double distance_m) const {
    const Rgb t = transmittance(medium_, distance_m);
    return t / dot(share_, t);
  }
  struct Turn {
    Vec3 direction;
    Rgb weight;
    double density = 0;
  };
  Rgb phase(double cosine) const {
    return {henyey_greenstein(medium_.g.x, cosine), henyey_greenstein(medium_.g.y, cosine),
            henyey_greenstein(medium_.g.z, cosine)};
  }
  double density(Rgb phase) const { return dot(share_, phase); }
  Turn turn(Vec3 travel, Vec2 u) const {
    const double g = medium_.g[band(u.x)];
    const double cosine = henyey_greenstein_cosine(g, u.x), phi = 2 * pi * u.y;
    const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    const Rgb phase = this->phase(cosine);
    const double pdf = density(phase);
    return {Basis(travel).to_world({sine * std::cos(phi), sine * std::sin(phi), cosine}), phase / pdf, pdf};
  }

 private:
  static double henyey_greenstein(double g, double cosine) {
    const double square = 1 + g * g - 2 * g * cosine;
    return (1 - g * g) / (4 * pi * square * std::sqrt(square));
  }
  static double henyey_greenstein_cosine(double g, double u) {
    if (std::abs(g) < 1e-3) return 1 - 2 * u - 1.5 * g * (4 * u * u - 4 * u);  // to first order in g: error below 2e-6
    const double q = (1 - g * g) / (1 + g - 2 * g * u);
    return std::clamp((1 + g * g - q * q) / (2 * g), -1.0, 1.0);
  }
  // Draws a band and leaves in `u` what is still uniform.
  int band(double& u) const {
    int k = 0;
    double left = u;
    while (k < 2 && left >= share_[k]) left -= share_[k++];
    u = share_[k] > 0 ? std::clamp(left / share_[k], 0.0, 1 - 1e-12) : 0.5;
    return k;
  }
  int band(double&& u) const = delete;

  const surface::Medium& medium_;
  Rgb sigma_t_, share_;
};

}  // namespace gonio::render
