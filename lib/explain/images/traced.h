// The sampled pixels as the path tracer of lib/render sees them: what the fast model of lib/relighting is held against
// where a number is reported. Radiance of three channels a pixel, times gain and vignetting, before the sensor chain.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "manifest/sections/forward.h"

namespace gonio::explain::images {

struct TracedPixels {
  std::size_t entry = 0;                       // of the image, in document.images
  std::vector<std::array<int, 2>> at{};        // (x, y)
  std::vector<double> radiance{}, variance{};  // variance: of the mean, from the scatter of its passes
  std::vector<double> stokes{};                // s1, s2, s3 of R, G, B, nine a pixel; where they are asked for
};

// Light that only paths from a scene's lamps find (caustics of small lamps): left out of the whole answer, or traced.
enum class Caustics { refused, traced };
enum class Light { plain, polarized };  // polarized: it is carried with its polarization, and `stokes` is filled, too

// Fills `radiance` and `variance` (and `stokes`) of all pictures. `paths`: for all pixels together, some millions a
// second; the same seed draws the same numbers whatever the scene's values are, so that differences between two states
// are smooth. False, and nothing is filled: the scene has caustics that are refused.
bool trace_pixels(const manifest::Document& document, std::vector<TracedPixels>& pictures, double paths,
                  std::uint64_t seed, Caustics caustics = Caustics::refused, Light light = Light::plain);

}  // namespace gonio::explain::images
