// A virtual sensor: the noise that a linear sensor adds to a rendering, so that it can stand for a recording.
#pragma once
#include <cstdint>
#include <string>

#include "io/image.h"
#include "manifest/sections.h"

namespace gonio::render {

// Channels R, G, B of `rendered` with photon noise (Poisson: a value v is v * gain electrons) and Gaussian read noise:
// variance v / gain + read^2, as the manifest states it (Janesick 2007, equation 2.14). Negative readings stay. The
// rendering's own Monte Carlo noise remains in it: render with enough samples that it is small beside the sensor's.
// Every image id has noise of its own under one seed.
io::Image recorded(const io::Image& rendered, const manifest::Noise& noise, const std::string& image_id,
                   std::uint64_t seed);

}  // namespace gonio::render
