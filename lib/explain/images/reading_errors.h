// How well pictures are explained by a scene that is meant otherwise (readings.h), at a few hundred pixels of every
// view and without any path between surfaces.
//
// A picture is taken, colour by colour, as a sum with factors that are not negative of, for every surface, the direct
// light that it sends here and its share of the pixel: what a thing reflects, the exposure and light from elsewhere are
// not known beforehand, and most of the physics that may be left out is near enough to it. What stays is mean(d^2) /
// mean(v^2) less the recording's noise, one number for each picture.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "explain/images/model.h"
#include "explain/images/readings.h"
#include "relighting/light_cache.h"
#include "render/ray_caster.h"
#include "scene/scene.h"

namespace gonio::explain::images {

class ReadingErrors {
 public:
  ReadingErrors(const scene::Scene& scene, const ImageModel& model);
  ~ReadingErrors();

  // Under an even grey, and as the model's own cache has the scene.
  std::vector<double> grey() const;
  std::vector<double> as_given() const;
  // Of matt things without shadows: a ray for each pixel, and nothing built anew.
  std::vector<double> unshadowed(const Reading& reading) const;
  // With direct light, cast anew.
  std::vector<double> lit(const Reading& reading) const;

 private:
  struct Casters;
  // What may explain the pixels `kept` of an image, each a value for every one of them.
  using Parts = std::vector<std::vector<Rgb>>;
  using PartsOf = std::function<Parts(std::size_t image, std::span<const std::uint32_t> kept)>;
  std::vector<double> errors(const Reading& reading, const PartsOf& parts_of) const;
  struct Sight;
  std::vector<Sight> looked_at(const View& view, const std::vector<std::array<int, 2>>& pixels,
                               const Reading& reading) const;
  Parts lit_parts(const ViewCache& cache, std::span<const float> sums, std::size_t image,
                  std::span<const std::uint32_t> places) const;

  const scene::Scene& scene_;
  const ImageModel& model_;
  std::vector<std::vector<std::uint32_t>> places_;       // [view]: of the model's cache
  std::vector<std::vector<std::array<int, 2>>> chosen_;  // [view]: where these are
  mutable std::unique_ptr<const Casters> casters_;       // of single meshes; made when first needed
};

}  // namespace gonio::explain::images
