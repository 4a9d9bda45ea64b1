// What a pixel sees of a polarized screen through a body: refracted where the ray enters and where it leaves, with
// Fresnel's matrices and absorption between, and the screen's reflection in the first surface. Cell coordinates.
//
// The body enters by its function near the two places alone, to second order (SurfacePatch), so that a pixel is a
// closed form of ten numbers: value and slope at either place, the index, the absorption. Slopes by these are central
// differences of the closed form, no ray is marched anew. The screen's light is polarized as light/models/screen.cpp
// says
// (`polarization`), and the frames are those of render/polarized_carrier.h.
//
// Left out: further reflections within the body, what lies beyond the screen's borders, more than two crossings.
#pragma once
#include <array>

#include "glass/refine/screen_picture.h"
#include "glass/refine/spline_field.h"

namespace gonio::glass {

struct SurfacePatch {  // of the body's function round a place of its surface
  Vec3 at{};
  SplineField::Jet jet{};
};
SurfacePatch patch(const SplineField& field, Vec3 at);

struct Glassy {
  double index = 1.5;
  double absorption = 0;  // per cell
};

struct PixelRay {
  Vec3 origin, direction;  // unit
  Vec3 camera_x;           // of the picture, for the Stokes vector's frame
  bool hidden = false;     // something stands between the body and the screen: nothing comes through
};

// s0, s1, s2; valid: false where the ray is totally reflected or misses a patch.
struct SeenThrough {
  bool valid = false, meets_screen_plane = false;
  std::array<double, 3> stokes{};
  double variance = 0;  // of s0, by the picture's variation within the blur
  Vec2 place_px{};      // on the screen
};
SeenThrough seen_through(const PixelRay& ray, const SurfacePatch& first, const SurfacePatch& second,
                         const Glassy& glass, const ScreenPicture& screen, const light::Emitter& emitter,
                         double blur_px);

// d stokes / d (value, slope x, y, z of the first patch; of the second; index; absorption).
inline constexpr std::size_t path_numbers = 10;
using PathSlopes = std::array<std::array<double, path_numbers>, 3>;
PathSlopes slopes_of(const PixelRay& ray, const SurfacePatch& first, const SurfacePatch& second, const Glassy& glass,
                     const ScreenPicture& screen, const light::Emitter& emitter, double blur_px);

// Where the line meets the patch's surface near patch.at, and the outward normal there; false where it does not.
bool meet(const SurfacePatch& patch, Vec3 origin, Vec3 direction, Vec3& place, Vec3& outward);
// d outward / d (value, slope x, y, z) for a straight line.
std::array<std::array<double, 4>, 3> normal_slopes(const SurfacePatch& patch, Vec3 origin, Vec3 direction);

}  // namespace gonio::glass
