// See picture_fit.h.
#include "alignment/picture_fit.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "linear/solve.h"
#include "linear/symmetric_eigen.h"
#include "optim/descent.h"

namespace gonio::alignment {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double step_px = 0.5;
constexpr double factor_sigma = 1;      // of logarithms of albedos and brightnesses, about what is stated
constexpr double first_relative = 0.1;  // before anything was measured
constexpr double first_inflation = 30;

// A change of one number that moves pictures by about half a pixel.
double step_of(const Setting& s, const Freedom& f) {
  double pitch = HUGE_VAL, focal = 1, radius = 0.1;  // metres a pixel, where the nearest camera sees the first body
  const Body& body =
      s.bodies[f.block == Block::body_turn || f.block == Block::body_shift || f.block == Block::body_scale ? f.which
                                                                                                           : 0];
  radius = body.shape->radius_m();
  for (const Station& station : s.stations) {
    const double f_px = s.lenses[station.lens].fx_px;
    pitch = std::min(pitch, norm(station.world_from_camera.translation_m - body.centre_m()) / f_px);
    focal = std::max(focal, f_px);
  }
  switch (f.block) {
    case Block::body_shift:
    case Block::station_shift:
    case Block::ground_shift: return step_px * pitch;
    case Block::body_turn:
    case Block::body_scale:
    case Block::ground_tilt:
    case Block::lens_focal: return step_px * pitch / radius;
    case Block::station_turn: return step_px / focal;
    default: return 0.01 * norm(s.lamps_m[f.which] - body.centre_m());  // of a lamp: shading changes by some percent
  }
}

// C^-1 in the numbers that are free, from what may be nearly singular: what rims do not hold counts for nothing.
MatrixXd information_of(const MatrixXd& covariance) {
  const VectorXd unit = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const linear::SymmetricEigen<MatrixXd> parts(MatrixXd(unit.asDiagonal() * covariance * unit.asDiagonal()));
  const double least = 1e-13 * parts.eigenvalues().maxCoeff();
  const VectorXd inverse = parts.eigenvalues().cwiseMax(least).cwiseInverse();
  const MatrixXd all = parts.eigenvectors() * inverse.asDiagonal() * parts.eigenvectors().transpose();
  return unit.asDiagonal() * all * unit.asDiagonal();
}

class Pictures final : public optim::Descent {
 public:
  Pictures(const PictureModel& model, const Fitted& rims, const std::vector<Freedom>& freedoms)
      : model_(model), freedoms_(freedoms), centre_(rims.setting), at_(rims.setting), next_(rims.setting) {
    const auto all = static_cast<Index>(numbers_of(freedoms));
    for (Index i = 0; i < all; ++i) {
      free_.push_back(rims.covariance(i, i) > 0);
      if (free_.back()) active_.push_back(i);
    }
    rims_ = information_of(rims.covariance(active_, active_));
    factors_of_surface_ = static_cast<Index>(3 * model.surfaces().size());
    Index groups = 0;
    for (const std::size_t g : model.brightness()) groups = std::max(groups, static_cast<Index>(g) + 1);
    factors_ = next_factors_ = VectorXd::Zero(factors_of_surface_ + 3 * groups);
    pure_ = pure_next_ = model.predict(at_);
  }

  // What is weighed how, from here on; `held`: factors alone move.
  void weigh(const PictureNoise& noise, bool held) {
    sigma_ = sigmas_of(model_, noise.relative, shown(pure_, factors_));
    inflation_ = noise.inflation;
    held_ = held;
  }
  double cost() const { return cost_of(at_, factors_, pure_); }
  std::vector<double> residual() const { return residual_of(shown(pure_, factors_)); }
  std::vector<double> shown_now() const { return shown(pure_, factors_); }
  const Setting& setting() const { return at_; }
  std::size_t numbers() const { return active_.size(); }
  const MatrixXd& rims() const { return rims_; }
  const std::vector<Index>& active() const { return active_; }

