// What animatronics share: sheets, steps from one equilibrium to the next, points to follow. For animatronics/*.cpp.
#pragma once
#include <functional>

#include "base/random.h"
#include "geom/vector.h"
#include "nrsfm/make/animatronic.h"
#include "nrsfm/make/shell.h"

namespace gonio::nrsfm {

// A flat sheet in the plane z = 0 about the origin, of equilateral triangles: rows of vertices along x, every second
// row shifted by half a cell; the ends in x are straight. Only on this lattice are hinges isotropic (shell.h).
struct Sheet {
  Eigen::Matrix3Xd rest;
  Triangles triangles;
  double cell_m = 0;  // edge of a triangle
};
// `cells` along x; the width is rounded to an even number of rows, so that one is on y = 0.
Sheet flat_sheet(double length_x_m, double length_y_m, int cells);

// From 0 to 1 with neither speed nor acceleration at the ends (quintic).
double eased(double s);

// Leads the fixed vertices of a shell along and lets the rest follow, in equilibrium at every step.
class Play {
 public:
  Play(Shell& shell, const Eigen::Matrix3Xd& start, const AnimatronicOptions& options);
  // For every frame: `lead(s, x)` puts the fixed vertices where they are at time s (0 at the first frame, 1 at the
  // last); `after(x)` may change the shell and returns whether it has, in which case equilibrium is sought again. Error
  // (internal) where none is found. `rig(s)`: the rig at time s.
  DeformingSurface run(const std::function<void(double, Eigen::Matrix3Xd&)>& lead,
                       const std::function<Rig(double)>& rig,
                       const std::function<bool(const Eigen::Matrix3Xd&)>& after = {});

 private:
  void step(double s, const std::function<void(double, Eigen::Matrix3Xd&)>& lead,
            const std::function<bool(const Eigen::Matrix3Xd&)>& after);

  Shell& shell_;
  Eigen::Matrix3Xd x_, before_;
  AnimatronicOptions options_;
  double residual_ = 0;
};

// Points spread over the surface with even density, away from each other (best of some candidates: Mitchell 1991), and
// outside of the rig's boxes. `x`: the vertices when the points are chosen.
std::vector<Anchor> spread_anchors(const Triangles& triangles, const Eigen::Matrix3Xd& x, const Rig& rig,
                                   Eigen::Index count, std::uint64_t seed);

}  // namespace gonio::nrsfm
