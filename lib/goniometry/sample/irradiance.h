// What arrives at a point from one light, as directions with irradiances on a plane that faces each (W/m^2): one for
// lights without extent, a stratified set for others. Nothing is in the way.
#pragma once
#include <vector>

#include "light/light.h"

namespace gonio::goniometry {

struct Beam {
  Vec3 direction;  // unit, to the light
  Rgb weight;
};

inline void beams_at(const light::Emitter& light, Vec3 point_m, std::vector<Beam>& beams) {
  constexpr int strata = 4;
  beams.clear();
  for (int i = 0; i < strata; ++i)
    for (int k = 0; k < strata; ++k) {
      const light::Sample sample = light.sample(point_m, {(i + 0.5) / strata, (k + 0.5) / strata});
      if (sample.valid && sample.delta) {
        beams.push_back({sample.direction, sample.weight});
        return;
      }
      if (sample.valid) beams.push_back({sample.direction, sample.weight / (strata * strata)});
    }
}

}  // namespace gonio::goniometry