  void linearise() override {
    const std::vector<double> now = shown(pure_, factors_), left = residual_of(now);
    slopes_ = slopes(now);
    const Index n = static_cast<Index>(active_.size()), all = n + factors_.size();
    h_ = MatrixXd::Zero(all, all), g_ = VectorXd::Zero(all);
    const Loss loss = picture_loss();
    MatrixXd weighed = slopes_;
    VectorXd white(static_cast<Index>(left.size()));
    for (Index i = 0; i < weighed.rows(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      white(i) = left[k] / sigma_[k];
      weighed.row(i) *= loss.weight(white(i)) / inflation_;
    }
    h_ = weighed.transpose() * slopes_, g_ = -weighed.transpose() * white;
    const VectorXd d = change(at_);
    h_.topLeftCorner(n, n) += rims_, g_.head(n) += rims_ * d;
    h_.diagonal().tail(factors_.size()).array() += 1 / (factor_sigma * factor_sigma);
    g_.tail(factors_.size()) += factors_ / (factor_sigma * factor_sigma);
    if (!held_) return;
    h_.topRows(n).setZero(), h_.leftCols(n).setZero(), g_.head(n).setZero();
    h_.topLeftCorner(n, n).setIdentity();
  }
  optim::Proposal propose(double damping) override {
    MatrixXd damped = h_;
    damped.diagonal() *= 1 + damping;
    const VectorXd step = linear::Ldlt(damped).solve(VectorXd(-g_));
    std::vector<double> full(numbers_of(freedoms_), 0.0);
    for (std::size_t k = 0; k < active_.size(); ++k)
      full[static_cast<std::size_t>(active_[k])] = step(static_cast<Index>(k));
    if (!held_) next_ = moved(at_, freedoms_, full);
    next_factors_ = factors_ + step.tail(factors_.size());
    const VectorXd curved = h_ * step;
    return {.promised = -(2 * g_.dot(step) + step.dot(curved))};
  }
  double evaluate() override {
    pure_next_ = held_ ? pure_ : model_.predict(next_);
    return cost_of(next_, next_factors_, pure_next_);
  }
  void accept() override { at_ = next_, factors_ = next_factors_, pure_ = pure_next_; }

  // After linearise(): H^-1 M H^-1 of what is free.
  MatrixXd covariance(const PictureNoise& noise) const {
    const Index n = static_cast<Index>(active_.size()), f = factors_.size();
    const std::vector<double> left = residual();
    const Loss loss = picture_loss();
    MatrixXd weighed = slopes_;
    double square = 0, weight = 0, bend = 0;
    for (Index i = 0; i < weighed.rows(); ++i) {
      const double z = left[static_cast<std::size_t>(i)] / sigma_[static_cast<std::size_t>(i)], u = loss.weight(z);
      square += u * u * z * z, weight += u * u, bend += 2 * u * u - u;
      weighed.row(i) *= u / inflation_;
    }
    MatrixXd known = MatrixXd::Zero(n + f, n + f);  // rims' and priors' part of both H and M
    known.topLeftCorner(n, n) = rims_;
    known.diagonal().tail(f).array() += 1 / (factor_sigma * factor_sigma);
    const MatrixXd by_pixels = weighed.transpose() * slopes_;
    const double mean_weight = weighed.rows() > 0 ? std::max(0.1, bend / sum_of_weights(left)) : 1;
    const MatrixXd h = known + mean_weight * by_pixels;
    const MatrixXd meat = known + (weight > 0 ? square / weight : 1) * scattered(model_, noise, weighed);
    VectorXd unit = h.diagonal().cwiseMax(1e-30).cwiseSqrt().cwiseInverse();
    const MatrixXd scaled = unit.asDiagonal() * h * unit.asDiagonal();
    const MatrixXd inverse = linear::Ldlt(scaled).solve(MatrixXd(MatrixXd::Identity(n + f, n + f)));
    const MatrixXd h_inverse = unit.asDiagonal() * inverse * unit.asDiagonal();
    return MatrixXd(h_inverse * meat * h_inverse).topLeftCorner(n, n);
  }

 private:
  VectorXd change(const Setting& s) const {
    const std::vector<double> all = change_between(centre_, s, freedoms_);
    return VectorXd(Eigen::Map<const VectorXd>(all.data(), static_cast<Index>(all.size()))(active_));
  }
  Index albedo_factor(const PictureRow& row, int c) const { return static_cast<Index>(3 * row.surface) + c; }
  Index brightness_factor(const PictureRow& row, int c) const {
    return factors_of_surface_ + static_cast<Index>(3 * model_.brightness()[row.image]) + c;
  }
  std::vector<double> shown(const std::vector<double>& pure, const VectorXd& factors) const {
    std::vector<double> out(pure.size());
    for (std::size_t i = 0; i < out.size(); ++i) {
      const PictureRow& row = model_.rows()[i / 3];
      const int c = static_cast<int>(i % 3);
      out[i] = pure[i] * std::exp(factors(albedo_factor(row, c)) + factors(brightness_factor(row, c)));
    }
    return out;
  }
  std::vector<double> residual_of(const std::vector<double>& shown) const {
    std::vector<double> out(shown.size());
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = model_.rows()[i / 3].observed[static_cast<int>(i % 3)] - shown[i];
    return out;
  }
  double sum_of_weights(const std::vector<double>& left) const {
    double sum = 0;
    for (std::size_t i = 0; i < left.size(); ++i) sum += picture_loss().weight(left[i] / sigma_[i]);
    return sum;
  }
  double cost_of(const Setting& s, const VectorXd& factors, const std::vector<double>& pure) const {
    const VectorXd d = change(s);
    const std::vector<double> left = residual_of(shown(pure, factors));
    const Loss loss = picture_loss();
    double sum = 0;
    for (std::size_t i = 0; i < left.size(); ++i) sum += loss.cost(left[i] / sigma_[i]);
    return d.dot(rims_ * d) + factors.squaredNorm() / (factor_sigma * factor_sigma) + sum / inflation_;
  }
  // Of what is shown, over sigma, by the free numbers and then the factors.
  MatrixXd slopes(const std::vector<double>& now) const {
    const Index n = static_cast<Index>(active_.size());
    MatrixXd out = MatrixXd::Zero(static_cast<Index>(now.size()), n + factors_.size());
    std::vector<std::vector<double>> by_number;
    if (!held_) by_number = picture_slopes(model_, at_, freedoms_, free_);
    for (std::size_t i = 0; i < now.size(); ++i) {
      const PictureRow& row = model_.rows()[i / 3];
      const int c = static_cast<int>(i % 3);
      const auto r = static_cast<Index>(i);
      const double factor = std::exp(factors_(albedo_factor(row, c)) + factors_(brightness_factor(row, c)));
      for (Index k = 0; k < n && !held_; ++k)
        out(r, k) = factor * by_number[static_cast<std::size_t>(active_[static_cast<std::size_t>(k)])][i] / sigma_[i];
      out(r, n + albedo_factor(row, c)) = out(r, n + brightness_factor(row, c)) = now[i] / sigma_[i];
    }
    return out;
  }

  const PictureModel& model_;
  const std::vector<Freedom>& freedoms_;
  const Setting centre_;
  Setting at_, next_;
  std::vector<bool> free_;
  std::vector<Index> active_;
  Index factors_of_surface_ = 0;
  VectorXd factors_, next_factors_;
  std::vector<double> pure_, pure_next_, sigma_;
  double inflation_ = 1;
  bool held_ = true;
  MatrixXd rims_, slopes_, h_;
  VectorXd g_;
};

std::vector<double> relative_of_images(const PictureModel& model, const std::vector<double>& left) {
  std::vector<double> squares(model.images().size()), seen(model.images().size());
  for (std::size_t i = 0; i < left.size(); ++i) {
    const PictureRow& row = model.rows()[i / 3];
    const double y = row.observed[static_cast<int>(i % 3)];
    squares[row.image] += left[i] * left[i], seen[row.image] += y * y;
  }
  for (std::size_t g = 0; g < squares.size(); ++g) squares[g] = seen[g] > 0 ? std::sqrt(squares[g] / seen[g]) : 0;
  return squares;
}

}  // namespace

std::vector<std::vector<double>> picture_slopes(const PictureModel& model, const Setting& at,
                                                const std::vector<Freedom>& freedoms, const std::vector<bool>& free) {
  std::vector<std::vector<double>> out(free.size());
  std::vector<double> change(free.size(), 0.0);
  std::size_t k = 0;
  for (const Freedom& f : freedoms)
    for (std::size_t i = 0; i < f.size(); ++i, ++k) {
      if (!free[k]) continue;
      const double step = step_of(at, f);
      change[k] = step;
      out[k] = model.predict(moved(at, freedoms, change));
      change[k] = -step;
      const std::vector<double> below = model.predict(moved(at, freedoms, change));
      change[k] = 0;
      for (std::size_t r = 0; r < below.size(); ++r) out[k][r] = (out[k][r] - below[r]) / (2 * step);
    }
  return out;
}

double share_left(const PictureModel& model, const Setting& setting) {
  const std::vector<double> shown = model.predict(setting);
  struct Sums {
    double yy = 0, ym = 0, mm = 0;
  };
  std::map<std::array<std::size_t, 3>, Sums> sums;  // surface, brightness, colour
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const PictureRow& row = model.rows()[i / 3];
    const double y = row.observed[static_cast<int>(i % 3)];
    Sums& s = sums[{row.surface, model.brightness()[row.image], i % 3}];
    s.yy += y * y, s.ym += y * shown[i], s.mm += shown[i] * shown[i];
  }
  double left = 0, seen = 0;
  for (const auto& [place, s] : sums) left += s.yy - (s.mm > 0 ? s.ym * s.ym / s.mm : 0), seen += s.yy;
  return seen > 0 ? std::sqrt(std::max(0.0, left) / seen) : 0;
}

