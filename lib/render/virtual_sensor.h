// A virtual sensor: the noise that a linear sensor adds to a rendering, so that it can stand for a recording.
#pragma once
#include <cstdint>
#include <string>

#include "io/image.h"
#include "manifest/document.h"

namespace gonio::render {

// Channels R, G, B of `rendered` with photon noise (Poisson: a value v is v * gain electrons) and Gaussian read noise:
// variance v / gain + read^2, as the manifest states it (Janesick 2007, equation 2.14). Negative readings stay. The
// rendering's own Monte Carlo noise remains in it: render with enough samples that it is small beside the sensor's.
io::Image recorded(const io::Image& rendered, const manifest::Noise& noise, std::uint64_t seed);

// What someone who only has the recordings would write: free parameters with two bounds are set to their middle.
void forget_free_values(manifest::Document& document);

}  // namespace gonio::render
