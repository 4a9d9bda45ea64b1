// See least_squares.h.
#include "optim/least_squares.h"

#include <algorithm>
#include <limits>

#include "base/error.h"
#include "linear/blocks.h"
#include "optim/damped.h"

namespace gonio::optim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Weighed {
  double cost = 0, weight = 1;  // rho(s), rho'(s)
};
Weighed weighed(const Terms& terms, double s) {
  const double w2 = terms.width * terms.width;
  if (terms.loss == Loss::huber && s > w2) return {2 * terms.width * std::sqrt(s) - w2, terms.width / std::sqrt(s)};
  if (terms.loss == Loss::cauchy) return {w2 * std::log1p(s / w2), 1 / (1 + s / w2)};
  return {s, 1};
}

VectorXd clamped(const Terms& terms, VectorXd x) {
  if (terms.lower.size() > 0) x = x.cwiseMax(terms.lower);
  if (terms.upper.size() > 0) x = x.cwiseMin(terms.upper);
  return x;
}

class Dense final : public Descent {
 public:
  Dense(const Model& model, const Terms& terms, VectorXd start) : model_(model), terms_(terms), x_(std::move(start)) {
    if (!model.residuals(x_, r_)) throw Error(Exit::internal, "optim", "the model has no value at the start");
    there_ = x_;
    there_r_ = r_;
    cost_ = cost_at(x_, r_);
  }
  double cost() const { return cost_; }
  const VectorXd& x() const { return x_; }

  void linearise() override {
    MatrixXd j = model_.slopes(x_, r_);
    VectorXd r = r_;
    if (terms_.loss != Loss::squares)
      for (Index first = 0; first < r.size(); first += terms_.group) {
        const Index n = std::min(terms_.group, r.size() - first);
        const double root = std::sqrt(weighed(terms_, r.segment(first, n).squaredNorm()).weight);
        r.segment(first, n) *= root;
        j.middleRows(first, n) *= root;
      }
    h_ = linear::gram_of(j);
    downhill_ = -(j.transpose() * r);
    for (const Prior& p : terms_.priors) {
      h_(p.parameter, p.parameter) += 1 / (p.sigma * p.sigma);
      downhill_[p.parameter] += (p.mean - x_[p.parameter]) / (p.sigma * p.sigma);
    }
    free_.clear();
    for (Index k = 0; k < h_.cols(); ++k)
      if (!pressed(k)) free_.push_back(k);
  }

  Proposal propose(double damping) override {
    VectorXd change = VectorXd::Zero(h_.cols());
    const auto step = damped_step(MatrixXd(h_(free_, free_)), VectorXd(downhill_(free_)), damping);
    change(free_) = step.change;
    there_ = clamped(terms_, model_.moved(x_, change));
    if (terms_.lower.size() == 0 && terms_.upper.size() == 0) return {step.promised, length_of(change)};
    change = there_ - x_;  // what bounds have left of it
    return {2 * downhill_.dot(change) - change.dot(h_ * change), length_of(change)};
  }

  double evaluate() override {
    return model_.residuals(there_, there_r_) ? cost_at(there_, there_r_) : std::numeric_limits<double>::infinity();
  }
  void accept() override {
    x_.swap(there_);
    r_.swap(there_r_);
  }

  std::vector<Index> held() const {
    std::vector<Index> held;
    for (Index k = 0; k < h_.cols(); ++k)
      if (!std::ranges::binary_search(free_, k)) held.push_back(k);
    return held;
  }

  // Of what is free; false where something is not determined.
  bool covariance(MatrixXd& all) const {
    const auto n = static_cast<Index>(free_.size());
    const MatrixXd h = h_(free_, free_);
    const VectorXd scale = h.diagonal().unaryExpr([](double v) { return v > 0 ? 1 / std::sqrt(v) : 0.0; });
    const linear::EigenPairs e = linear::eigen_of(scale.asDiagonal() * h * scale.asDiagonal());
    const double least = 1e-14 * static_cast<double>(n) * e.largest();
    VectorXd inverse = VectorXd::Zero(n);
    std::vector<bool> open(free_.size());
    for (Index k = 0; k < n; ++k) {
      if (e.values[k] > least) {
        inverse[k] = 1 / e.values[k];
        continue;
      }
      for (Index i = 0; i < n; ++i)
        open[static_cast<std::size_t>(i)] = open[static_cast<std::size_t>(i)] || std::abs(e.vectors(i, k)) > 1e-6;
    }
    const MatrixXd half = scale.asDiagonal() * e.vectors;
    all = MatrixXd::Zero(h_.rows(), h_.cols());
    all(free_, free_) = half * inverse.asDiagonal() * half.transpose();
    for (std::size_t i = 0; i < free_.size(); ++i)
      if (open[i]) all(free_[i], free_[i]) = std::numeric_limits<double>::infinity();
    return std::ranges::none_of(open, [](bool o) { return o; });
  }

 private:
  bool pressed(Index k) const {
    return (terms_.lower.size() > 0 && x_[k] <= terms_.lower[k] && downhill_[k] <= 0) ||
           (terms_.upper.size() > 0 && x_[k] >= terms_.upper[k] && downhill_[k] >= 0);
  }
  // In standard deviations, were nothing correlated.
  double length_of(const VectorXd& change) const {
    return std::sqrt(std::max(0.0, change.cwiseAbs2().dot(h_.diagonal())));
  }
  double cost_at(const VectorXd& x, const VectorXd& r) const {
    double cost = 0;
    if (terms_.loss == Loss::squares)
      cost = r.squaredNorm();
    else
      for (Index first = 0; first < r.size(); first += terms_.group)
        cost += weighed(terms_, r.segment(first, std::min(terms_.group, r.size() - first)).squaredNorm()).cost;
    for (const Prior& p : terms_.priors) {
      const double z = (x[p.parameter] - p.mean) / p.sigma;
      cost += z * z;
    }
    return cost;
  }

  const Model& model_;
  const Terms& terms_;
  VectorXd x_, r_, there_, there_r_, downhill_;
  MatrixXd h_;
  std::vector<Index> free_;
  double cost_ = 0;
};

}  // namespace

double Model::difference(const VectorXd& x, Index k) const {
  constexpr double share = 6e-6;  // the cube root of a double's precision
  const double size = k < x.size() ? std::abs(x[k]) : 0;
  return size > 0 ? share * size : share;
}

MatrixXd Model::slopes(const VectorXd& x, const VectorXd& r) const {
  const Index n = freedoms(x);
  MatrixXd j(r.size(), n);
  VectorXd change = VectorXd::Zero(n), up(r.size()), down(r.size());
  for (Index k = 0; k < n; ++k) {
    const double h = difference(x, k);
    change[k] = h;
    const bool above = residuals(moved(x, change), up);
    change[k] = -h;
    const bool below = residuals(moved(x, change), down);
    change[k] = 0;
    if (above && below)
      j.col(k) = (up - down) / (2 * h);
    else if (above)
      j.col(k) = (up - r) / h;
    else if (below)
      j.col(k) = (r - down) / h;
    else
      j.col(k).setZero();
  }
  return j;
}

Fit fit(const Model& model, VectorXd start, const Terms& terms, const Limits& limits) {
  Dense dense(model, terms, clamped(terms, std::move(start)));
  Fit result;
  result.descended = descend(dense, dense.cost(), limits);
  result.x = dense.x();
  result.cost = result.descended.cost;
  dense.linearise();
  result.held = dense.held();
  result.determined = dense.covariance(result.covariance);
  return result;
}

}  // namespace gonio::optim
