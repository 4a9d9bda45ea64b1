// Physics corrects what a network, or nobody, said about a transparent object: its shape from outlines over views, then
// from the network's normals as measurements with their uncertainties, then from the light that came through it.
//
//   hull     visual hull of the masks (hull.h)
//   outline  a smooth body whose outlines are the masks'
//   normals  ... and whose normals are the network's, within what it knows
//   light    ... and through which the screen is seen as it was photographed; index and absorption are fitted with it.
//            Coarse to fine: the screen's picture is blurred less from step to step.
//
// One view is kept out of everything. The last stage is kept only if it explains that view's photograph better than the
// stage before, by an index that can be expected; hollow bodies, which two refractions cannot explain, so keep what
// outlines and network say.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "glass/refine/hull.h"
#include "glass/refine/measurements.h"
#include "optim/descent.h"

namespace gonio::glass {

struct RefineWish {
  HullWish hull;
  Sigmas sigmas;
  SmoothPrior prior;
  double index = 1.52, index_sigma = 0.06;
  double absorption_sigma_per_m = 10;
  std::optional<std::size_t> held_out;
  bool light = true;
  double least_gain = 0.02;  // of the share of the held-out view's light that is not explained
  int draws = 16;            // from the posterior; 0: no uncertainties
  std::uint64_t seed = 1;
};

struct Stage {
  std::string name;
  SplineField field;
  Glassy glass;                                      // absorption per cell
  double unexplained = 1, unexplained_held_out = 1;  // Measuring::unexplained: mean of the fitted views; held out
  std::string how{};                                 // the descent ended
};

struct Refined {
  std::vector<Stage> stages;  // in their order
  std::size_t answer = 0;     // place in `stages`
  double index_sigma = 0;     // of the answer's index; 0: not asked of the light
  // Coefficients' changes drawn from the posterior round the answer.
  std::vector<std::vector<double>> draws;
  const Stage& best() const { return stages[answer]; }
};

Refined refine(std::span<const View> views, const RefineWish& wish);

}  // namespace gonio::glass
