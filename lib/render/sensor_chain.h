// From a rendered picture to what a camera records: a chain of mechanisms, each of which vanishes exactly at its
// neutral value. Values v are linear and in the rendering's unit throughout, black offset and full scale too.
//
//   0. sensor.shutter         v *= 1 + extra / exposure, where the image states its exposure
//   1. optics.ghost           v += share * v of the point opposite about the picture's centre
//      optics.veiling-glare   v += share * mean of the picture, channel by channel
//   2. sensor.crosstalk       (R, G, B) mixed: 1 - 2 share of the own band, share of each other
//   3. the camera's mosaic    one channel Y behind colour filters; "polarizers": Y behind polarizers (render/mosaic.h)
//   4. sensor.prnu            v *= 1 + sigma n, n normal and always the same for a pixel of a camera
//   5. photon noise           Poisson: v is v * gain electrons (Janesick 2007, equation 2.14)
//   6. sensor.non-linearity   quadratic, power law, tone curve (render/tone_curve.h)
//   7. sensor.row-pattern     v *= 1 + amplitude sin(2 pi row / period_px + phase_rad)
//   8. sensor.black-offset    v += offset
//   9. read noise             normal
//  10. sensor.saturation      v = min(v, full_scale)
//  11. sensor.clipped-resampling   v = mean of min(v, full_scale) over a box about the pixel; not behind a mosaic,
//                             whose neighbours are of other colours
// The equations of single values stand in render/sensor_links.h. Negative readings stay. The rendering's own Monte
// Carlo noise remains: render with enough samples that it is small beside the sensor's. Every image id has noise of its
// own under one seed.
#pragma once
#include <cstdint>
#include <string>

#include "io/image.h"
#include "manifest/noise.h"
#include "manifest/sections/forward.h"
#include "mechanism/mechanism.h"
#include "render/tone_curve.h"

namespace gonio::render {

struct Sensor {  // as it stands: ideal, three channels, without noise
  std::string camera;
  std::string mosaic;
  manifest::Noise noise;
  double shutter_extra_s = 0, exposure_s = 0;
  double ghost_share = 0, glare_share = 0, crosstalk_share = 0, prnu_sigma = 0;
  Response response;
  double row_amplitude = 0, row_period_px = 100, row_phase_rad = 0;
  double black_offset = 0;
  double full_scale = 0;  // 0: no limit
  double resampled_full_scale = 0, resampling_px = 1;
};

// Is it a link of the chain, so that sensor_of() understands it?
bool in_sensor_chain(const mechanism::Mechanism& mechanism);

// The sensor of images[image]: its noise, its camera's mosaic, and the mechanisms that the document switches on for
// that camera. Error(data) at the place in the manifest.
Sensor sensor_of(const manifest::Document& document, std::size_t image);

// Channels R, G, B (or Y behind a mosaic). `rendered` has R, G, B; for "polarizers" s1.R ... s2.B as well.
io::Image recorded(const io::Image& rendered, const Sensor& sensor, const std::string& image_id, std::uint64_t seed);

}  // namespace gonio::render
