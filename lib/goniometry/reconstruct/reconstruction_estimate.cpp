// Estimators of the components and the width of their intervals.
//
// With the prior c ~ N(c0, L L') the posterior is S = L (1 + L' Q'' W Q' L)^-1 L', c = c0 + S Q'' W (y - Q' c0); with
// the Cholesky factor C of the bracket, S = F F' for F' = C^-1 L'. Tikhonov's gain G = (Q'' Q' + eta)^-1 Q'' leaves
// (1 - G Q') L L' (1 - G Q')' + G W^-1 G'.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "base/random.h"
#include "goniometry/reconstruct/reconstruction_parts.h"
#include "linear/solve.h"
#include "linear/symmetric_eigen.h"
#include "stats/intervals.h"

namespace gonio::goniometry {
namespace {

constexpr double normal_95 = 1.959963984540054;
constexpr std::size_t cells_per_region = 60;

// Mean and covariance of the scores of all materials but those of one class.
class Others {
 public:
  explicit Others(const Basis& basis)
      : basis_(basis),
        k_(static_cast<Eigen::Index>(basis.components())),
        sum_(Eigen::VectorXd::Zero(k_)),
        squares_(Eigen::MatrixXd::Zero(k_, k_)) {
    for (std::size_t s = 0; s < basis.samples(); ++s) {
      sum_ += score(s);
      squares_ += score(s) * score(s).transpose();
    }
  }
  Eigen::Map<const Eigen::VectorXd> score(std::size_t sample) const {
    return {basis_.scores().data() + sample * basis_.components(), k_};
  }
  Prior without(std::uint32_t left_out) const {
    Eigen::VectorXd sum = sum_;
    Eigen::MatrixXd squares = squares_;
    double n = static_cast<double>(basis_.samples());
    for (std::size_t s = 0; s < basis_.samples(); ++s) {
      if (basis_.class_of(s) != left_out) continue;
      sum -= score(s);
      squares -= score(s) * score(s).transpose();
      --n;
    }
    const Eigen::VectorXd mean = sum / n;
    Eigen::MatrixXd covariance = (squares - n * mean * mean.transpose()) / (n - 1);
    covariance.diagonal().array() += 1e-9;
    return {mean, linear::Llt(covariance).lower()};
  }

 private:
  const Basis& basis_;
  Eigen::Index k_;
  Eigen::VectorXd sum_;
  Eigen::MatrixXd squares_;
};

struct TestCells {
  Eigen::MatrixXd q;  // K x cells
  std::vector<std::size_t> cell, region;
};

// At random, the same number in every region where there are any.
TestCells draw_cells(const Basis& basis) {
  Random random(17);
  TestCells cells;
  const auto [rings, tilts, turns] = basis.cells().bins();
  const auto below = [&](std::size_t n) { return random.below(static_cast<std::uint32_t>(n)); };
  std::array<std::size_t, Widening::regions> drawn{};
  for (std::size_t tries = 0; tries < 40 * cells_per_region * Widening::regions; ++tries) {
    const std::size_t h = below(rings), d = below(tilts);
    const std::uint32_t cell = basis.cells().cell_of(h, d, below(turns));
    const std::size_t region = Widening::region_of((static_cast<double>(h) + 0.5) / static_cast<double>(rings),
                                                   (static_cast<double>(d) + 0.5) / static_cast<double>(tilts));
    if (cell == Cells::none || drawn[region] == cells_per_region) continue;
    ++drawn[region];
    cells.cell.push_back(cell);
    cells.region.push_back(region);
  }
  cells.q.resize(static_cast<Eigen::Index>(basis.components()), static_cast<Eigen::Index>(cells.cell.size()));
  for (std::size_t i = 0; i < cells.cell.size(); ++i) {
    const auto row = basis.q(cells.cell[i]);
    for (std::size_t k = 0; k < row.size(); ++k)
      cells.q(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)) = static_cast<double>(row[k]);
  }
  return cells;
}

}  // namespace

Prior standard_prior(std::size_t components) {
  const auto k = static_cast<Eigen::Index>(components);
  return {Eigen::VectorXd::Zero(k), Eigen::MatrixXd::Identity(k, k)};
}

Estimator map_estimator(const Observed& observed, const Prior& prior) {
  const Eigen::MatrixXd weighted = observed.noise.cwiseInverse().asDiagonal() * observed.q;
  const Eigen::MatrixXd seen = observed.q * prior.factor;
  const Eigen::Index k = prior.factor.rows();
  const Eigen::MatrixXd bracket =
      Eigen::MatrixXd::Identity(k, k) + seen.transpose() * observed.noise.cwiseInverse().asDiagonal() * seen;
  const Eigen::MatrixXd turned = linear::Llt(bracket).solve_lower(prior.factor.transpose());
  return {turned.transpose() * (turned * weighted.transpose()), turned.transpose()};
}

