// The light of scripts/experiments/reassembly.mk: a room with five lamps, and what photographs of a chrome ball in it
// tell of it. Maps are latitude-longitude, in the convention of the light `lat-long`.
#pragma once
#include <vector>

#include "camera/camera_model.h"
#include "geom/rigid.h"
#include "io/image.h"

namespace gonio::reassembly_experiment {

io::Image room(int width);  // true radiance over direction

struct BallView {
  const io::Image* picture = nullptr;
  double focal_px = 0;
  Vec2 principal_px;
  Rigid<frame::World, frame::Camera> world_from_camera;
};
struct Unwrap {
  bool perspective = false;  // else orthographic: the ball's outline in the picture is a circle of normals
  bool divided = false;      // by the ball's reflectance
  Vec3 centre_m, eta, k;
  double radius_m = 0;
  int width = 512;
};
// The radiance from every direction, from the view in whose picture it is least squeezed; black where none has it.
io::Image unwrapped(const std::vector<BallView>& views, const Unwrap& wish);

}  // namespace gonio::reassembly_experiment
