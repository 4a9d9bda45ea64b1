// Corners in a projector's pixels and the projector that they calibrate: errors against what is stated, over seeds.
#include "scan/projector_corners.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <map>

#include "scan/board_world.h"

namespace gonio::scan {
namespace {

using tests::BoardSession;
using tests::BoardWorld;

TEST(ProjectorCorners, CalibrateAProjectorWithinItsIntervals) {
  const BoardWorld world;
  const BoardSession session(world, tests::cosines_and_white(world, {1, 8, 40}, 3), 12);
  const char* seeds = std::getenv("GONIO_SEEDS");
  const std::uint64_t count = seeds == nullptr ? 6 : std::strtoull(seeds, nullptr, 10);
  double inside = 0, all = 0;
  std::map<std::string, std::array<double, 3>> by;
  double off2 = 0, stated2 = 0, n2 = 0, rms[2]{}, noise[2]{}, ex = 0;
  for (std::uint64_t seed = 1; seed <= count; ++seed) {
    const auto views = session.views(seed);
    const auto poses = world.poses(12);
    for (std::size_t p = 0; p < poses.size(); ++p)
      for (std::size_t k = 0; k < views[2 * p + 1].corners.size(); ++k) {
        const auto& c = views[2 * p + 1].corners[k];
        const auto seen = std::ranges::find(views[2 * p].corners, c.id, &camera::Corner::id);
        const Vec2 at = world.board().corner_m(c.id);
        const auto m = poses[p]({at.x, at.y, 0});
        const auto tc = world.camera.pixel(m), tp = world.projector.pixel(world.projector_from_camera(m));
        const Vec2 ec = seen->pixel - Vec2{tc[0], tc[1]};
        const auto& s = c.looked_up->at[0].slope;
        const Vec2 own = c.pixel - Vec2{tp[0], tp[1]} - Vec2{s[0] * ec.x + s[1] * ec.y, s[2] * ec.x + s[3] * ec.y};
        off2 += dot(own, own), stated2 += c.looked_up->own[0] + c.looked_up->own[2], n2 += 2;
      }
    const camera::Calibration c = camera::calibrate(views, session.setup());
    if (!c.converged) {
      for (const auto& w : c.complaints) std::printf("%s\n", w.c_str());
      for (std::size_t i = 0; i < views.size(); ++i) std::printf("%s %zu corners weight %.2f rms %.3f %s\n", views[i].name.c_str(), views[i].corners.size(), c.views[i].weight, c.views[i].rms_px, c.views[i].note.c_str());
      for (int k = 0; k < 2; ++k) std::printf("f %.1f %.1f c %.1f %.1f k %.3f %.3f\n", c.cameras[k].lens.fx_px, c.cameras[k].lens.fy_px, c.cameras[k].lens.cx_px, c.cameras[k].lens.cy_px, c.cameras[k].lens.distortion[0], c.cameras[k].lens.distortion[1]);
    }
    ASSERT_TRUE(c.converged);
    const auto hold = [&](const std::string& name, double found, double truth, double sigma) {
      const double z = (found - truth) / sigma;
      ++all, inside += std::abs(z) < 1.96;
      auto& b = by[name];
      ++b[0], b[1] += z, b[2] += z * z;
    };
    const tests::BentLens* lenses[] = {&world.camera, &world.projector};
    for (std::size_t k = 0; k < 2; ++k) {
      const auto& lens = c.cameras[k].lens;
      const std::string own = k == 0 ? "camera " : "projector ";
      hold(own + "fx", lens.fx_px, lenses[k]->fx, *c.sigma("fx_px", k));
      hold(own + "fy", lens.fy_px, lenses[k]->fy, *c.sigma("fy_px", k));
      hold(own + "cx", lens.cx_px, lenses[k]->cx, *c.sigma("cx_px", k));
      hold(own + "cy", lens.cy_px, lenses[k]->cy, *c.sigma("cy_px", k));
      hold(own + "k1", lens.distortion[0], lenses[k]->k1, *c.sigma("k1", k));
      hold(own + "k2", lens.distortion[1], lenses[k]->k2, *c.sigma("k2", k));
      rms[k] += c.cameras[k].rms_px / count, noise[k] += c.cameras[k].noise_px / count;
    }
    ex += c.excess / count;
    const auto back = inverse(c.cameras[1].rig_from_camera);
    const Vec3 turn = rotation_vector_of(back.rotation);
    for (int i = 0; i < 3; ++i) {
      hold(std::string("turn ") + "xyz"[i], turn[i], world.projector_from_camera.turn[i],
           *c.sigma(std::string("rotation_") + "xyz"[i] + "_rad", 1));
      hold(std::string("shift ") + "xyz"[i], back.translation_m[i], world.projector_from_camera.shift[i],
           *c.sigma(std::string("translation_") + "xyz"[i] + "_m", 1));
    }
  }
  for (const auto& [name, b] : by)
    std::printf("%-14s mean z %6.2f rms z %5.2f\n", name.c_str(), b[1] / b[0], std::sqrt(b[2] / b[0]));
  std::printf(
      "inside %.3f of %.0f; corner own error over stated %.3f (%.4f px); rms %.4f %.4f noise %.4f %.4f excess %.2f\n",
      inside / all, all, std::sqrt(off2 / stated2), std::sqrt(off2 / n2), rms[0], rms[1], noise[0], noise[1], ex);
  EXPECT_GT(inside / all, 0.85);
}

}  // namespace
}  // namespace gonio::scan
