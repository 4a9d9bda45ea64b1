// Calibrations drawn again and again: views of a checkerboard from the forward model, with noise of their own.
#pragma once
#include "base/random.h"
#include "camera/calibration.h"
#include "camera/quality/alignment.h"
#include "camera/quality/projection_law.h"
#include "camera/synthetic_board.h"

namespace gonio::camera::tests {

constexpr int width = 1280, height = 960;

inline Board world_board() {
  return {BoardKind::checkerboard, 9, 6, 0.03, 0, "", {}};
}
inline Intrinsics world_lens() {
  Intrinsics lens{1100, 1102, 645, 470, {}};
  lens.distortion[LensTerm::k1] = -0.2;
  lens.distortion[LensTerm::k2] = 0.05;
  lens.distortion[LensTerm::p1] = 0.001;
  lens.distortion[LensTerm::k3] = 0.03;
  return lens;
}

inline std::vector<BoardPose> world_poses(int count, Random& random) {
  std::vector<BoardPose> list;
  for (int i = 0; i < count; ++i) {
    const double azimuth = 2 * pi * (i + random.uniform()) / count, tilt = random.uniform(0.35, 0.65);
    list.push_back(pose_at(world_board(),
                           {tilt * std::cos(azimuth), tilt * std::sin(azimuth), random.uniform(-0.5, 0.5)},
                           random.uniform(0.4, 0.6), {random.uniform(-0.9, 0.9), random.uniform(-0.9, 0.9)}));
  }
  return list;
}

inline std::vector<View> world_views(const std::vector<BoardPose>& poses, double noise_px, Random& random,
                                     const BoardWarp& warp = {}) {
  std::vector<View> views;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    View view;
    view.name = "view" + std::to_string(i);
    for (int id = 0; id < world_board().corners(); ++id) {
      Vec2 pixel;
      if (!predict(world_lens(), poses[i], world_board().extent(), warp, world_board().corner_m(id), pixel)) continue;
      if (pixel.x < 0 || pixel.y < 0 || pixel.x > width - 1 || pixel.y > height - 1) continue;
      view.corners.push_back({id, pixel + Vec2{random.normal(), random.normal()} * noise_px});
    }
    views.push_back(std::move(view));
  }
  return views;
}

// A calibration with the views and the setup that it was made from.
struct Made {
  std::vector<View> views;
  CalibrationSetup setup;
  Calibration calibration;
  CameraResult result() const { return {views, setup, calibration, 0}; }
};
inline Made made_from(std::vector<View> views, bool free_warp = false) {
  Made made{std::move(views), {}, {}};
  for (std::size_t i = 0; i < made.views.size(); ++i) made.views[i].shot = i;
  CameraSetup camera;
  camera.width_px = width, camera.height_px = height;
  BoardSetup board;
  board.board = world_board();
  board.free_warp = free_warp;
  made.setup = {{camera}, {board}};
  made.calibration = calibrate(made.views, made.setup);
  return made;
}

}  // namespace gonio::camera::tests
