// Diffuse reflection of a rough surface: V-shaped Lambertian grooves whose slopes have a standard deviation of sigma,
// rad. Oren & Nayar 1994, the qualitative model (their equation 30), which is reciprocal:
//   f = albedo / pi (A + B max(0, cos(phi_i - phi_o)) sin(a) tan(b))
//   a = max(theta_i, theta_o),  b = min(theta_i, theta_o)
//   A = 1 - 0.5 sigma^2 / (sigma^2 + 0.33),  B = 0.45 sigma^2 / (sigma^2 + 0.09)
// In vectors, sin(a) tan(b) cos(phi_i - phi_o) = (wi.wo - wiz woz) / max(wiz, woz). The directional albedo rises
// towards grazing views, up to A + B / 2 for albedo 1, which exceeds 1 by as much as 1.6 % for sigma < 0.33: there A
// and B are divided by it, so that energy holds; the shape of the lobe does not change.
// At sigma = 0 this is Lambert's law to the last bit. Light between grooves (their interreflection term) is left out.
#pragma once
#include <algorithm>
#include <cmath>

#include "geom/vector.h"

namespace gonio::surface {

template <class T>
class OrenNayarOf {
 public:
  explicit OrenNayarOf(const T& sigma_rad) {
    const T s2 = sigma_rad * sigma_rad;
    const T a = 1 - 0.5 * s2 / (s2 + 0.33), b = 0.45 * s2 / (s2 + 0.09);
    const T grazing = std::max(T(1.0), a + b / 2);
    a_ = a / grazing;
    b_ = b / grazing;
  }
  // pi f / albedo, for directions above the horizon.
  T shape(Vec3 wo, Vec3 wi) const { return a_ + b_ * std::max(0.0, wi.x * wo.x + wi.y * wo.y) / std::max(wi.z, wo.z); }
  // Directional-hemispherical reflectance over albedo: the integral of shape cos / pi, in closed form.
  T reflectance(double cosine) const {
    const double c = std::clamp(cosine, 0.0, 1.0), s = std::sqrt(1 - c * c);
    // tan(theta) (1 - sin^3(theta)) without its 0 * infinity: 1 - s = c^2 / (1 + s)
    const double beyond = s * c * (1 + s + s * s) / (1 + s);
    return a_ + b_ * (s * (std::acos(c) - s * c) + 2.0 / 3 * beyond) / pi;
  }

 private:
  T a_, b_;
};
using OrenNayar = OrenNayarOf<double>;

}  // namespace gonio::surface
