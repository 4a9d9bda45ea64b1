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

// Mean and covariance of the scores of all materials but one.
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
  Prior without(std::uint32_t material) const {
    Eigen::VectorXd sum = sum_;
    Eigen::MatrixXd squares = squares_;
    double n = static_cast<double>(basis_.samples());
    for (std::size_t s = 0; s < basis_.samples(); ++s) {
      if (basis_.material_of()[s] != material) continue;
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

double chi2_of(const Observed& observed, const Prior& prior, const Estimator& map, const Eigen::VectorXd& y) {
  const Eigen::VectorXd off = y - observed.q * prior.mean;
  return off.dot((off - observed.q * (map.gain * off)).cwiseQuotient(observed.noise));
}

double misfit_of(const Observed& observed, const Prior& prior, const Estimator& map, const Eigen::VectorXd& y) {
  return std::max(1.0, std::sqrt(chi2_of(observed, prior, map, y) / static_cast<double>(y.size())));
}

Calibration calibrate(const Basis& basis, const Observed& observed, const ReconstructOptions& options) {
  const Others others(basis);
  Random random(17);
  const TestCells cells = draw_cells(basis, random);
  std::vector<double> ratios;
  std::size_t within = 0;
  for (std::size_t s = 0; s < basis.samples();) {
    const std::uint32_t material = basis.material_of()[s];
    const Prior prior = others.without(material);
    const Estimator e = estimator(observed, prior, options, basis.samples());
    const bool is_map = options.method == ReconstructOptions::Method::map;
    const Estimator likely = is_map ? e : map_estimator(observed, prior);
    const Eigen::ArrayXd sigma =
        ((e.factor.transpose() * cells.q).colwise().squaredNorm().transpose().array() + cells.rest.array().square())
            .sqrt();
    for (; s < basis.samples() && basis.material_of()[s] == material; ++s) {
      Eigen::VectorXd y = observed.q * others.score(s);
      for (Eigen::Index i = 0; i < y.size(); ++i) y[i] += std::sqrt(observed.noise[i]) * random.normal();
      const double wider = misfit_of(observed, prior, likely, y);
      Eigen::VectorXd error = cells.q.transpose() * (others.score(s) - e.estimate(observed, prior, y));
      for (Eigen::Index i = 0; i < error.size(); ++i) {
        error[i] += cells.rest[i] * random.normal();
        ratios.push_back(std::abs(error[i]) / std::max(wider * sigma[i], 1e-12));
        within += ratios.back() <= normal_95 ? 1 : 0;
      }
    }
  }
  return {stats::quantile(ratios, 0.95) / normal_95, static_cast<double>(within) / static_cast<double>(ratios.size())};
}

}  // namespace gonio::goniometry
