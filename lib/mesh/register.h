// Views of one thing in one frame: do their overlaps agree within what the points state, and how would views have to
// move so that they do?
//
// Residual: distance of a point of one view from the surface that another view's points show about it, along that
// surface's normal (Chen & Medioni 1992), over its predicted standard deviation: that of the point's covariance and of
// the surface's estimate together (generalized ICP, Segal, Haehnel & Thrun 2009, with measured covariances instead of
// assumed ones). Pairs are taken in both directions, not across a fold, not at the border of a view, not between
// surfaces that face apart or that the other camera cannot have seen.
//
// Neighbouring residuals share points, so that sums over them vary more than independent ones would: variances are
// those of sums over patches in the world (Liang & Zeger 1986), for all pairs at once, since a view's errors enter all
// of its pairs.
//
// Motions of all views together minimise the robust sum of squares of all pairs (Huber 1964), with the stated poses as
// priors where they have uncertainties. Normals are estimates: their errors alone give a plane some information about
// a motion along itself. That is known from the fits' covariances and taken off (as in regression with errors in the
// variables) before asking which directions the overlaps hold.
//
// Does not look for a start: views must lie within `reach_m` already. Results do not depend on threads.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "geom/rigid.h"
#include "mesh/reconstruct.h"

namespace gonio::mesh {

using ViewMotion = Rigid<frame::World, frame::World>;  // of a whole view: refined from stated coordinates

struct PoseDoubt {                      // what is stated about a view's pose
  std::array<double, 36> covariance{};  // of (rotation vector, place) of the camera in the world: rad, m
  Vec3 camera_m{};
};

struct RegisterWish {
  bool refine = false;
  bool hold = false;           // move in the directions that overlaps hold, where there are others, too
  std::size_t fixed = 0;       // the view that stays
  double limit_m = 1e-4;       // a direction is held where the points' motion along it is known to this
  double most = 2;             // times what is stated: views that would still lie farther apart are not moved
  double reach_m = 0;          // of pairs; 0: eight spacings and six standard deviations
  std::size_t samples = 6000;  // of each view, asked for their distance from the others
  std::uint64_t seed = 0;      // of the samples
};

struct OverlapResidual {
  std::uint32_t view = 0, other = 0;  // of the point; of the surface
  Vec3 at_m{};                        // the point, moved
  double off_m = 0, sigma_m = 0;      // positive: the point lies on the camera's side of the surface
};

struct PairFigures {
  std::size_t first = 0, second = 0;  // views
  std::size_t residuals = 0, patches = 0;
  std::array<double, 2> overlap{};  // share of either's points that have a surface of the other beside them
  double rms_m = 0;
  double consistency = 0, sigma = 0;  // root mean square of residuals over what is predicted: 1 where that is true
  double typical = 0;                 // the same of the middle half, which a few wrong points do not move
  double rigid = 0;                   // of it, what a motion of one view would explain,
  double rest = 0, rest_sigma = 0;    // and what would be left: consistency^2 = rigid^2 + rest^2
  double rigid_p = 1;                 // of as much by chance
  double shift_m = 0, turn_rad = 0;   // of that motion, at the middle of the overlap, where directions are held
  int held = 0;                       // directions of six in which this overlap alone holds a motion
};

struct Consistency {  // over all pairs
  double value = 0, sigma = 0, typical = 0, rigid = 0, rest = 0, rest_sigma = 0, rigid_p = 1;
  std::size_t residuals = 0, patches = 0;
};

struct ViewShift {
  ViewMotion motion{};
  Vec3 centre_m{};                      // of its overlaps
  Vec3 turn_rad{}, shift_m{};           // of the motion; the centre's
  std::array<double, 36> covariance{};  // of both, in this order; zero in directions that are not held
  std::size_t held = 0;                 // directions
  std::vector<std::string> open;        // "sliding along (1, 0, 0)", ...: what the overlaps do not hold
  bool prior = false;                   // its pose's uncertainty is stated and was used
};

struct Registration {
  std::vector<PairFigures> pairs;  // that overlap, as the views end up
  Consistency before, after;       // equal where nothing was moved
  std::vector<ViewShift> views;    // with refine: of each, the fixed one's is none
  std::vector<OverlapResidual> residuals;
  double reach_m = 0, inflation = 1;  // inflation: variance of motions over that of independent residuals
  int iterations = 0;
  std::string refused;  // with refine: why nothing was moved; empty: it was
  bool slides = false;  // that is why
};

// Every view has points and viewpoints. `doubts`: of each view, or empty.
Registration register_views(const MeasuredPoints& points, const std::vector<std::optional<PoseDoubt>>& doubts,
                            const RegisterWish& wish);

}  // namespace gonio::mesh
