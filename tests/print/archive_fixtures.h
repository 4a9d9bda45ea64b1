// Jobs and layers for tests of archives.
#pragma once
#include <cstdint>
#include <random>
#include <vector>

#include "print/archive.h"

namespace gonio::tests {

using Layer = std::vector<std::uint8_t>;

// Discs with soft rims, noise in a corner, and a layer without anything.
inline std::vector<Layer> some_layers(int width, int height, std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Layer> layers;
  for (std::size_t k = 0; k < count; ++k) {
    Layer layer(static_cast<std::size_t>(width) * height);
    const double cx = random() % width, cy = random() % height, r = 2 + random() % std::max(1, width / 2);
    for (int y = 0; y < height && k != 1; ++y)
      for (int x = 0; x < width; ++x) {
        const double inside = r - std::hypot(x - cx, y - cy);
        std::uint8_t& grey = layer[static_cast<std::size_t>(y) * width + x];
        grey = static_cast<std::uint8_t>(std::clamp(128 + 60 * inside, 0.0, 255.0));
        if (x < width / 4 && y < height / 4) grey = static_cast<std::uint8_t>(random());
      }
    layers.push_back(layer);
  }
  return layers;
}

inline print::Job full_job(int width, int height) {
  print::Job job{.width_px = width, .height_px = height};
  job.pixel_m = Vec2{50e-6, 47e-6};
  job.layer_m = 25e-6;
  job.mirror_x = true, job.mirror_y = false;
  job.exposure_s = 2.5, job.bottom_exposure_s = 20, job.bottom_layers = 4;
  job.lift_m = 6e-3, job.lift_m_per_s = 1e-3, job.retract_m_per_s = 2.5e-3;
  job.name = "ridges", job.printer = "bench", job.resin = "grey, slow";
  job.resin_kg_per_m3 = 1120, job.resin_m3 = 3.25e-6, job.printing_s = 1234.5;
  for (const int side : {12, 20}) {
    print::JobPreview preview{.width_px = side, .height_px = side / 2};
    for (int i = 0; i < 3 * side * (side / 2); ++i) preview.rgb.push_back(static_cast<std::uint8_t>(i * 7));
    job.previews.push_back(preview);
  }
  return job;
}

inline void write_layers(const print::ArchiveFormat& format, const std::filesystem::path& path, const print::Job& job,
                         const std::vector<Layer>& layers) {
  const auto writer = format.begin(path, job);
  for (std::size_t k = 0; k < layers.size(); ++k)
    writer->add(layers[k], job.layer_m.value_or(1e-4) * k, job.layer_m.value_or(1e-4) * (k + 1));
  writer->finish();
}

}  // namespace gonio::tests
