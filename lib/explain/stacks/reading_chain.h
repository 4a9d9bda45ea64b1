// From a scene's radiance to the reading in one picture of a stack of exposures, in the order of
// render/sensor_chain.h:
//   u = radiance (exposure + extra time) gain          sensor.shutter
//   u *= 1 + amplitude exp(-time / time constant)      light.drift
//   u += glare share * (mean radiance) * the same      optics.veiling-glare
//   v = response(u)                                    sensor.non-linearity, channel by channel
//   v += offset                                        sensor.black-offset
//   v = min(v, full_scale)                             sensor.saturation; 0: no limit
// Radiance is in readings per second: what a linear sensor would read after one second.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "render/tone_curve.h"

namespace gonio::explain::stacks {

struct Taken {                                   // how a picture was taken
  double exposure_s = 1, gain = 1, since_s = 0;  // since the first picture of the stack
};

struct ReadingChain {
  std::array<render::Response, 3> response;
  std::array<double, 3> mean_radiance{};
  double extra_s = 0, drift = 0, drift_s = 600, glare_share = 0, offset = 0, full_scale = 0;

  double operator()(double radiance, int channel, const Taken& at) const {
    const auto c = static_cast<std::size_t>(channel);
    const double time = effective_s(at);
    double u = radiance * time;
    if (glare_share != 0) u += glare_share * mean_radiance[c] * time;
    const double v = response[c](u) + offset;
    return full_scale > 0 ? std::min(v, full_scale) : v;
  }
  // The radiance that gives this reading, were there no saturation.
  double radiance(double reading, int channel, const Taken& at) const {
    const auto c = static_cast<std::size_t>(channel);
    return response[c].light(std::max(0.0, reading - offset)) / effective_s(at) - glare_share * mean_radiance[c];
  }

 private:
  double effective_s(const Taken& at) const {
    const double time = (at.exposure_s + extra_s) * at.gain;
    return drift != 0 ? time * (1 + drift * std::exp(-at.since_s / drift_s)) : time;
  }
};

}  // namespace gonio::explain::stacks
