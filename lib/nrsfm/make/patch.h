// One patch of a tracker, aligned to other pictures by an affine warp. For tracker.cpp.
#pragma once
#include <Eigen/Cholesky>
#include <optional>

#include "nrsfm/make/pictures.h"

namespace gonio::nrsfm {

// Where a patch is in a picture: W(x) = A x + t for x pixels from its middle.
struct Warp {
  Eigen::Matrix2d a = Eigen::Matrix2d::Identity();
  Eigen::Vector2d t = Eigen::Vector2d::Zero();
};

// How well a patch lies where it was found.
struct Fit {
  double likeness = 0;  // correlation of the patch and what is there
  double sigma_px = 0;  // of the warp's place, each coordinate: of the least squares, their noise by their residuals
};

class Patch {
 public:
  // Of 2 half + 1 pixels a side about `place_px`; none where the picture ends there, or shows nothing to hold on to.
  static std::optional<Patch> of(const GreyPicture& picture, const Eigen::Vector2d& place_px, int half_px);
  // Moves the warp to where the picture is most like the patch; none where that fails.
  std::optional<Fit> align(const GreyPicture& picture, Warp& warp) const;

 private:
  double sigma_px(double residual_squares, double gain, const Warp& warp) const;
  int half_ = 0;
  Eigen::VectorXd value_;                             // of the patch, row by row
  Eigen::Matrix<double, Eigen::Dynamic, 8> columns_;  // slopes by A - 1 and t, the value, 1
  Eigen::LDLT<Eigen::Matrix<double, 8, 8>> normal_;
};

}  // namespace gonio::nrsfm
