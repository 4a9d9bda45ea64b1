// How often 95 % intervals of the projection and of the focal length hold the truth, over calibrations of fresh views
// and noise.
#pragma once
#include <vector>

#include "base/parallel.h"
#include "camera/camera_model.h"
#include "camera/quality/halves.h"
#include "camera/quality/projection_law.h"
#include "camera/quality/quality_world.h"

namespace gonio::camera::tests {

struct Covered {
  int runs = 0, ellipse = 0, circle = 0, points = 0;  // points of the world, 24 a run
  int focal = 0, focals = 0;                          // fx and fy
  int apart = 0, halved = 0;                          // halves called apart at 5 %, of those that could be judged
};

// One calibration: where the projection of world points goes when its frame is brought onto the true one, against what
// the law says.
inline Covered covered_by(std::uint64_t seed, bool with_halves) {
  Random random(seed, 3);
  const std::vector<BoardPose> poses = world_poses(12, random);
  const Made made = made_from(world_views(poses, 0.15, random));
  const Calibration& c = made.calibration;
  const Intrinsics& lens = c.cameras[0].lens;
  Covered result;
  result.runs = 1;
  std::vector<Vec3> truth, found;
  for (std::size_t i = 0; i < made.views.size(); ++i) {
    if (!(c.views[i].weight > 0)) continue;
    append_points(made.views[i], world_board(), {}, poses[i], truth);
    append_points(made.views[i], world_board(), {}, c.views[i].camera_from_board, found);
  }
  const auto motion = aligned(truth, found);
  const ProjectionLaw law(made.result());
  const CameraModel camera(world_lens(), width, height);
  for (const double distance : {0.5, 1.0})
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 4; ++i) {
        const Vec2 pixel{(i + 0.5) * width / 4, (j + 0.5) * height / 3};
        const Vec3 point = camera.ray(pixel).direction * distance;
        const Vec2 d = project(lens, motion * point).value_or(Vec2{1e9, 1e9}) - pixel;
        const PixelCovariance v = law.at(motion * point).value();
        const double determinant = v.uu * v.vv - v.uv * v.uv;
        result.ellipse += (v.vv * d.x * d.x - 2 * v.uv * d.x * d.y + v.uu * d.y * d.y) / determinant < 5.991;
        result.circle += norm(d) < radius_95(v);
        ++result.points;
      }
  result.focal += std::abs(lens.fx_px - world_lens().fx_px) < 1.96 * c.sigma("fx_px").value();
  result.focal += std::abs(lens.fy_px - world_lens().fy_px) < 1.96 * c.sigma("fy_px").value();
  result.focals = 2;
  if (!with_halves) return result;
  const Halves halves = compare_halves(made.result(), {0.5, 1.0}, 0.05);
  result.halved = halves.refused.empty();
  result.apart = result.halved && !halves.agree;
  return result;
}

inline Covered covered(int runs, bool with_halves) {
  std::vector<Covered> all(static_cast<std::size_t>(runs));
  parallel_for(0, all.size(), [&](std::size_t run) { all[run] = covered_by(run, with_halves); });
  Covered sum;
  for (const Covered& c : all) {
    sum.runs += c.runs, sum.ellipse += c.ellipse, sum.circle += c.circle, sum.points += c.points;
    sum.focal += c.focal, sum.focals += c.focals, sum.apart += c.apart, sum.halved += c.halved;
  }
  return sum;
}

}  // namespace gonio::camera::tests