Estimator tikhonov_estimator(const Observed& observed, const Prior& prior, double eta_per_sample) {
  const Eigen::Index k = prior.factor.rows();
  Eigen::MatrixXd normal = observed.q.transpose() * observed.q;
  normal.diagonal().array() += eta_per_sample;
  const Eigen::MatrixXd gain = linear::Llt(normal).solve(observed.q.transpose());
  const Eigen::MatrixXd open = (Eigen::MatrixXd::Identity(k, k) - gain * observed.q) * prior.factor;
  const Eigen::MatrixXd covariance = open * open.transpose() + gain * observed.noise.asDiagonal() * gain.transpose();
  const linear::SymmetricEigen<Eigen::MatrixXd> eigen(covariance);
  return {gain, eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal()};
}

Estimator estimator(const Observed& observed, const Prior& prior, const ReconstructOptions& options,
                    std::size_t samples) {
  if (options.method == ReconstructOptions::Method::map) return map_estimator(observed, prior);
  return tikhonov_estimator(observed, prior, options.eta / static_cast<double>(samples - 1));
}

// Along the eigenvectors of L' Q'' W Q' L with eigenvalues g, y has the components u with variances a g + b, and what
// is left of it, in m - r dimensions, the variance b; a and b are the two scales.
class Evidence {
 public:
  Evidence(const Observed& observed, const Prior& prior, const Eigen::VectorXd& y) {
    const Eigen::VectorXd off = y - observed.q * prior.mean, weights = observed.noise.cwiseInverse();
    const Eigen::MatrixXd seen = observed.q * prior.factor;
    const linear::SymmetricEigen<Eigen::MatrixXd> eigen(seen.transpose() * weights.asDiagonal() * seen);
    const Eigen::VectorXd along = eigen.eigenvectors().transpose() * (seen.transpose() * weights.cwiseProduct(off));
    const double largest = eigen.eigenvalues().maxCoeff();
    left_ = off.dot(weights.cwiseProduct(off));
    freedom_ = static_cast<double>(y.size());
    for (Eigen::Index i = eigen.eigenvalues().size(); i-- > 0 && freedom_ > 0;) {
      const double g = eigen.eigenvalues()[i];
      if (!(g > 1e-12 * largest)) break;
      gains_.push_back(g);
      squares_.push_back(along[i] * along[i] / g);
      left_ -= squares_.back();
      --freedom_;
    }
    left_ = std::max(left_, 0.0);
  }
  double chi2(const PriorScales& s) const {
    double sum = left_ / s.noise;
    for (std::size_t i = 0; i < gains_.size(); ++i) sum += squares_[i] / (s.prior * gains_[i] + s.noise);
    return sum;
  }
  // -2 ln of the density of y, with ln of either scale normal of the width ln 4.
  double cost(const PriorScales& s) const {
    constexpr double width = 1.386;
    const double a = std::log(s.prior) / width, b = std::log(s.noise) / width;
    double sum = chi2(s) + freedom_ * std::log(s.noise) + a * a + b * b;
    for (const double g : gains_) sum += std::log(s.prior * g + s.noise);
    return sum;
  }

 private:
  std::vector<double> gains_, squares_;
  double left_ = 0, freedom_ = 0;
};

double chi2_of(const Observed& observed, const Prior& prior, const Eigen::VectorXd& y) {
  return Evidence(observed, prior, y).chi2({});
}

PriorScales likely_scales(const Observed& observed, const Prior& prior, const Eigen::VectorXd& y) {
  const Evidence evidence(observed, prior, y);
  PriorScales best;
  double least = evidence.cost(best);
  for (int a = 0; a <= 12; ++a)
    for (int b = 0; b <= 40; ++b) {
      const PriorScales s{std::pow(2.0, a / 2.0), std::pow(2.0, b / 2.0)};
      if (const double cost = evidence.cost(s); cost < least) best = s, least = cost;
    }
  return best;
}

Observed scaled(const Observed& observed, const PriorScales& scales) {
  return {observed.q, observed.y, observed.noise * scales.noise, observed.own, observed.blend};
}
Prior scaled(const Prior& prior, const PriorScales& scales) {
  return {prior.mean, prior.factor * std::sqrt(scales.prior)};
}

