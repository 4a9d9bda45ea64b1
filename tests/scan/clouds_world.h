// A camera and a projector about planes and balls, by rays in closed form that share nothing with the library but the
// sequence's pictures, the decoder and the file: what a user would hand to explain, with physics that the rig left out.
// Grooves are rendered.
#pragma once
#include <cstdint>
#include <filesystem>

#include "manifest/document.h"
#include "scan/scan_world.h"

namespace gonio::tests {

struct CloudsWorld {
  enum class Shape { planes, balls, grooves } shape = Shape::planes;
  std::size_t clouds = 6;
  double gamma = 1;             // of the projector
  bool gamma_known = false;     // the manifest states it
  double moves_m = 0;           // of each thing, from the first frame to the last, away from the rig; signs alternate
  double nudged_m = 0;          // of the projector, along its x, since the rig was calibrated
  double turned_rad = 0;        // about its y
  double k1 = 0;                // of the projector's lens
  double turns_rad_per_s = 0;   // rig.drift, of the projector about its y
  double depth_m = 0;           // light comes back from exponential depths of this mean, index 1.5
  double scatter_m = 0;         // light comes back as from sources so deep that diffuse, fading over 5 mm of way
  double rendered = 0;          // > 0: by lib/render (rendered_world.h), so many samples a pixel
  double scattering_per_m = 0;  // rendered: of a translucent solid (see there)
  double print_m = 0;           // side of the squares that are printed on planes, a fifth as bright as the ground
  double spot_px = 0;           // Gaussian standard deviation of the projector's spots, along the lines
  double blur_px = 0;           // Gaussian standard deviation of the camera's picture
  double albedo = 0.6;          // rendered
  bool overlaps = false;        // all clouds are of one thing, whose shape is not told; images say where the camera was
  double apart_m = 0;           // overlaps: the second cloud is told to be so far from the first, and so on
  bool gray = false;            // else cosines of 1, 8 and 40 periods at three shifts
  double read = 0.002, gain = 8000;
  std::uint64_t seed = 1;
};

// Clouds c0, c1, ... in `folder`, measured by `camera` and `projector` of the rig as it was calibrated.
manifest::Document measured_clouds(const CloudsWorld& world, const std::filesystem::path& folder);

}  // namespace gonio::tests
