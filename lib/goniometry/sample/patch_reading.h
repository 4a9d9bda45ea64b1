// What one picture says of one flat patch: the mean radiance over it, over what the light's model lets leave it.
//
// With a_p the area of pixel p on the patch, L_p its radiance and T_p what a surface of known reflectance would send to
// it, per band (of a sample the irradiance: a reflectance of 1/sr everywhere),
//   ratio = sum a_p L_p / sum a_p T_p.
// Its variance is that of the noise, sum a_p^2 var_p / (sum a_p T_p)^2, or where the patch scatters by more than that,
// the scatter's. Scatter: cells of the patch (8 x 8, fewer where there are few pixels), their ratios about a
// least-squares polynomial of second order in the place; it changes places with the noise where it is larger than
// noise would be in 1 of 1000 pictures. So a lobe that turns bright across the patch is no scatter, and a texture that
// is finer than a cell is.
//
// Something before the patch: the same polynomial through the half of the cells that agree best (least median of
// squares, Rousseeuw 1984). Cells are counted that leave it by more than six robust standard deviations and by more
// than a twentieth, in their means as in the medians of their pixels: glints move the means alone, ridges that the
// pixels beat with the medians alone. A thing that hides half of the patch or more is not seen so.
#pragma once
#include <array>
#include <optional>
#include <string>

#include "goniometry/sample/patch.h"
#include "light/light.h"
#include "manifest/noise.h"
#include "photograph/linear_picture.h"
#include "photograph/mask.h"
#include "surface/surface.h"

namespace gonio::goniometry {

struct Reflector {  // a surface of known reflectance: f(wo, wi), 1/sr, in the patch's frame, both above the horizon
  surface::Layer outer, base;
  Rgb scale{1, 1, 1};                  // factor on it
  double falls_in = 0, falls_out = 0;  // reference.tile: f is divided by 1 + in (1 - cos)^2 + out (1 - cos)^2
  Rgb operator()(Vec3 wo, Vec3 wi) const;
};

struct PictureView {  // of a patch
  const photograph::LinearPicture* picture = nullptr;
  const photograph::Mask* mask = nullptr;  // null: all pixels count
  std::optional<manifest::Noise> noise;
  Rgb gain{1, 1, 1};                 // of the values over radiance
  double falloff = 0;                // optics.vignetting
  double black = 0, full_scale = 0;  // of the values; full scale 0: none
  const camera::CameraModel* camera = nullptr;
  Rigid<frame::World, frame::Camera> world_from_camera;
  Rigid<frame::World, frame::Object> world_from_patch;
  const light::Emitter* light = nullptr;
};

struct PatchReading {
  std::string refusal;  // empty: the numbers below hold
  std::size_t pixels = 0;
  Vec3 wi, wo;                                // unit, mean over the patch by what arrives and by area; patch's frame
  double spread_i_rad = 0, spread_o_rad = 0;  // root mean square about them
  Rgb ratio, sigma;                           // of a picture with one channel: three times the same
  double scatter = 1;  // standard deviation of the cells over that by noise, mean band; NaN: noise not known
  int cells = 0, outlying = 0;
  double farthest = 0;  // of the outlying cells, relative deviation
};

struct PatchLimits {
  double max_theta_rad = 85 * (pi / 180);
  std::size_t min_pixels = 16;
};

// `reflector`: null for a sample.
PatchReading read_patch(const Patch& patch, const PictureView& view, const Reflector* reflector,
                        const PatchLimits& limits);

}  // namespace gonio::goniometry
