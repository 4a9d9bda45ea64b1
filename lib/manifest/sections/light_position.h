// "light_positions": of lights that a robot carries.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "manifest/pose.h"

namespace gonio::manifest {

struct LightPosition {  // "light_positions": where a light was while its robot stood at a pose
  std::string id, light, robot;
  std::optional<Pose<frame::Base, frame::Tool>> base_from_tool;
  std::vector<double> position_m, sigma_m;  // world; sigma: 1 or 3
  std::vector<double> covariance_m2{};      // 3 x 3, row by row; where it stands, sigma_m says nothing more
};

}  // namespace gonio::manifest
