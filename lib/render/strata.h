// Stratified samples of the unit square: one set has side^2 cells, and every dimension visits each cell once, in an
// order of its own. Latin pairing of stratified sets; Mitchell 1996, "Consequences of stratified sampling in graphics".
#pragma once
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/random.h"
#include "geom/vector.h"

namespace gonio::render {

class Strata {
 public:
  Strata(int side, std::size_t dimensions)
      : side_(side),
        cells_(static_cast<std::size_t>(side) * static_cast<std::size_t>(side)),
        order_(cells_ * dimensions) {}

  // New orders for all dimensions.
  void shuffle(Random& random) {
    for (std::size_t first = 0; first < order_.size(); first += cells_) {
      for (std::size_t i = 0; i < cells_; ++i) order_[first + i] = static_cast<std::uint8_t>(i);
      for (std::size_t i = cells_; i > 1; --i)
        std::swap(order_[first + i - 1], order_[first + random.below(static_cast<std::uint32_t>(i))]);
    }
  }
  // A point in the cell that `dimension` visits at number `sample`.
  Vec2 draw(std::size_t dimension, std::size_t sample, Random& random) const {
    const int cell = order_[dimension * cells_ + sample];
    return {(cell % side_ + random.uniform()) / side_, (cell / side_ + random.uniform()) / side_};
  }
  std::size_t cells() const { return cells_; }

 private:
  int side_;
  std::size_t cells_;
  std::vector<std::uint8_t> order_;  // cells < 256: side <= 16
};

}  // namespace gonio::render
