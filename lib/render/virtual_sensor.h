// A virtual sensor that adds noise and nothing else; render/sensor_chain.h has the whole camera.
#pragma once
#include "render/sensor_chain.h"

namespace gonio::render {

// Channels R, G, B of `rendered` with photon and read noise: variance v / gain + read^2, as the manifest states it.
inline io::Image recorded(const io::Image& rendered, const manifest::Noise& noise, const std::string& image_id,
                          std::uint64_t seed) {
  Sensor sensor;
  sensor.noise = noise;
  return recorded(rendered, sensor, image_id, seed);
}

}  // namespace gonio::render
