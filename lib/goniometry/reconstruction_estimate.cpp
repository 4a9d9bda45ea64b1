// Estimators of the components and the width of their intervals.
//
// With the prior c ~ N(c0, L L') the posterior is S = L (1 + L' Q'' W Q' L)^-1 L', c = c0 + S Q'' W (y - Q' c0); with
// the Cholesky factor C of the bracket, S = F F' for F' = C^-1 L'. Tikhonov's gain G = (Q'' Q' + eta)^-1 Q'' leaves
// (1 - G Q') L L' (1 - G Q')' + G W^-1 G'.
#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "goniometry/reconstruction_parts.h"
#include "stats/intervals.h"

namespace gonio::goniometry {
namespace {

constexpr double normal_95 = 1.959963984540054;
constexpr std::size_t test_cells = 300;

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
    return {mean, covariance.llt().matrixL()};
  }

 private:
  const Basis& basis_;
  Eigen::Index k_;
  Eigen::VectorXd sum_;
  Eigen::MatrixXd squares_;
};

struct TestCells {
  Eigen::MatrixXd q;  // K x cells
  Eigen::VectorXd rest;
};

TestCells draw_cells(const Basis& basis, Random& random) {
  const std::size_t count = std::min(test_cells, basis.cells().count());
  TestCells cells{Eigen::MatrixXd(basis.components(), count), Eigen::VectorXd(count)};
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t cell = random.below(static_cast<std::uint32_t>(basis.cells().count()));
    const auto row = basis.q(cell);
    const auto column = static_cast<Eigen::Index>(i);
    for (std::size_t k = 0; k < row.size(); ++k) cells.q(static_cast<Eigen::Index>(k), column) = row[k];
    cells.rest[column] = static_cast<double>(basis.rest()[cell]);
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
  const Eigen::MatrixXd turned = bracket.llt().matrixL().solve(prior.factor.transpose());
  return {turned.transpose() * (turned * weighted.transpose()), turned.transpose()};
}

Estimator tikhonov_estimator(const Observed& observed, const Prior& prior, double eta_per_sample) {
  const Eigen::Index k = prior.factor.rows();
  Eigen::MatrixXd normal = observed.q.transpose() * observed.q;
  normal.diagonal().array() += eta_per_sample;
  const Eigen::MatrixXd gain = normal.llt().solve(observed.q.transpose());
  const Eigen::MatrixXd open = (Eigen::MatrixXd::Identity(k, k) - gain * observed.q) * prior.factor;
  const Eigen::MatrixXd covariance = open * open.transpose() + gain * observed.noise.asDiagonal() * gain.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(covariance);
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
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(seen.transpose() * weights.asDiagonal() * seen);
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
  double chi2(const Scales& s) const {
    double sum = left_ / s.noise;
    for (std::size_t i = 0; i < gains_.size(); ++i) sum += squares_[i] / (s.prior * gains_[i] + s.noise);
    return sum;
  }
  // -2 ln of the density of y, with ln of either scale normal of the width ln 4.
  double cost(const Scales& s) const {
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

Scales likely_scales(const Observed& observed, const Prior& prior, const Eigen::VectorXd& y) {
  const Evidence evidence(observed, prior, y);
  Scales best;
  double least = evidence.cost(best);
  for (int a = 0; a <= 12; ++a)
    for (int b = 0; b <= 40; ++b) {
      const Scales s{std::pow(2.0, a / 2.0), std::pow(2.0, b / 2.0)};
      if (const double cost = evidence.cost(s); cost < least) best = s, least = cost;
    }
  return best;
}

Observed scaled(const Observed& observed, const Scales& scales) {
  return {observed.q, observed.y, observed.noise * scales.noise};
}
Prior scaled(const Prior& prior, const Scales& scales) {
  return {prior.mean, prior.factor * std::sqrt(scales.prior)};
}

Calibration calibrate(const Basis& basis, const Observed& observed, const ReconstructOptions& options) {
  const Others others(basis);
  Random random(17);
  const TestCells cells = draw_cells(basis, random);
  const bool singly = basis.classes() == basis.materials().size();
  std::vector<double> ratios;
  double widest = 0;
  std::size_t within = 0, all = 0;
  for (std::uint32_t left_out = 0; left_out < basis.classes(); ++left_out) {
    const Prior prior = others.without(left_out);
    for (std::size_t s = 0; s < basis.samples(); ++s) {
      if (basis.class_of(s) != left_out) continue;
      Eigen::VectorXd y = observed.q * others.score(s);
      for (Eigen::Index i = 0; i < y.size(); ++i) y[i] += std::sqrt(observed.noise[i]) * random.normal();
      const Scales scales = likely_scales(observed, prior, y);
      const Estimator e = estimator(scaled(observed, scales), scaled(prior, scales), options, basis.samples());
      const Eigen::ArrayXd sigma = ((e.factor.transpose() * cells.q).colwise().squaredNorm().transpose().array() +
                                    scales.noise * cells.rest.array().square())
                                       .sqrt();
      Eigen::VectorXd error = cells.q.transpose() * (others.score(s) - e.estimate(observed, prior, y));
      for (Eigen::Index i = 0; i < error.size(); ++i) {
        error[i] += cells.rest[i] * random.normal();
        ratios.push_back(std::abs(error[i]) / std::max(sigma[i], 1e-12));
        within += ratios.back() <= normal_95 ? 1 : 0, ++all;
      }
    }
    if (singly) continue;
    widest = std::max(widest, stats::quantile(ratios, 0.95));
    ratios.clear();
  }
  if (singly) widest = stats::quantile(ratios, 0.95);
  return {widest / normal_95, static_cast<double>(within) / static_cast<double>(all)};
}

}  // namespace gonio::goniometry
