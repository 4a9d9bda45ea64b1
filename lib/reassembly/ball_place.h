// Where one sphere of known radius stands, by its outlines in one view or in several. World frame, metres.
#pragma once
#include <optional>
#include <span>
#include <string>

#include "reassembly/place.h"

namespace gonio::reassembly {

struct SeenBall {
  const View* view = nullptr;  // its pose and the pose's covariance
  Outline outline;
};
struct BallPlace {
  Vec3 centre_m;
  Mat3 covariance_m2{{}};  // by the outlines' covariances and the poses'
  double chi_square = 0;
  int degrees = 0;
};
// Least squares of all axes and half angles, from the mean of the places that each outline alone says
// (bundle_sight.h). Nothing where they do not meet. Error(data) at `place` as sight_of().
std::optional<BallPlace> place_of_ball(std::span<const SeenBall> seen, double radius_m, const std::string& place);

}  // namespace gonio::reassembly
