// From readings of a white tile to the scale of every light: s = <L_t> / <f_t E>, goniometry/sample/recording.h.
//
// A picture that shows the tile beside the sample has its own scale: exposure and the lamp's output cancel. Others take
// what the pictures of the tile under the same light say: where all state a time and the picture lies between two of
// them, the straight line between these; else their mean weighted by their variances, its uncertainty widened by their
// scatter where that is more than their own uncertainties explain (Birge 1932): the lamp's output wanders.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "geom/vector.h"

namespace gonio::goniometry {

struct TileReading {
  std::size_t view = 0, light = 0;
  std::optional<double> time_s;
  Rgb scale, sigma;
};

struct TileScale {
  Rgb value{1, 1, 1}, sigma{0, 0, 0};
  std::vector<std::size_t> views;  // of the tile that it rests on
};

class Scales {
 public:
  explicit Scales(std::vector<TileReading> readings) : readings_(std::move(readings)) {}
  // Nothing where no picture shows the tile under this light.
  std::optional<TileScale> at(std::size_t view, std::size_t light, std::optional<double> time_s) const;
  // Of the readings under this light: standard deviation about their mean, relative, and what their uncertainties
  // expect of it; brightest band. Nothing for fewer than two.
  struct Wander {
    double relative = 0, expected = 0;
  };
  std::optional<Wander> wander(std::size_t light) const;

 private:
  std::vector<TileReading> readings_;
};

}  // namespace gonio::goniometry
