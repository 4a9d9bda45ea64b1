// Follows patches of a film. Pyramidal Lucas-Kanade (Bouguet 2000) finds where a patch went since the last picture;
// then an affine warp of the patch as it was when it was first seen says where exactly (Shi & Tomasi 1994), so that
// errors do not add up from picture to picture. The warp W(x) = A x + t and the light (gain g, offset b) solve
//   sum_x (I(W(x)) - g T(x) - b)^2 = min
// by the inverse compositional method (Baker & Matthews 2004; with light: Bartoli 2008). Where the warp has made the
// patch much larger, smaller or flatter, the picture's own takes its place. A point is lost where Lucas-Kanade does not
// find its way back, where what is found is not like the patch (something stands before it), or where the patch has
// shrunk to a fraction (its surface turns away, and what is found next slips along the silhouette). It stays lost.
#pragma once
#include <memory>

#include "nrsfm/make/pictures.h"

namespace gonio::nrsfm {

struct TrackerOptions {
  int half_px = 7;           // a patch has 2 half + 1 pixels a side
  double back_px = 0.5;      // the way back may miss the place where it began by this
  double likeness = 0.85;    // least correlation of a patch and what it is found to be
  double change = 1.33;      // of the patch's size in any direction, until a new one is taken
  double left = 0.2;         // of the largest area that a patch has had: with less it turns away
  double correction_px = 2;  // the warp's place may lie this far from Lucas and Kanade's
};

class Tracker {
 public:
  explicit Tracker(Eigen::Index points, const TrackerOptions& options = {});
  ~Tracker();
  // The next picture of the film, in which all points that are followed are sought.
  void advance(GreyPicture picture);
  // Begins to follow a point from a place in the last picture; lost at once where the picture ends beside it.
  void begin(Eigen::Index point, const Eigen::Vector2d& place_px);
  const Eigen::Matrix2Xd& places_px() const;  // in the last picture; NaN: not followed
  // One standard deviation of a followed point's place, each coordinate, about the point of the material where it
  // began: what noise did to the last alignment and to those at which patches were taken anew. 0 where it begins.
  double sigma_px(Eigen::Index point) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gonio::nrsfm
