// Hand-eye calibration of a light: it sits on a robot's tool and cannot look at a board, but where it was at several
// poses of the robot is known in the world. Wanted are its place in the tool, l, and the robot's base in the world, W:
//   position = W * base_from_tool * l          at every pose,
// by weighted least squares (Gauss-Newton) from the best of several starts, each an alternation of Procrustes' problem
// for W (Umeyama, PAMI 13(4), 1991) and a linear problem for l. Every position has its sigma or its covariance; what it
// cannot explain is estimated as one more noise by restricted maximum likelihood: the robot's. Directions that the
// poses leave open are named and never returned as numbers: with shifts alone, l cannot be told from the base; with
// turns about one axis its part along the axis.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "geom/rigid.h"
#include "manifest/sections/forward.h"

namespace gonio::robot {

struct LightSample {
  std::string id;
  Rigid<frame::Base, frame::Tool> base_from_tool;
  Vec3 position_m, sigma_m;             // world; sigma above 0
  std::optional<Mat3> covariance_m2{};  // where the coordinates' errors go together; its diagonal is sigma_m squared
};
struct LightMounting {
  Rigid<frame::World, frame::Base> world_from_base;
  Vec3 light_in_tool_m;
  // Turn of W (rad, about the world's axes through the base), shift of W, light in tool (m); row-major; widened for few
  // samples so that 1.96 sigmas are 95 %.
  std::array<double, 81> covariance{};
  double robot_m = 0;  // noise beyond the positions' sigmas, one coordinate
  double scatter_m = 0;
  std::vector<Vec3> residual_m;  // found minus predicted
  std::vector<std::string> unobservable;
  bool base_known = true, light_known = true;
  double sigma(std::size_t parameter) const;
};
// At least four samples.
LightMounting calibrate_light(const std::vector<LightSample>& samples);

// Samples of one light from `light_positions`; Error(data) where there are too few, sigmas are missing or covariances
// are none, or several lights stand there and none is named.
std::vector<LightSample> light_samples(const manifest::Document& document, std::string& light,
                                       const std::string& robot);
void enter_light_mounting(const LightMounting& mounting, const std::string& light, const std::string& robot,
                          manifest::Document& document);
std::string light_page(const LightMounting& mounting, const std::vector<LightSample>& samples,
                       const std::string& light);

}  // namespace gonio::robot
