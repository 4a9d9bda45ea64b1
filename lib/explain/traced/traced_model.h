// Pictures as functions of all numbers of the search: what the tracer said at the nodes, interpolated and put together.
//
// In a row (a pixel, a colour):
//   f = brightness [ L0 + sum of (R(x) - R(stated)) + A(alpha here) - A(alpha stated) ] product of Q(x) / Q(stated)
// L0: the scene as it was given; R: what adds; A: roughness, by that of the place that is seen first (elsewhere by its
// mean over the surface); Q: what multiplies. Between nodes: cubic with the slopes of parabolas, of Q's logarithm.
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "explain/traced/knobs.h"
#include "explain/traced/sampled.h"
#include "manifest/sections/forward.h"

namespace gonio::explain::traced {

class TracedModel {
 public:
  // Traces the scene as it was given and at all nodes. `pixels`, `paths`: in all pictures together; the nodes take a
  // tenth of `paths` each, those of roughness a quarter.
  TracedModel(const manifest::Document& document, const std::vector<std::filesystem::path>& repeats, std::size_t pixels,
              double paths);
  ~TracedModel();

  // Of the rows of group `group`; `values`: one per knob.
  void predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const;
  // The scene that these values amount to, with the questions `named` answered; `all`: with what is known to a sigma,
  // too, which stays as it was given else.
  manifest::Document scene_with(std::span<const double> values, std::span<const double> sigmas,
                                std::span<const std::size_t> named, bool all) const;
  void write(std::span<const double> values, std::span<const double> sigmas, std::span<const std::size_t> named,
             bool all, manifest::Document& document) const;
  // Radiance of all rows and its variance, traced.
  struct Traced {
    std::vector<double> radiance, variance;
  };
  Traced trace(const manifest::Document& document, double paths) const;
  double paths() const { return paths_; }

  const Sampled& sampled() const { return sampled_; }
  const relighting::Recordings& recordings() const { return recordings_; }
  const Knobs& knobs() const { return knobs_; }
  const Traced& stated() const { return stated_; }
  // What roughness changes in a row, per unit of alpha.
  double slope_of_roughness(std::size_t surface, std::size_t row) const;
  void begin_layers(std::size_t surface, double layer_m, double offset_m);

 private:
  double mean_roughness(const Roughness& roughness, std::size_t surface) const;
  void write_roughness(std::span<const double> values, std::span<const double> sigmas, std::size_t surface,
                       manifest::Document& document) const;
  Roughness roughness_of(std::span<const double> values, std::size_t surface) const;

  std::unique_ptr<manifest::Document> document_;
  double paths_;
  relighting::Recordings recordings_;
  Sampled sampled_;
  Knobs knobs_;
  Traced stated_;
  double floor_ = 0;                              // radiance below which quotients say nothing
  std::vector<std::vector<std::size_t>> places_;  // of a surface: pixels that stand for all of it
};

}  // namespace gonio::explain::traced
