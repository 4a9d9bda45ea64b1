// See viewpoint.h.
#include "robot/handeye/viewpoint.h"

#include <cmath>

#include "base/text.h"

namespace gonio::robot::handeye {

// From the right means that the board turns about its y axis; spin turns what the camera sees.
camera::BoardPose pose_of(const Viewpoint& v, Vec3 middle_m) {
  constexpr double degree = pi / 180;
  const double a = v.azimuth_deg * degree, t = v.tilt_deg * degree;
  const Quaternion tilted = quaternion_of_rotation_vector({-std::sin(a) * t, std::cos(a) * t, 0});
  const Quaternion spun = quaternion_of_rotation_vector({0, 0, -v.spin_deg * degree});
  camera::BoardPose pose{spun * tilted, {}};
  pose.translation_m = Vec3{0, 0, v.distance_m} - pose.rotate(middle_m);
  return pose;
}

std::string in_words(const Viewpoint& v, const std::string& mover) {
  const char* side = v.azimuth_deg == 0     ? "its right"
                     : v.azimuth_deg == 90  ? "below"
                     : v.azimuth_deg == 180 ? "its left"
                                            : "above";
  std::string text = v.tilt_deg == 0 ? format("face the board squarely from %.2f m", v.distance_m)
                                     : format("view the board from %s, tilted by %.0f degrees, at %.2f m", side,
                                              v.tilt_deg, v.distance_m);
  if (v.spin_deg != 0) text += ", " + mover + format(" by %.0f degrees about the optical axis", v.spin_deg);
  return text;
}

}  // namespace gonio::robot::handeye
