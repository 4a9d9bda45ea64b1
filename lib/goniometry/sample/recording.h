// Goniometer recordings become samples: HDR images of a flat sample, with the poses of cameras and lights, one light on
// at a time. Section "goniometer" of the manifest says where the sample lies and which patch of it counts.
//
// Sample's frame: z its normal, azimuths count from x; metres, W/(m^2 sr) in any scale that is common to the images of
// one light. A pixel's value v is radiance times the image's gain, vignetting and, where the patch says so, exposure_s.
//
//   f = <L> / (s <E>)
// <L>: mean over the patch's area of the radiance (goniometry/sample/patch.h); <E>: mean of what the light's model lets
// arrive at the same places (W/m^2, Lambert's cosine included). The scale s is 1 for a calibrated light, and else what
// a white tile of known reflectance f_t shows: s = <L_t> / <f_t E>, from the tile in the same picture or, where that
// does not show it, from all pictures of the tile under the same light (goniometry/sample/tile.h). f is thus a mean
// over the directions under which the patch is seen and lit: Reading says how far they spread.
//
// Uncertainty of f: the patch's noise, or its scatter where that is more than noise; the tile's; and what is stated of
// the tile's reflectance or the light's intensity, which all rows share (Reduced::scale_sigma). Poses are taken as
// exact. Not seen: what stands before the whole patch, light that other objects throw onto it.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "goniometry/samples.h"
#include "manifest/sections/forward.h"

namespace gonio::goniometry {

struct ReduceOptions {
  std::string sample;                      // name in "goniometer"; empty: the only one there that is no tile
  double max_theta_rad = 85 * (pi / 180);  // beyond, of light or camera: grazing
  double full_scale = 0;                   // values from here on are saturated; 0: what sensor.saturation states
  std::size_t min_pixels = 16;             // wholly within the patch
};

struct Reading {                              // what is known of a row of the samples
  std::size_t image = 0;                      // of the document
  std::string light, tile_image;              // id of the picture of the tile; empty: several, or a calibrated light
  double spread_i_rad = 0, spread_o_rad = 0;  // root mean square over the patch, about the row's directions
  std::size_t pixels = 0;
  double scatter = 1;  // of the patch's parts about a smooth course, over what noise explains; NaN: noise not stated
};

struct Reduced {
  Samples samples;  // series: the lights; place: "images/12"
  std::vector<Dropped> dropped;
  std::vector<Reading> readings;    // one per row
  std::vector<double> scale_sigma;  // per band, relative, common to all rows and contained in samples.sigma
  std::vector<std::string> notes;   // sentences for the reader of the result
};

// Error(data | no_input) at the place in the manifest where nothing can be reduced, or what is stated is impossible.
Reduced reduce(const manifest::Document& document, const ReduceOptions& options = {});

}  // namespace gonio::goniometry
