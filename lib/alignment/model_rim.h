// The rim of a body, or of its shadow, in a photograph, as the setting has it: exact visibility, no raster.
//
// Pixels of the straightened picture (setting.h). Where the body's mesh or the ground lies behind the camera, or the
// lamp below a part of the body, there is no rim.
#pragma once
#include <optional>
#include <vector>

#include "alignment/cell_index.h"
#include "alignment/rim.h"
#include "alignment/setting.h"

namespace gonio::alignment {

struct RimSubject {  // whose rim, and where
  std::size_t station = 0, body = 0;
  std::optional<std::size_t> lamp{};  // of the shadow that it throws
  bool operator==(const RimSubject&) const = default;
};

// A place on a rim: where it is in the picture, the unit normal out of the region, and the mesh point that is seen
// there.
struct RimPlace {
  Vec2 pixel, outward;
  Vec3 mesh_point;
  double distance_px = 0;  // from what was asked for, positive where that lies outside
};

class ModelRim {
 public:
  ModelRim(const Setting& setting, const RimSubject& subject);
  // False: there is none. An empty one is there and has no length.
  bool exists() const { return exists_; }
  const std::vector<RimPiece>& pieces() const { return pieces_; }
  double length_px() const { return length_; }
  // The nearest place within `reach_px` whose outward normal makes less than 60 degrees with `outward` (unit).
  std::optional<RimPlace> nearest(Vec2 pixel, Vec2 outward, double reach_px) const;
  // Places about `spacing_px` apart, at least one on each piece that is longer than half of that.
  std::vector<RimPlace> places(double spacing_px) const;

 private:
  RimPlace place_on(const RimPiece& piece, double share) const;
  const Shape* shape_;
  bool exists_ = true;
  std::vector<RimEdge> edges_;
  std::vector<Segment> segments_;
  std::vector<double> weights_;  // of the segments' ends
  std::vector<RimPiece> pieces_;
  double length_ = 0;
  CellIndex cells_;  // of the pieces
};

}  // namespace gonio::alignment
