// Readings of one patch of a matte or glossy surface under a distant lamp, without geometry: the patch is its normal
// times its albedo, b = albedo n, and the tint of each channel, a factor on the albedo; all light comes from the lamp
// directly. Gloss has the lamp's own colour, whatever the tint.
//   u = w [ rest (tint |b| shape(wo, wi) passes + pi F D G2 / (4 cos_i cos_o)) + pi others ] cos_i + pi L_a w tint |b|
//   v = response(u) falloff + offset,  cos_i = max(0, n.l)
//   others = metal tint |b| D_m G2_m / (4 cos_i cos_o) + sheen velvet + sheen_forward forward + retro lobe_back,
//   rest = 1 - metal - sheen - sheen_forward - retro
// w is what a white matte plate reads that faces the lamp: irradiance / pi times gain and exposure. shape is Oren &
// Nayar's (surface/oren_nayar.h), the lobe and `passes` those of an interface over a matte base
// (surface/models/coated_diffuse.cpp), what shares the area those of surface/sheen.h and surface/retro_lobe.h; a
// metal's Fresnel factor is its colour at all angles. Where the scale of the readings is not absolute, f0 and the
// shares of sheen and retro-reflection are over it.
//
// World axes; the camera looks along `eye`, the direction from the scene to it.
#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "geom/vector.h"
#include "render/tone_curve.h"

namespace gonio::explain::stacks {

inline constexpr double evenness = 0.02;  // share of the light that a lamp called distant may vary by over the object

struct PatchLight {  // one picture's lamp, already turned
  Vec3 towards;      // unit
  double white = 1;  // w
};

// The same lamp as `position` sees it, where it stands at 1 / nearness from the origin along `towards` and gives its
// white there (light.inverse-square). Unchanged at nearness 0. Positions are in units of half the picture's width,
// which a stack without geometry has.
PatchLight seen_from(const PatchLight& light, Vec3 position, double nearness);

struct Patch {
  Vec3 b;
  std::array<double, 3> tint{1, 1, 1};  // by channel; their mean is one
};

struct PatchModel {
  double sigma_rad = 0, f0 = 0, alpha = 0.2, ambient = 0;
  double metal = 0, metal_alpha = 0.3, sheen = 0, sheen_width = 0.5, sheen_forward = 0, retro = 0, retro_alpha = 0.3,
         retro_falloff = 0;
  double falloff = 0, offset = 0;
  render::Response response{};
  Vec3 eye{0, 0, -1};
  // `radius`: distance from the picture's centre over half its width.
  double operator()(Vec3 b, double tint, const PatchLight& light, double radius) const;
  // What is neither matte nor a clear gloss, in 1/sr, of a patch of this colour; and what it leaves to those.
  double others(double colour, Vec3 wo, Vec3 wi) const;
  double rest() const { return 1 - metal - sheen - sheen_forward - retro; }
};

// Readings of one pixel: those of lamp k in channel c at [channels * k + c], zero weight where one does not count.
struct PatchReadings {
  std::size_t channels = 1;
  std::vector<PatchLight> lights;
  std::vector<double> y, weight;  // weight: 1 / sigma
  double radius = 0;
};
// The patch by Gauss-Newton with damping from `start`.
Patch fitted_patch(const PatchModel& model, const PatchReadings& readings, const Patch& start);

// The matte patch by linear least squares on the mean over the channels; the lamps that a robust fit calls hidden are
// left out of it: one whose reading stays under half of what the others promise, though the patch faces it. `hidden`
// receives them. Tints are ratios of sums over the others.
Patch matte_patch(const PatchReadings& readings, std::vector<char>& hidden);

}  // namespace gonio::explain::stacks
