// See reach.h. On every axis a point is chosen, each the nearest to the one before. Point j lies on axis j and point
// j + 1 on the next: both are fixed in the link between them, so that their distance is the same in every posture, and
// the sum of such distances bounds that of any two. (Frames of Denavit and Hartenberg will not do: a calibration puts
// some of them hundreds of metres away, robot/ur_calibration.h.)
#include "acquisition/motion/reach.h"

#include <algorithm>
#include <cmath>

#include "acquisition/motion/body.h"

namespace gonio::acquisition {

std::vector<double> reaches(const LaboratoryArm& arm) {
  const std::size_t joints = arm.links.size();
  const std::vector<robot::LinkFrame> frames = robot::link_frames(arm.links, Joints(joints));
  std::vector<Vec3> points;
  for (std::size_t j = 0; j < joints; ++j) {
    const Vec3 axis{frames[j].rotation(0, 2), frames[j].rotation(1, 2), frames[j].rotation(2, 2)};
    const Vec3 before = points.empty() ? Vec3{} : points.back();
    points.push_back(frames[j].origin_m + axis * dot(before - frames[j].origin_m, axis));
  }
  // Outermost link first: what lies on link j + 1 and beyond is as far from point j as from point j + 1, and their
  // distance.
  std::vector<double> reach(joints);
  double beyond = 0;
  for (std::size_t j = joints; j-- > 0;) {
    if (j + 1 < joints) beyond += norm(points[j + 1] - points[j]);
    for (const Solid& solid : arm.solids) {
      if (solid.link != static_cast<int>(j) + 1) continue;
      const Body body = body_of(solid, 0);
      const robot::LinkFrame& frame = frames[j + 1];
      const Vec3 middle = frame.rotation * (body.rotation * body.middle_m + body.origin_m) + frame.origin_m;
      beyond = std::max(beyond, norm(middle - points[j]) + body.radius_m);
    }
    reach[j] = beyond;
  }
  return reach;
}

}  // namespace gonio::acquisition
