// From a scene's radiance to the reading in one picture of a stack of exposures, in the order of
// render/sensor_chain.h, with the equations of the mechanisms:
//   u = radiance times the time that the shutter was open (in this picture longer by a share of its own), gain, the
//   drifting lamp, and what the aperture and the rim of the lens let pass
//   v = full scale of (stated response of (response of (u under a veil, channel by channel)) + offset)
// The stated response is that of Stack::stated, or none. Radiance is in readings per second: what a linear sensor would
// read after one second.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "explain/stacks/stack_input.h"
#include "light/mechanisms/light_drift.h"
#include "render/mechanisms/optics_veiling_glare.h"
#include "render/mechanisms/sensor_black_offset.h"
#include "render/mechanisms/sensor_saturation.h"
#include "render/mechanisms/sensor_shutter.h"
#include "render/tone_curve.h"
#include "scene/mechanisms/optics_lens_shading.h"

namespace gonio::explain::stacks {

struct Taken {                                                         // how a picture was taken
  double exposure_s = 1, gain = 1, since_s = 0;                        // since the first picture of the stack
  std::size_t image = unseen;                                          // its place in the stack
  double f_number = 0, radius = 0;                                     // 0: not said; of a place in it, in half widths
  static constexpr std::size_t unseen = static_cast<std::size_t>(-1);  // of a picture that was not taken
  // At a pixel of it.
  Taken at(const Stack& stack, int x, int y) const {
    Taken there = *this;
    const double half = 0.5 * stack.width();
    there.radius = std::hypot(x - half + 0.5, y - 0.5 * stack.height() + 0.5) / half;
    return there;
  }
};

struct ReadingChain {
  const Stack* stack = nullptr;
  std::array<render::Response, 3> response;
  std::array<double, 3> mean_radiance{};
  std::vector<double> odd;     // by image: by how much its exposure is longer than stated; empty: none is
  std::vector<double> passes;  // by image: of what its f-number says, at the centre; empty: all
  double rim_shift = 0, rim_f_number = 1;
  double extra_s = 0, drift = 0, drift_s = 600, glare_share = 0, offset = 0, full_scale = 0;

  double operator()(double radiance, int channel, const Taken& at) const {
    const double time = effective_s(at), mean = mean_radiance[static_cast<std::size_t>(channel)];
    return reading(equation::optics_veiling_glare(radiance * time, glare_share, mean * time), channel);
  }
  // Of the light that arrived while the shutter was open.
  double reading(double light, int channel) const {
    const double bent = stack->reading(channel, response[static_cast<std::size_t>(channel)](light));
    return equation::sensor_saturation(equation::sensor_black_offset(bent, offset), full_scale);
  }
  // The light that gives this reading, were there no saturation.
  double light(double reading, int channel) const {
    return response[static_cast<std::size_t>(channel)].light(stack->linear(channel, std::max(0.0, reading - offset)));
  }
  // The radiance that does.
  double radiance(double reading, int channel, const Taken& at) const {
    return light(reading, channel) / effective_s(at) - glare_share * mean_radiance[static_cast<std::size_t>(channel)];
  }

 private:
  double effective_s(const Taken& at) const {
    const double open_s = equation::sensor_shutter(at.exposure_s, extra_s, at.exposure_s);
    const double longer = at.image < odd.size() ? odd[at.image] : 0;
    return open_s * (1 + longer) * at.gain * equation::light_drift(drift, drift_s, at.since_s) * passed(at);
  }
  double passed(const Taken& at) const {
    const double centre = at.image < passes.size() ? passes[at.image] : 1;
    if (!(rim_shift > 0) || !(at.f_number > 0)) return centre;
    return centre * equation::optics_lens_shading(rim_f_number, rim_shift, at.f_number, at.radius);
  }
};

}  // namespace gonio::explain::stacks
