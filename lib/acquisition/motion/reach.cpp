// See reach.h. On every axis a point is chosen, each the nearest to the one before. Point j lies on axis j and point
// j + 1 on the next: both are fixed in the link between them, so that their distance is the same in every posture, and
// the sum of such distances bounds that of any two. (Frames of Denavit and Hartenberg will not do: a calibration puts
// some of them hundreds of metres away, robot/ur_calibration.h.)
#include "acquisition/motion/reach.h"

#include "acquisition/motion/body.h"

namespace gonio::acquisition {

std::vector<std::vector<double>> reaches(const LaboratoryArm& arm) {
  const std::size_t joints = arm.links.size();
  const std::vector<robot::LinkFrame> frames = robot::link_frames(arm.links, Joints(joints));
  std::vector<Vec3> points;
  for (std::size_t j = 0; j < joints; ++j) {
    const Vec3 axis{frames[j].rotation(0, 2), frames[j].rotation(1, 2), frames[j].rotation(2, 2)};
    const Vec3 before = points.empty() ? Vec3{} : points.back();
    points.push_back(frames[j].origin_m + axis * dot(before - frames[j].origin_m, axis));
  }
  std::vector<std::vector<double>> all;
  for (const Solid& solid : arm.solids) {
    std::vector<double>& reach = all.emplace_back(joints);
    const Body body = body_of(solid, 0);
    const robot::LinkFrame& frame = frames[static_cast<std::size_t>(solid.link)];
    const Vec3 middle = frame.rotation * (body.rotation * body.middle_m + body.origin_m) + frame.origin_m;
    double beyond = body.radius_m;
    Vec3 last = middle;
    for (auto j = static_cast<std::size_t>(solid.link); j-- > 0;) {
      beyond += norm(last - points[j]);
      last = points[j];
      reach[j] = beyond;
    }
  }
  return all;
}

}  // namespace gonio::acquisition
