// probe.reflectance on the reflectance of a ball: Schlick's rise to grazing for what is missing at normal incidence,
// and Lazanyi's dip before it, which metals of a high index have.
#pragma once
#include <algorithm>

#include "mechanism/mechanism.h"
#include "surface/fresnel.h"

namespace gonio::mechanism {
const Mechanism& probe_reflectance();
}

namespace gonio::equation {

constexpr double least_probe_reflectance = 0.01;

// c (1 - c)^6 over its largest value, at c = 1 / 7.
inline double lazanyi_dip(double cosine) {
  const double m = std::clamp(1 - cosine, 0.0, 1.0), m3 = m * m * m;
  constexpr double highest = 46656.0 / 823543.0;
  return (1 - m) * m3 * m3 / highest;
}

// `stated`: of the metal that the ball was taken for, at this cosine of incidence.
inline double probe_reflectance(double stated, double cosine, double normal, double dip) {
  if (normal == 0 && dip == 0) return stated;
  return std::max(least_probe_reflectance,
                  stated + normal * (1 - surface::schlick_rise(cosine)) - dip * lazanyi_dip(cosine));
}

}  // namespace gonio::equation