// The observations as they would be weighed by a basis without a class.
Observed without(const Basis& basis, const Observed& observed, std::uint32_t left_out) {
  Observed other = observed;
  for (Eigen::Index i = 0; i < other.noise.size(); ++i) {
    const Cells::Blend& blend = observed.blend[static_cast<std::size_t>(i)];
    double rest = 0;
    for (std::size_t c = 0; c < blend.cell.size(); ++c)
      rest += blend.share[c] * basis.rest_without(blend.cell[c], left_out);
    other.noise[i] = observed.own[i] + rest * rest + 1e-12;
  }
  return other;
}

namespace {

// Errors of materials left out, over their standard deviations: class by class, region by region.
using Ratios = std::vector<std::array<std::vector<double>, Widening::regions>>;

class LeftOut {
 public:
  LeftOut(const Basis& basis, const Observed& observed, const ReconstructOptions& options)
      : basis_(basis),
        observed_(observed),
        options_(options),
        singly_(basis.classes() == basis.materials().size()),
        others_(basis),
        cells_(draw_cells(basis)) {}

  Ratios ratios() const {
    Ratios all(basis_.classes());
    parallel_for(0, all.size(), [&](std::size_t c) { all[c] = of_class(static_cast<std::uint32_t>(c)); });
    return all;
  }

 private:
  std::array<std::vector<double>, Widening::regions> of_class(std::uint32_t left_out) const {
    const Prior prior = others_.without(left_out);
    const Observed seen = singly_ ? observed_ : without(basis_, observed_, left_out);
    Eigen::ArrayXd rest(cells_.q.cols());
    for (Eigen::Index i = 0; i < rest.size(); ++i)
      rest[i] = basis_.rest_without(cells_.cell[static_cast<std::size_t>(i)], left_out);
    std::array<std::vector<double>, Widening::regions> ratios;
    for (std::size_t s = 0; s < basis_.samples(); ++s) {
      if (basis_.class_of(s) != left_out) continue;
      Random random(17, s + 1);
      const Eigen::VectorXd y = simulated(s, random);
      const PriorScales scales = likely_scales(seen, prior, y);
      const Estimator e = estimator(scaled(seen, scales), scaled(prior, scales), options_, basis_.samples());
      const Eigen::ArrayXd sigma =
          ((e.factor.transpose() * cells_.q).colwise().squaredNorm().transpose().array() + scales.noise * rest.square())
              .sqrt();
      const Eigen::VectorXd error = cells_.q.transpose() * (others_.score(s) - e.estimate(seen, prior, y));
      for (Eigen::Index i = 0; i < error.size(); ++i) {
        const double more = singly_ ? rest[i] * random.normal() : 0;
        ratios[cells_.region[static_cast<std::size_t>(i)]].push_back(std::abs(error[i] + more) /
                                                                     std::max(sigma[i], 1e-12));
      }
    }
    return ratios;
  }
  Eigen::VectorXd simulated(std::size_t sample, Random& random) const {
    const Eigen::VectorXd& variance = singly_ ? observed_.noise : observed_.own;
    Eigen::VectorXd y = observed_.q * others_.score(sample);
    for (Eigen::Index i = 0; i < y.size(); ++i) y[i] += std::sqrt(variance[i]) * random.normal();
    return y;
  }

  const Basis& basis_;
  const Observed& observed_;
  const ReconstructOptions& options_;
  bool singly_;
  Others others_;
  TestCells cells_;
};

double quantile_of(const std::vector<double>& ratios) {
  return std::max(stats::quantile(ratios, 0.95) / normal_95, 1e-3);
}

double widening_of(const Ratios& ratios, std::size_t region, bool singly) {
  std::vector<double> tau, all;
  for (const auto& of_class : ratios) {
    if (of_class[region].empty()) return 1;
    if (singly)
      all.insert(all.end(), of_class[region].begin(), of_class[region].end());
    else
      tau.push_back(quantile_of(of_class[region]));
  }
  return singly ? quantile_of(all) : widening_of_next_class(tau);
}

}  // namespace

Calibration calibrate(const Basis& basis, const Observed& observed, const ReconstructOptions& options) {
  const Ratios ratios = LeftOut(basis, observed, options).ratios();
  Calibration result;
  for (std::size_t region = 0; region < Widening::regions; ++region)
    result.widening.s[region] = widening_of(ratios, region, basis.classes() == basis.materials().size());
  std::size_t within = 0, all = 0;
  for (const auto& of_class : ratios)
    for (const auto& region : of_class) {
      within += static_cast<std::size_t>(std::ranges::count_if(region, [](double r) { return r <= normal_95; }));
      all += region.size();
    }
  result.covered = static_cast<double>(within) / static_cast<double>(all);
  return result;
}

}  // namespace gonio::goniometry
