// Pictures of mirror balls, unwrapped into the surroundings that they show.
//
// Every texel of a latitude-longitude picture is looked up where each ball shows it (mirror_ball.h) through the whole
// camera, its lens included, as a mean over directions spread evenly over the texel; the reflectance of the metal at
// that place is divided out before anything is interpolated. Views are blended by how finely they show a direction:
//   weight = f / ((turn along / radius)^2 (1/12 + sigma^2) + turn across^2 / (12 radius^2)),
// the squared width of a pixel's footprint and of the outline's uncertainty sigma, px, as directions; both grow without
// bounds at grazing incidence. f falls smoothly to zero before `steepest_rad`, at the border of what the camera's own
// reflection hides, so that no seam shows.
// Directions that no view shows are filled from their neighbours or stay black, and the weights say which they are.
// World frame; axes of projection.h.
#pragma once
#include <cstdint>
#include <limits>
#include <vector>

#include "camera/camera_model.h"
#include "geom/rigid.h"
#include "io/image.h"
#include "probe/metals.h"
#include "probe/mirror_ball.h"

namespace gonio::probe {

// Error(data) where the camera is not outside.
MirrorBall mirror_before(const camera::CameraModel& camera, const Rigid<frame::World, frame::Camera>& world_from_camera,
                         const Ball& ball);

struct BallView {                       // one ball in one picture
  io::Image picture;                    // linear, R, G, B or Y
  io::Image variance{};                 // of the same channels; empty: not known
  std::vector<std::uint8_t> counts{};   // one entry per pixel: may be used; empty: all
  std::vector<std::uint8_t> clipped{};  // one entry per pixel: was brighter than it says; empty: none
  camera::CameraModel camera;           // orthographic: a picture without perspective
  Rigid<frame::World, frame::Camera> world_from_camera{};
  Ball ball{};                   // world
  std::size_t number = 0;        // of the ball: views that share it share the error of its place
  std::vector<Ball> others{};    // balls that stood beside it: what it shows of them is no surroundings
  std::vector<Ball> variants{};  // the ball moved by one standard deviation in each of its independent directions
  double radius_px = 0;          // of the outline
  double sigma_px = 0;           // of the outline's place
  MirrorBall mirror() const { return mirror(ball); }
  MirrorBall mirror(const Ball& there) const;
};

struct UnwrapWish {
  int columns = 1024;
  double distance_m = std::numeric_limits<double>::infinity();  // of the surroundings, from the ball's centre
  double steepest_rad = 84 * pi / 180;                          // largest angle of incidence that is used
  double camera_radius_m = 0.05;                                // of what the camera hides, seen from the ball
  bool fill = true;                                             // else black
  Metal metal{};
};

struct Unwrapped {
  io::Image radiance;   // lat-long, R, G, B
  io::Image weight;     // Y: share of the texel that some view shows, 0 to 1; footprint: width of the best pixel, rad
  double blind_sr = 0;  // solid angle that no view shows
};

// Reflected radiance over reflectance at each pixel of the ball, the rest zero; R, G, B. `used`: pixels within the
// outline by a pixel and a half, that count, whose incidence is below the steepest, and that show no other ball.
struct Facing {
  io::Image radiance;
  std::vector<std::uint8_t> used;
};
Facing facing(const BallView& view, const UnwrapWish& wish);

// `faces` in the order of the views: facing(), perhaps with lights taken out (bright_lights.h).
Unwrapped unwrapped(const std::vector<BallView>& views, const std::vector<Facing>& faces, const UnwrapWish& wish);

}  // namespace gonio::probe
