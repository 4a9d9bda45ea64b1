// Settings under which rims of models lie on rims that were seen: least squares of normal offsets, with exact slopes.
//
//   minimise  sum over seen points  rho(d_i / sigma)  +  [sum over places of the models' rims rho(d_k / sigma)]  +
//   priors
//
// d_i: normal offset, px, of a seen point from the nearest place of its model's rim that faces the same way; d_k: of a
// place of the model's rim from the nearest seen point, only while the two are still far apart (these are no data: they
// keep a model from hiding where nothing was seen). As rims of meshes are made of the pictures of edges, the slope of
// an offset by any number of the setting is that of the edge's point, times the normal: nothing is rasterised, and
// nothing is differenced. rho is Cauchy's loss; its width falls in stages.
//
// A rim's place that lies beneath the ground is no rim that can be seen, and what is seen beside it does not count.
//
// Errors along a rim are not independent: neighbours share pixels, masks and whatever else is wrong there. The
// covariance is H^-1 M H^-1 with M = sum over pairs of points of one loop, gamma(arc between them) g_i g_j', gamma an
// exponential of the length over which what is left is alike, by its autocorrelation, pooled over the loops of one kind
// (White 1980; Liang & Zeger 1986).
#pragma once
#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "alignment/question.h"
#include "optim/descent.h"

namespace gonio::alignment {

struct SightingFit {
  std::vector<double> offset_px;   // of each point from the model's rim, + outside; NaN: none within reach
  std::vector<double> weight;      // of the loss, 0 to 1
  double sigma_px = 0;             // robust: of one point
  double rms_px = 0, mean_px = 0;  // of the points that count for more than a tenth
  double share = 1;                // of an observation: several sightings of one mask are one
  std::size_t counted = 0, left_out = 0;
  double explained = 0;  // share of the model's visible rim with points within three sigma and a pixel
  double met = 0;        // share of the points with a rim there
};
struct Fitted {
  Setting setting;
  double cost = 0;  // of the last stage
  optim::Descended descended;
  std::vector<SightingFit> sightings;
  double rms_px = 0, sigma_px = 0, correlation_px = 0, explained = 0, met = 0;
  // Of the numbers of the freedoms, with correlated errors; of what nothing holds, huge: see `open`.
  Eigen::MatrixXd covariance;
};

// Error(data) where a rim of the start does not exist (behind a camera, above a lamp). `path`, if any, is continued.
Fitted fit_rims(const Setting& start, const Question& question, const std::vector<Stage>& stages,
                FitPath* path = nullptr);
// Costs of settings alone, each point's share bounded: for choosing between starts. Infinite where rims do not exist.
// The question has to outlive it.
class RimCost {
 public:
  explicit RimCost(const Question& question);
  ~RimCost();
  RimCost(const RimCost&) = delete;
  double of(const Setting& setting, const Stage& stage) const;

 private:
  struct Known;
  std::unique_ptr<const Known> known_;
};

}  // namespace gonio::alignment
