// Points of a seen rim, found by place: the nearest one that faces the same way. Private to alignment/.
#pragma once
#include <optional>
#include <vector>

#include "alignment/cell_index.h"
#include "alignment/observed_rim.h"

namespace gonio::alignment {

class SeenPoints {
 public:
  explicit SeenPoints(const std::vector<RimPoint>& points) : points_(points) {
    std::vector<Box> boxes;
    for (const RimPoint& p : points) boxes.push_back({p.pixel, p.pixel});
    cells_ = CellIndex(boxes, 4);
  }
  std::optional<std::size_t> nearest(Vec2 pixel, Vec2 outward, double reach_px) const {
    double best = reach_px * reach_px;
    std::optional<std::size_t> found;
    cells_.outwards(pixel, best, [&](std::uint32_t i) {
      const Vec2 off = pixel - points_[i].pixel;
      if (dot(off, off) < best && dot(points_[i].outward, outward) > 0.5) best = dot(off, off), found = i;
    });
    return found;
  }

 private:
  const std::vector<RimPoint>& points_;
  CellIndex cells_;
};

}  // namespace gonio::alignment
