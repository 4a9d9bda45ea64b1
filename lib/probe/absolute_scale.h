// What the values of the surroundings are worth in another photograph: of a white tile, or of the ball itself.
//
// A tile of the reflectance rho, Lambertian, with the normal n, sends the radiance L = rho E / pi. E is what the
// surroundings throw onto it, pixels of the solid angle dw and the radiance L_e in the directions d before it, and the
// lamps that were taken out of them, with the irradiance E_j on a plane that faces them:
//   E = sum L_e max(0, n . d) dw + sum E_j max(0, n . d_j),        scale = pi L / (rho E), channels added.
// Nothing stands between, and the tile is where the ball was. The standard error has the tile's pixels in blocks, its
// reflectance, the lamps', all light on the tile that no photograph of the ball showed, and 1 % for unwrapping. The
// ball's own reflectance is none of it: the scale mends what is wrong with that. Without a tile the same ball is
// unwrapped in the reference, and the scale is the ratio of both over the texels that both show, its error the scatter
// of twelve parts of the sphere.
#pragma once
#include <string>
#include <vector>

#include "camera/camera_model.h"
#include "geom/rigid.h"
#include "goniometry/sample/patch.h"
#include "io/image.h"
#include "probe/unwrap.h"

namespace gonio::probe {

struct Lamp {                 // taken out of the surroundings
  Vec3 towards{};             // unit, from the tile
  Rgb irradiance{}, sigma{};  // on a plane that faces it
};
struct Arriving {
  Rgb irradiance{};
  double unseen = 0;  // share of it, channels added, that no photograph of the ball showed
  double sigma = 0;   // relative, channels added: of the lamps and of what is unseen
};
// `unit`: the normal. World frame.
Arriving arriving_at(const Unwrapped& map, const std::vector<Lamp>& lamps, Vec3 unit);

struct Tile {
  goniometry::Patch patch;
  Rigid<frame::World, frame::Object> world_from_tile;  // +z its normal
  Rgb reflectance{};
  double relative_sigma = 0;
  std::string name;
};
struct ReferenceView {
  io::Image picture;  // linear, R, G, B or Y
  std::vector<std::uint8_t> counts{}, clipped{};
  camera::CameraModel camera;
  Rigid<frame::World, frame::Camera> world_from_camera{};
  std::string place;  // for messages
};
struct Scale {
  double value = 1, sigma = 0;
};
// Error(data) at the view's place where the tile is outside of the picture, masked, saturated, or unlit.
Scale scale_by_tile(const Unwrapped& map, const std::vector<Lamp>& lamps, const Tile& tile, const ReferenceView& view);
// `map`: lamps in it. `reference`: the same ball in the reference alone, unwrapped alike without filling.
Scale scale_by_ball(const Unwrapped& map, const Unwrapped& reference, const std::string& place);

}  // namespace gonio::probe
