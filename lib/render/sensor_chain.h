// From a rendered picture to what a camera records: a chain of mechanisms, each of which vanishes exactly at its
// neutral value. Values are linear and in the rendering's unit throughout, black offset and full scale too. The steps,
// in this order (render/link.h); which mechanism acts at which step its file in render/links says:
//   optics      pictures before the filters: lateral colour, shutter, ghost, bloom, veiling glare,
//               crosstalk
//               the camera's mosaic: one channel Y behind colour filters; "polarizers": behind these (render/mosaic.h)
//   charge      what flows over
//   light       sensitivity of pixels, hot ones
//               photon noise, Poisson: v is v * gain electrons (Janesick 2007, equation 2.14)
//   signal      response, rows
//   dark        read noise, normal; black offset. Added to the signal
//   reading     full scale
//   resampling  a picture made of native pixels; not behind a mosaic, whose neighbours are of other colours
// Negative readings stay. The rendering's own Monte Carlo noise remains: render with enough samples that it is small
// beside the sensor's. Every image id has noise of its own under one seed.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/image.h"
#include "manifest/noise.h"
#include "manifest/sections/forward.h"
#include "mechanism/mechanism.h"
#include "render/link.h"

namespace gonio::render {

struct Sensor {  // as it stands: ideal, three channels, without noise
  std::string camera;
  std::string mosaic;
  manifest::Noise noise;
  double exposure_s = 0;                    // 0: not stated
  std::optional<camera::CameraModel> lens;  // nothing: no link that asks for it acts
  struct Active {
    const Link* link = nullptr;
    std::vector<double> amounts;  // one per parameter of the mechanism
  };
  std::vector<Active> links;  // in the order of the chain
  // Puts the mechanism's link in its place; Error(internal) where it has none.
  void switch_on(const mechanism::Mechanism& mechanism, std::vector<double> amounts);
  // Of a parameter by its name; neutral where the mechanism is not switched on.
  double amount(const mechanism::Mechanism& mechanism, const std::string& parameter) const;
};

// Is it a link of the chain, so that sensor_of() understands it?
bool in_sensor_chain(const mechanism::Mechanism& mechanism);

// The sensor of images[image]: its noise, its camera's mosaic, and the mechanisms that the document switches on for
// that camera. Error(data) at the place in the manifest.
Sensor sensor_of(const manifest::Document& document, std::size_t image);

// Channels R, G, B (or Y behind a mosaic). `rendered` has R, G, B; for "polarizers" s1.R ... s2.B as well.
io::Image recorded(const io::Image& rendered, const Sensor& sensor, const std::string& image_id, std::uint64_t seed);

}  // namespace gonio::render
