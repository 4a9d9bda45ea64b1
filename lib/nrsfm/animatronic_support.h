// What animatronics share: sheets, steps from one equilibrium to the next, points to follow. For animatronics/*.cpp.
#pragma once
#include <functional>

#include "base/random.h"
#include "geom/vector.h"
#include "nrsfm/animatronic.h"
#include "nrsfm/shell.h"

namespace gonio::nrsfm {

// Vertices of a flat sheet in the plane z = 0 about the origin, column by column: (i, j) at x_i, y_j. Diagonals
// alternate, so that no direction of bending is favoured.
struct Sheet {
  int nx = 0, ny = 0;  // cells
  Eigen::Matrix3Xd rest;
  Triangles triangles;
  std::uint32_t at(int i, int j) const { return static_cast<std::uint32_t>(i * (ny + 1) + j); }
};
Sheet flat_sheet(double length_x_m, double length_y_m, int nx, int ny);

// From 0 to 1 with neither speed nor acceleration at the ends (quintic).
double eased(double s);

// Leads the fixed vertices of a shell along and lets the rest follow, in equilibrium at every step.
class Play {
 public:
  Play(Shell& shell, const Eigen::Matrix3Xd& start, const AnimatronicOptions& options);
  // For every frame: `lead(s, x)` puts the fixed vertices where they are at time s (0 at the first frame, 1 at the
  // last); `after(x)` may change the shell and returns whether it has, in which case equilibrium is sought again. Error
  // (internal) where none is found.
  DeformingSurface run(const std::function<void(double, Eigen::Matrix3Xd&)>& lead,
                       const std::function<bool(const Eigen::Matrix3Xd&)>& after = {});

 private:
  void step(double s, const std::function<void(double, Eigen::Matrix3Xd&)>& lead,
            const std::function<bool(const Eigen::Matrix3Xd&)>& after);

  Shell& shell_;
  Eigen::Matrix3Xd rest_, x_, before_;
  AnimatronicOptions options_;
  double residual_ = 0;
};

// Points spread over the surface with even density, away from each other (best of some candidates: Mitchell 1991).
std::vector<Anchor> spread_anchors(const Triangles& triangles, const Eigen::Matrix3Xd& rest, Eigen::Index count,
                                   std::uint64_t seed);

}  // namespace gonio::nrsfm
