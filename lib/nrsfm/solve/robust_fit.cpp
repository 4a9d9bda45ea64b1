// See robust_fit.h.
#include "nrsfm/solve/robust_fit.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "linear/solve.h"

namespace gonio::nrsfm {
namespace {

constexpr double band = 0.02;  // of a quartile's distance, to either side: whose derivatives its derivative averages
constexpr Eigen::Index least_in_band = 8;
constexpr double least_window = 0.02;          // about a squared quartile, relative: where the next one is looked for
constexpr double nothing = 1e-14;              // a distance that rounding makes, against extents of 1
constexpr double still = 1e-8, little = 1e-5;  // relative fall of the cost: at rest; negligible

// Sample quantile: linear between the order statistics about rank p (n - 1).
double quantile_of(const std::vector<double>& two, double fraction) {
  return std::sqrt(two[0]) + fraction * (std::sqrt(two[1]) - std::sqrt(two[0]));
}

Eigen::Matrix3d cross(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

}  // namespace

Similarity stepped(const Similarity& at, const Step& p) {
  const Eigen::Vector3d turn = p.segment<3>(1);
  const double angle = turn.norm(), scale = std::exp(p(0));
  const Eigen::Matrix3d r =
      angle > 0 ? Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() : Eigen::Matrix3d::Identity();
  return {scale * at.scale, r * at.rotation, scale * r * at.translation + p.tail<3>()};
}

RobustFit::RobustFit(const Eigen::Matrix3Xd& x, const Eigen::Matrix3Xd& q, RobustMean mean)
    : n_(x.cols()), mean_(mean), x_(x.transpose().array()), q_(q.transpose().array()), y_(n_, 3), e_(n_, 3), d2_(n_) {}

// The order statistics of rank k and k + 1 of d2, squared distances: those near where they were in the evaluation
// before are gathered, the nearer the less they moved then; where the ranks do not lie among them, all are.
void RobustFit::ordered(Eigen::Index k, const Guess& guess, std::vector<double>& two) {
  const double low = (1 - guess.width) * guess.value, high = (1 + guess.width) * guess.value;
  gathered_.resize(static_cast<std::size_t>(n_));
  Eigen::Index below = 0, in = 0;
  const double* d2 = d2_.data();
  double* out = gathered_.data();
  for (Eigen::Index i = 0; i < n_; ++i) {
    const double v = d2[i];
    below += v < low ? 1 : 0;
    if (v >= low && v <= high) out[in++] = v;
  }
  const Eigen::Index next = std::min(k + 1, n_ - 1);
  if (k < below || next >= below + in) {
    std::copy(d2, d2 + n_, out);
    below = 0, in = n_;
  }
  std::nth_element(out, out + (k - below), out + in);
  two[0] = out[k - below];
  two[1] = next == k ? two[0] : *std::min_element(out + (k - below) + 1, out + in);
}

void RobustFit::quartiles(State& state) {
  std::vector<double> two(2);
  const double last = static_cast<double>(n_ - 1);
  for (const bool third : {false, true}) {
    const double rank = (third ? 0.75 : 0.25) * last;
    const auto k = static_cast<Eigen::Index>(rank);
    Guess& guess = guess_[third ? 1 : 0];
    ordered(k, guess, two);
    const double change = guess.value > 0 ? std::abs(two[0] / guess.value - 1) : 1;
    guess = {two[0], std::clamp(2 * change, least_window, 0.4)};
    (third ? state.upper : state.lower) = quantile_of(two, rank - static_cast<double>(k));
  }
  state.whisker = 2.5 * state.upper - 1.5 * state.lower;
}

RobustFit::State RobustFit::evaluate(const Similarity& at) {
  const Eigen::Matrix3d a = at.scale * at.rotation;
  for (int i = 0; i < 3; ++i) {
    y_.col(i) = a(i, 0) * x_.col(0) + a(i, 1) * x_.col(1) + a(i, 2) * x_.col(2) + at.translation(i);
    e_.col(i) = y_.col(i) - q_.col(i);
  }
  d2_ = e_.col(0).square() + e_.col(1).square() + e_.col(2).square();
  State state;
  state.at = at;
  quartiles(state);
  const double w2 = state.whisker * state.whisker;
  state.beyond = (d2_ > w2).count();
  state.cost = (mean_ == RobustMean::printed ? d2_.min(w2).sqrt().sum() : d2_.min(w2).sum()) / static_cast<double>(n_);
  return state;
}

// Mean of v/d over the points with distances in [low, high].
Step RobustFit::mean_gradient(double centre) const {
  if (centre <= 0) return Step::Zero();
  for (double width = band;; width *= 2) {
    const double low = std::max(0.0, centre * (1 - width)), high = centre * (1 + width);
    const double low2 = low * low, high2 = high * high;
    Step sum = Step::Zero();
    Eigen::Index in = 0;
    for (Eigen::Index i = 0; i < n_; ++i) {
      if (d2_(i) < low2 || d2_(i) > high2 || d2_(i) <= 0) continue;
      const Eigen::Vector3d y = y_.row(i).matrix().transpose(), u = e_.row(i).matrix().transpose() / std::sqrt(d2_(i));
      sum(0) += y.dot(u);
      sum.segment<3>(1) += y.cross(u);
      sum.tail<3>() += u;
      ++in;
    }
    if (in >= std::min(least_in_band, n_) || width > 100) return in == 0 ? sum : Step(sum / static_cast<double>(in));
  }
}

// w2 v v' over the points, where the measure is a mean of distances: w2 = -1/d^3.
void RobustFit::subtract_along(const Eigen::ArrayXd& w2, StepMatrix& matrix) const {
  Eigen::Array<double, Eigen::Dynamic, 7> v(n_, 7);
  const auto product = [this](int i, int j) { return y_.col(i) * e_.col(j); };
  v.col(0) = product(0, 0) + product(1, 1) + product(2, 2);
  v.col(1) = product(1, 2) - product(2, 1);
  v.col(2) = product(2, 0) - product(0, 2);
  v.col(3) = product(0, 1) - product(1, 0);
  v.rightCols<3>() = e_;
  for (int i = 0; i < 7; ++i) {
    const Eigen::ArrayXd weighted = w2 * v.col(i);
    for (int j = i; j < 7; ++j) {
      const double sum = (weighted * v.col(j)).sum();
      matrix(i, j) += sum;
      if (j != i) matrix(j, i) += sum;
    }
  }
}

RobustFit::Derivatives RobustFit::derivatives(const State& state) {
  const double whisker2 = state.whisker * state.whisker;
  const bool printed = mean_ == RobustMean::printed;
  Eigen::ArrayXd w1;
  const double tiny2 = 1e-20 + 1e-16 * whisker2;  // where d vanishes the mean of distances has a corner
  if (printed)
    w1 = (d2_ <= whisker2).select(d2_.max(tiny2).rsqrt(), 0.0);
  else
    w1 = (d2_ <= whisker2).select(Eigen::ArrayXd::Constant(n_, 2.0), 0.0);
  Eigen::Matrix3d yy, ye;
  Eigen::Vector3d sum_y, sum_e;
  for (int i = 0; i < 3; ++i) {
    const Eigen::ArrayXd weighted = w1 * y_.col(i);
    sum_y(i) = weighted.sum();
    sum_e(i) = (w1 * e_.col(i)).sum();
    for (int j = 0; j < 3; ++j) {
      ye(i, j) = (weighted * e_.col(j)).sum();
      if (j <= i) yy(i, j) = yy(j, i) = (weighted * y_.col(j)).sum();
    }
  }
  Derivatives d{Step::Zero(), StepMatrix::Zero()};
  d.gradient << ye.trace(), ye(1, 2) - ye(2, 1), ye(2, 0) - ye(0, 2), ye(0, 1) - ye(1, 0), sum_e;
  d.matrix(0, 0) = yy.trace();
  d.matrix.block<1, 3>(0, 4) = sum_y.transpose();
  d.matrix.block<3, 1>(4, 0) = sum_y;
  d.matrix.block<3, 3>(1, 1) = yy.trace() * Eigen::Matrix3d::Identity() - yy;
  d.matrix.block<3, 3>(1, 4) = cross(sum_y);
  d.matrix.block<3, 3>(4, 1) = cross(sum_y).transpose();
  d.matrix.block<3, 3>(4, 4) = w1.sum() * Eigen::Matrix3d::Identity();
  if (printed) subtract_along((d2_ <= whisker2).select(-d2_.max(tiny2).pow(-1.5), 0.0), d.matrix);
  if (state.beyond > 0) {
    const Step w = 2.5 * mean_gradient(state.upper) - 1.5 * mean_gradient(state.lower);
    const double n = static_cast<double>(state.beyond);
    d.gradient += n * (printed ? 1 : 2 * state.whisker) * w;
    if (!printed) d.matrix += 2 * n * w * w.transpose();
  }
  d.gradient /= static_cast<double>(n_), d.matrix /= static_cast<double>(n_);
  return d;
}

RobustFit::Outcome RobustFit::minimize(const Similarity& start, int most_iterations) {
  Outcome out{evaluate(start), 0, false};
  State& state = out.state;
  Derivatives d = derivatives(state);
  double damping = 1e-4, growth = 2;
  while (!out.converged && out.iterations < most_iterations) {
    ++out.iterations;
    if (state.cost <= (mean_ == RobustMean::printed ? nothing : nothing * nothing) || d.gradient.isZero(0)) {
      out.converged = true;
      break;
    }
    StepMatrix damped = d.matrix;
    const double floor = 1e-9 * d.matrix.diagonal().maxCoeff() + std::numeric_limits<double>::min();
    for (int i = 0; i < 7; ++i) damped(i, i) += damping * std::max(d.matrix(i, i), floor);
    const Step p = -linear::solve_ldlt(damped, d.gradient);
    const double predicted = -(d.gradient.dot(p) + 0.5 * p.dot(d.matrix * p));
    const State next = evaluate(stepped(state.at, p));
    const double fall = state.cost - next.cost;
    if (!(fall > 0) || !p.allFinite()) {
      out.converged = predicted < little * state.cost && damping > 1;
      if (damping > 1e12) break;
      damping = std::max(damping, 1e-6) * growth, growth *= 2;
      continue;
    }
    const double gain = fall / std::max(predicted, std::numeric_limits<double>::min());
    out.converged = fall < still * state.cost;
    state = next;
    damping *= std::max(1.0 / 10, 1 - std::pow(2 * std::min(gain, 2.0) - 1, 3)), growth = 2;
    if (!out.converged) d = derivatives(state);
  }
  return out;
}

// One simplex of edges `size` from `best`, until it has shrunk to nothing. Evaluations used.
int RobustFit::simplex(State& best, double size, int most_evaluations) {
  struct Corner {
    Step p;
    double cost;
  };
  const Similarity base = best.at;
  std::vector<Corner> corners{{Step::Zero(), best.cost}};
  int used = 0;
  const auto at = [&](const Step& p) {
    ++used;
    return Corner{p, evaluate(stepped(base, p)).cost};
  };
  for (int k = 0; k < 7; ++k) corners.push_back(at(size * Step::Unit(k)));
  while (used < most_evaluations) {
    std::ranges::stable_sort(corners, {}, &Corner::cost);
    if (corners.back().cost - corners.front().cost <= still * corners.front().cost) break;
    Step middle = Step::Zero();
    for (std::size_t k = 0; k < 7; ++k) middle += corners[k].p / 7;
    Corner& worst = corners.back();
    const Step away = middle - worst.p;
    const Corner reflected = at(middle + away);
    if (reflected.cost < corners.front().cost) {
      const Corner further = at(middle + 2 * away);
      worst = further.cost < reflected.cost ? further : reflected;
    } else if (reflected.cost < corners[6].cost) {
      worst = reflected;
    } else {
      const Corner nearer = at(middle + (reflected.cost < worst.cost ? 0.5 : -0.5) * away);
      if (nearer.cost < std::min(reflected.cost, worst.cost))
        worst = nearer;
      else
        for (std::size_t k = 1; k < 8; ++k) corners[k] = at(corners[0].p + 0.5 * (corners[k].p - corners[0].p));
    }
  }
  const Corner& least = *std::ranges::min_element(corners, {}, &Corner::cost);
  if (least.cost < best.cost) best = evaluate(stepped(base, least.p));
  return used;
}

RobustFit::State RobustFit::polished(const State& state, int most_evaluations) {
  State best = state;
  for (double size = 0.1; size > 1e-5 && most_evaluations > 0;) {
    const double before = best.cost;
    most_evaluations -= simplex(best, size, most_evaluations);
    if (before - best.cost < little * before) size /= 4;
  }
  return best;
}

}  // namespace gonio::nrsfm
