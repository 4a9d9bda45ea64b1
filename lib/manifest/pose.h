// Rigid motions with their sigmas: what sections of the manifest are made of.
#pragma once
#include <optional>
#include <vector>

#include "geom/rigid.h"

namespace gonio::manifest {

struct PoseSigma {
  std::vector<double> rotation_rad;   // 1 or 3 (x, y, z of a rotation vector applied on the left, in the `to` frame)
  std::vector<double> translation_m;  // 1 or 3
  bool operator==(const PoseSigma&) const = default;
};
// `{"rotation": [w,x,y,z], "translation_m": [x,y,z], "sigma": {...}}`; on input also `{"matrix": 4x4 row-major}`.
template <class To, class From>
struct Pose : Rigid<To, From> {
  std::optional<PoseSigma> sigma;
  bool operator==(const Pose&) const = default;
};

}  // namespace gonio::manifest
