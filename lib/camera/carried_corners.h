// Corners of a projector's views, which were looked up at where cameras see them (corner_detection.h). A camera's error
// e in a corner's place moves the projector's by J e: it looks as if the corner lay elsewhere on the board, and says
// nothing about how the two stand to each other. What the projector says beyond its cameras is
//   r - sum J r_camera = (p - sum J c) - (p' - sum J c'),   r = found minus predicted (primes),
// which does not depend on their errors: this, over its own covariance, is what the adjustment makes small. For sources
// of this folder only.
#pragma once
#include <Eigen/Core>
#include <optional>
#include <vector>

#include "camera/bundle_adjustment.h"

namespace gonio::camera {

struct CarriedFrom {
  std::size_t view = 0, corner = 0;  // of that view
  Eigen::Matrix2d slope;
};

// Of one view, whether its corners are carried by views that are here: where one of the cameras is not (it is
// calibrated by itself), a corner stands alone, with the whole of its sigma.
class Carriers {
 public:
  Carriers(const std::vector<View>& views, std::size_t index);
  const std::vector<CarriedFrom>& of(std::size_t corner) const { return of_[corner]; }
  const std::vector<std::size_t>& views() const { return views_; }
  // Of one coordinate, in the mean of both; nothing where it is not known.
  std::optional<double> variance_px2(std::size_t corner) const;
  // Makes both coordinates as uncertain as variance_px2() says, and independent.
  Eigen::Matrix2d whitening(std::size_t corner) const;

 private:
  const View& view_;
  std::vector<std::size_t> views_;
  std::vector<std::vector<CarriedFrom>> of_;
};

// What the adjustment makes small, per corner: residuals(), less what cameras carry.
std::vector<Vec2> misses(const std::vector<View>& views, const CalibrationSetup& setup, const Adjustment& state,
                         std::size_t index);

}  // namespace gonio::camera
