// Fits: bounded Levenberg-Marquardt over the groups in play, the covariance of its result, and scores on groups that it
// did not see.
#pragma once
#include <vector>

#include "inference/explanation.h"
#include "inference/system.h"

namespace gonio::inference {

struct Fit {
  std::vector<double> values;       // one per parameter of the problem
  std::vector<std::size_t> active;  // what was free
  std::vector<std::size_t> inner;   // those of them that ended inside their bounds
  double cost = 0;                  // sum of whitened squares plus priors
  bool converged = false;
};
// Minimises the whitened sum of squares over `active`. Parameters that press against a bound are held there. Marquardt
// 1963 with columns scaled to unit length; deterministic. With `kept` slopes the steps are chords: the result is
// approximate by as much as those slopes have turned on the way.
Fit fit(const System& system, std::vector<double> start, const std::vector<std::size_t>& active, int iterations = 60,
        const Slopes* kept = nullptr);

// Fall of the cost that these slopes promise where the fit stands: g' H^-1 g over what bounds leave free.
double decrement(const System& system, const Fit& fit, const Slopes& slopes);

// Covariance of a fit, H^-1 M H^-1 with M the sum over blocks of their squared scores (White 1980; Liang & Zeger 1986),
// each freed of its own pull on the fit (Bell & McCaffrey 2002): honest under any correlation inside a block and any
// mis-stated sigma. Intervals are Student's with the effective number of blocks behind a parameter. Where leaving out
// whole groups moves a parameter by more than that explains (variance ratio beyond its 95 % point), the jackknife over
// groups stands instead.
struct Uncertainty {
  Eigen::MatrixXd covariance;  // of `parameters`
  Eigen::MatrixXd by_blocks;   // the same before the jackknife over groups has a say
  std::vector<std::size_t> parameters;
  std::vector<double> degrees;  // for Student's t: of the blocks, or groups - 1 where the jackknife rules
};
Uncertainty uncertainty(const System& system, const Fit& fit, const Slopes* kept = nullptr);
std::vector<Estimate> estimates(const System& system, const Fit& fit, const Uncertainty& uncertainty,
                                const std::vector<std::size_t>& parameters);
// P-value of "all these parameters are neutral" (Wald).
double neutral_p(const System& system, const Fit& fit, const Uncertainty& uncertainty,
                 const std::vector<std::size_t>& parameters, bool by_blocks = false);

// Sums of squares per group in play (in the order of System::groups), on rows whose group took no part in the shared
// parameters and whose half took no part in the group's own nuisance.
struct HeldOut {
  std::vector<double> whitened, raw, norm;
  std::vector<double> rows;
  std::vector<double> blocks;  // whitened, by block as numbered in the data; empty where judged linearly
  double score() const;        // sqrt(sum raw / sum norm), the user's unit
};
// Leave one group out, by one Gauss-Newton step from the joint optimum, then judged with the real predictions.
HeldOut held_out_by_step(const System& system, const Fit& fit, const Slopes* kept = nullptr);
// The same for any subset of a linearisation's columns, judged linearly: `whitened` and `rows` only.
HeldOut held_out_linear(const System& system, const Linearisation& linearisation,
                        const std::vector<std::size_t>& columns);
// Leave one group out with a fit each, along the chords of the joint fit.
HeldOut held_out_by_refit(const System& system, const Fit& fit);
// Groups `unseen` under a fit of the groups in play: nuisance is fitted on halves, everything else stands.
HeldOut unseen_groups(const System& system, const Fit& fit, const std::vector<std::size_t>& unseen);

// Fall of the mean square from `before` to `after` per used row, with its standard error over groups.
struct Gain {
  double mean = 0, sigma = 0;
};
Gain gain(const HeldOut& before, const HeldOut& after);
// The same fall over its standard error over blocks: what the noise of these very recordings could do, whatever their
// groups have in common (Vuong, Econometrica 57, 1989).
double block_z(const HeldOut& before, const HeldOut& after);
// Standard errors by which `after` is better, as of a normal law: over groups by Student's, or over blocks where groups
// are few. `floor`: of the standard error.
inline constexpr double at_most_errors = 12;
double errors_between(const HeldOut& before, const HeldOut& after, double floor);

}  // namespace gonio::inference
