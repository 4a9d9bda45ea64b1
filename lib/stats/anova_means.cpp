// Coefficients and marginal means of an analysis of variance: linear functions c'beta. Estimable where c is a
// combination of R's rows, c = R' lambda; then the estimate is lambda'z with variance lambda' cov(z) lambda.
#include <cmath>
#include <limits>

#include "stats/anova_projections.h"
#include "stats/model_columns.h"

namespace gonio::stats {
namespace {

struct Estimate {
  double value = std::numeric_limits<double>::quiet_NaN(), sigma = value;
  bool estimable = false;
};

Estimate estimate(const Projections& fit, const Eigen::VectorXd& contrast) {
  const Eigen::VectorXd lambda = estimable(fit, contrast);
  if (lambda.size() == 0) return {};
  return {lambda.dot(fit.z), std::sqrt(std::max(0.0, lambda.dot(fit.covariance * lambda))), true};
}

}  // namespace

Eigen::VectorXd estimable(const Projections& fit, const Eigen::VectorXd& contrast) {
  const auto rank = static_cast<Eigen::Index>(fit.kept.size());
  Eigen::MatrixXd square(rank, rank);
  Eigen::VectorXd part(rank);
  for (Eigen::Index i = 0; i < rank; ++i) {
    square.col(i) = fit.r.col(fit.kept[static_cast<std::size_t>(i)]);
    part(i) = contrast(fit.kept[static_cast<std::size_t>(i)]);
  }
  const Eigen::VectorXd lambda = square.triangularView<Eigen::Upper>().transpose().solve(part);
  if (rank == fit.r.cols()) return lambda;
  const bool same = (fit.r.transpose() * lambda - contrast).cwiseAbs().maxCoeff() < 1e-7;
  return same ? lambda : Eigen::VectorXd();
}

Eigen::VectorXd contrast_at(const Design& design, const Projections& fit, const Term& factors,
                            std::span<const int> levels, bool only) {
  const ModelColumns columns(design, fit.terms);
  Eigen::VectorXd contrast = Eigen::VectorXd::Zero(columns.columns());
  if (!only) contrast(0) = 1;
  for (std::size_t t = 0; t < fit.terms.size(); ++t) {
    std::vector<int> own;
    for (const int f : fit.terms[t])
      for (std::size_t i = 0; i < factors.size(); ++i)
        if (factors[i] == f) own.push_back(levels[i]);
    if (own.size() != fit.terms[t].size() || (only && own.size() != factors.size())) continue;
    contrast.segment(columns.block(t).first, columns.block(t).count) = columns.part(t, own);
  }
  return contrast;
}

std::vector<std::vector<int>> all_levels(const Design& design, const Term& factors) {
  std::vector<std::vector<int>> all{{}};
  for (const int f : factors) {
    std::vector<std::vector<int>> longer;
    for (const std::vector<int>& levels : all)
      for (int l = 0; l < static_cast<int>(design.factors[static_cast<std::size_t>(f)].levels.size()); ++l) {
        longer.push_back(levels);
        longer.back().push_back(l);
      }
    all = std::move(longer);
  }
  return all;
}

void add_coefficients(const Design& design, Anova& fit) {
  const Estimate mean = estimate(*fit.projections, contrast_at(design, *fit.projections, {}, {}, false));
  fit.mean = mean.value;
  fit.sigma_mean = mean.sigma;
  for (const Term& term : fit.projections->terms)
    for (const std::vector<int>& levels : all_levels(design, term)) {
      const Estimate e = estimate(*fit.projections, contrast_at(design, *fit.projections, term, levels, true));
      fit.coefficients.push_back({term, levels, e.value, e.sigma, e.estimable});
    }
}

std::vector<MarginalMean> marginal_means(const Anova& fit, const Design& design, const Term& factors) {
  std::vector<MarginalMean> means;
  for (const std::vector<int>& levels : all_levels(design, factors)) {
    const Estimate e = estimate(*fit.projections, contrast_at(design, *fit.projections, factors, levels, false));
    MarginalMean mean{levels, e.value, e.sigma, 0, e.estimable};
    for (std::size_t i = 0; i < design.y.size(); ++i) {
      bool here = true;
      for (std::size_t k = 0; k < factors.size(); ++k)
        here = here && design.level[static_cast<std::size_t>(factors[k])][i] == levels[k];
      mean.observations += here;
    }
    means.push_back(std::move(mean));
  }
  return means;
}

}  // namespace gonio::stats
