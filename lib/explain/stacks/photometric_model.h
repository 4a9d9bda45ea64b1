// Readings of one patch of a matte or glossy surface under a distant lamp, without geometry: the patch is its normal
// times its albedo, b = albedo n, and the tint of each channel, a factor on the albedo; all light comes from the lamp
// directly. Gloss has the lamp's own colour, whatever the tint.
//   u = w [ tint |b| shape(wo, wi) passes + pi F D G2 / (4 cos_i cos_o) ] cos_i + pi L_a w tint |b|  cos_i = max(0,
//   n.l) v = response(u) falloff + offset
// w is what a white matte plate reads that faces the lamp: irradiance / pi times gain and exposure. shape is Oren &
// Nayar's (surface/oren_nayar.h), the lobe and `passes` those of an interface over a matte base
// (surface/models/coated_diffuse.cpp). Where the scale of the readings is not absolute, f0 is over it.
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
  double falloff = 0, offset = 0;
  render::Response response{};
  Vec3 eye{0, 0, -1};
  // `radius`: distance from the picture's centre over half its width.
  double operator()(Vec3 b, double tint, const PatchLight& light, double radius) const;
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
