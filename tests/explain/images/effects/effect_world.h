// A ball on a table, a few cameras and lamps: rendered by the path tracer with `truth` switched on, changed by whatever
// a test does to the pictures, recorded with noise, and handed over as what a user believes.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "data.h"
#include "explain/engine.h"
#include "explain/images/images_problem.h"
#include "io/image.h"
#include "manifest/sections/forward.h"

namespace gonio::tests {

struct EffectWorld {
  int size_px = 48, views = 3, lamps = 2, spp = 100;
  double noise = 0.002;
  double full_scale = 0;  // cuts readings off behind their noise; 0: not
  std::uint64_t seed = 7, noise_seed = 7;
  // JSON of the entries; empty: the usual ones.
  std::string ball = R"({"model":"diffuse","albedo":{"value":[0.5,0.4,0.3],"free":true}})";
  std::string table = R"({"model":"diffuse","albedo":{"value":[0.5,0.5,0.5],"free":true}})";
  std::string more_objects{}, more_meshes{}, more_surfaces{};  // ", {...}" and ", \"name\": ..."
  std::vector<std::string> lights{};                           // instead of the white lamps
  bool lights_together = false;                                // all in one picture of a view; else one in each
  bool stokes = false;                                         // rendered with polarization
  std::string truth{}, believed{};                             // of the section `mechanisms`
  // Between rendering and noise: the picture of a view, linear.
  std::function<void(std::size_t image, std::size_t view, io::Image&)> change{};

  std::string manifest(const std::string& mechanisms) const;
  std::vector<io::Image> render() const;  // what the camera would record without noise, R, G, B
  manifest::Document record(const ScratchFolder& folder) const;
};

struct EffectOutcome {
  ScratchFolder folder;
  explain::images::ImagesProblem problem;
  explain::Explanation explanation;
  // `hypotheses` empty: all.
  explicit EffectOutcome(const EffectWorld& world, const std::vector<std::string>& hypotheses = {});
  EffectOutcome(const EffectOutcome&) = delete;
  std::vector<std::string> named() const;
  std::string told() const;                           // the sentence, and what was weighed
  double fitted(const std::string& parameter) const;  // its last word: "aperture_radius_m"
};

}  // namespace gonio::tests
