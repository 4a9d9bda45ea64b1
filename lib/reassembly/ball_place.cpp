// See ball_place.h.
#include "reassembly/ball_place.h"

#include <cmath>
#include <vector>

#include "linear/geom_matrices.h"
#include "reassembly/bundle_sight.h"

namespace gonio::reassembly {

std::optional<BallPlace> place_of_ball(std::span<const SeenBall> seen, double radius_m, const std::string& place) {
  std::vector<Sight> sights;
  Eigen::Vector3d start = Eigen::Vector3d::Zero();
  for (const SeenBall& s : seen) {
    sights.push_back(sight_of(*s.view, s.outline, place));
    start += sights.back().origin + sights.back().axis * distance_m(s.outline, radius_m);
  }
  std::vector<const Sight*> all;
  for (const Sight& s : sights) all.push_back(&s);
  const auto meeting = meet(all, radius_m, Eigen::Vector3d(start / static_cast<double>(seen.size())));
  if (!meeting) return {};
  return BallPlace{{meeting->centre.x(), meeting->centre.y(), meeting->centre.z()},
                   linear::mat3_of(meeting->covariance),
                   meeting->chi_square,
                   meeting->degrees};
}

}  // namespace gonio::reassembly