PictureFit fit_pictures(const PictureModel& model, const Fitted& rims, const std::vector<Freedom>& freedoms,
                        const PictureNoise* known) {
  Pictures pictures(model, rims, freedoms);
  PictureNoise noise;
  noise.relative.assign(model.images().size() * model.surfaces().size(), first_relative);
  noise.inflation = first_inflation;
  optim::Limits limits;
  limits.most_refusals = 6;
  const auto descend = [&](bool held, int most_steps) {
    limits.most_steps = most_steps, limits.small_fall = limits.small_promise = {0, 0.02};
    pictures.weigh(noise, held);
    return optim::descend(pictures, pictures.cost(), limits).cost;
  };
  descend(true, 20);
  PictureFit fit;
  fit.relative_before = relative_of_images(model, pictures.residual());
  for (const int steps : {6, 10}) {
    const auto numbers = static_cast<double>(pictures.numbers());
    noise = known ? *known : noise_of(model, pictures.residual(), pictures.shown_now(), numbers);
    fit.cost = descend(false, steps);
  }
  fit.noise = known
                  ? *known
                  : noise_of(model, pictures.residual(), pictures.shown_now(), static_cast<double>(pictures.numbers()));
  fit.relative_after = relative_of_images(model, pictures.residual());
  pictures.weigh(fit.noise, false);
  pictures.linearise();
  fit.cost = pictures.cost();
  fit.setting = pictures.setting(), fit.numbers = pictures.numbers();
  const auto all = static_cast<Index>(numbers_of(freedoms));
  fit.covariance = fit.rims = MatrixXd::Zero(all, all);
  fit.covariance(pictures.active(), pictures.active()) = pictures.covariance(fit.noise);
  fit.rims(pictures.active(), pictures.active()) = pictures.rims();
  return fit;
}

}  // namespace gonio::alignment
