// Things before a projector and a camera, their pictures rendered by lib/render with light that goes to and fro between
// them; where each pixel truly looks, by closed forms of its own. Metres; camera axes as in scan_world.h.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "io/image.h"
#include "scan/scan_world.h"

namespace gonio::tests {

struct Board {  // a rectangle: middle, unit directions along its sides, half their lengths; seen from along x cross y
  Vec3 middle_m, x, y;
  double half_x_m = 0, half_y_m = 0;
};

struct RenderedWorld {
  std::vector<Board> boards;
  std::vector<std::pair<Vec3, double>> balls;  // middle, radius
  double albedo = 0.6;
  double scattering_per_m = 0;  // > 0: a translucent solid (directional dipole, index 1.4) in the place of the albedo
  Pinhole projector{480, 360, 700, {0, -0.02, 0}, 0};
  double lens_radius_m = 0, focus_m = 0.7;  // of the projector
  double gamma = 1;
  double distance_m = 0.7, white = 0.6;  // what a facing white pixel reads there, 1: full
  double ambient = 0.03, gain = 8000, read = 0.002;
  int spp = 64, bounces = 8;
  std::uint64_t seed = 1;
};

// A plane, a ball, a step as ScanWorld has them.
RenderedWorld rendered(const ScanWorld& world);
// Two walls that meet in a vertical line at `vertex_m` and open towards the cameras by `opening_rad`, both turned about
// the vertical by `turn_rad`.
RenderedWorld groove(double opening_rad, double turn_rad, Vec3 vertex_m = {0, 0, 0.7}, double wall_m = 0.09);

// Where a ray first meets something.
std::optional<Vec3> first_met(const RenderedWorld& world, Vec3 from, Vec3 direction);
// The projector's pixel that lights what the middle of a camera's pixel sees; nothing in its shadow and beyond it.
std::optional<Vec2> lit_by(const RenderedWorld& world, const Pinhole& camera, int x, int y);

// What a camera sees, frame by frame, noise added. Rendered when it is made, three frames at a time as red, green and
// blue of grey things.
class RenderedFrames {
 public:
  RenderedFrames(const RenderedWorld& world, const Pinhole& camera, const scan::Sequence& sequence);
  scan::CameraFrame operator()(std::size_t frame) const;

 private:
  RenderedWorld world_;
  bool second_ = false;
  std::vector<io::Image> pictures_;
};

scan::Codes decoded(const RenderedFrames& frames, const RenderedWorld& world, const Pinhole& camera,
                    scan::DecodeRequest request);

}  // namespace gonio::tests
