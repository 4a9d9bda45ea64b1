// Which directions to measure: the pairs from which a basis learns most.
//
// Row k of Q' is what one pair of directions sees of the components (goniometry/reconstruct/reconstruction.h), its
// noise variance 1 / W_k. After n pairs, S = (sum of W_k q_k q_k' + 1)^-1. Criteria:
//   average      the mean over all cells of the predicted variance, trace(S M), M = mean of q q' (A-optimal for the
//                table): what the table's user pays for
//   determinant  ln det S (D-optimal): the volume of what is left open
//   condition    the condition number of Q', as Nielsen, Jensen & Ramamoorthi 2015 minimise; it knows no noise, and of
//                a well conditioned Q' rows may still be small
// What is measured already counts: S begins as what given samples leave open.
// Pairs are added one by one, each the best (by rank-one updates of S), then exchanged one at a time while that helps.
// Candidates: zeniths of light and eye on a grid up to `most_theta_rad`, azimuths between them, and a finer set about
// the mirror direction, where lobes are. Exchanged pairs are the same by reciprocity: theta_i >= theta_o.
#pragma once
#include <string>
#include <vector>

#include "goniometry/basis/basis.h"
#include "goniometry/samples.h"

namespace gonio::goniometry {

struct PlanOptions {
  enum class Criterion { average, determinant, condition };
  Criterion criterion = Criterion::average;
  double most_theta_rad = 80 * pi / 180;
  double step_rad = 5 * pi / 180;
  double relative_noise = 0.02;
  const Samples* given = nullptr;  // measured already; any bands
};

struct PlannedPair {
  double theta_i = 0, phi_i = 0, theta_o = 0, phi_o = 0;  // rad; the mirror direction is phi_o = phi_i + pi
  Vec3 wi() const;
  Vec3 wo() const;
};
struct Plan {
  std::vector<PlannedPair> pairs;  // in the order in which to measure
  std::vector<double> sigma_ln;    // root of the mean variance that remains after the first, the second, ...
  double condition = 0;            // of Q', given rows among them
  double before = 0;               // sigma_ln before the first
  std::size_t candidates = 0;
};

// Error(usage) for n = 0 or more pairs than candidates, Error(data) where nothing of what is given is usable.
Plan plan(const Basis& basis, std::size_t n, const PlanOptions& options = {});

// What remains after any pairs, by the criteria above: for comparisons.
struct PlanQuality {
  double sigma_ln = 0, log_determinant = 0, condition = 0;
};
PlanQuality plan_quality(const Basis& basis, const std::vector<PlannedPair>& pairs, const PlanOptions& options = {});

std::string plan_csv(const Plan& plan);   // theta_i_rad,phi_i_rad,theta_o_rad,phi_o_rad,sigma_ln
std::string plan_json(const Plan& plan);  // {"directions": [{"theta_i_rad": ...}, ...]}

}  // namespace gonio::goniometry
