// See exposure_times.h.
#include "photograph/exposure_times.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "linear/solve.h"
#include "photograph/noise_variance.h"
#include "stats/distributions.h"

namespace gonio::photograph {
namespace {

constexpr int rounds = 5;
constexpr double clear_of_ends = 4;         // standard deviations
constexpr double least_of_full = 0.1;       // readings that times are from
constexpr double least_p = 1e-4;            // of a pixel's chi-square: below it something moved
constexpr double least_share = 1e-6;        // of the best exposure's information
constexpr std::size_t fewest_pixels = 100;  // to say anything

}  // namespace

double rate_of(const ExposureSamples& s, const std::vector<double>& t, std::size_t pixel,
               std::vector<std::size_t>& used) {
  double light = 0, time = 0;
  for (std::size_t k = 0; k < t.size(); ++k)
    if (!std::isnan(s.codes[k][pixel])) light += s.codes[k][pixel], time += t[k];
  double rate = time > 0 ? light / time : 0;
  for (int pass = 0; pass < 3; ++pass) {
    double sum = 0, information = 0;
    used.clear();
    for (std::size_t k = 0; k < t.size(); ++k) {
      const double expected = rate * t[k], variance = noise_variance(s.noise, expected),
                   margin = clear_of_ends * std::max(0.5, std::sqrt(variance));  // half a code: codes are whole
      if (std::isnan(s.codes[k][pixel]) || expected + margin > s.full_scale || expected - margin < s.floor) continue;
      sum += t[k] * s.codes[k][pixel] / variance, information += t[k] * t[k] / variance;
      used.push_back(k);
    }
    if (information > 0) rate = sum / information;
  }
  return rate;
}

namespace {

class Refinement {
 public:
  explicit Refinement(const ExposureSamples& s) : s_(s), count_(s.exposures_s.size()), t_(s.exposures_s) {
    if (std::isfinite(s.full_scale)) s_.floor = std::max(s_.floor, least_of_full * s.full_scale);
  }

  RefinedExposures run() {
    RefinedExposures result{s_.exposures_s, std::vector<double>(count_, 0.0)};
    for (int round = 0; round < rounds; ++round) {
      gather(round > 0);
      if (pixels_ < fewest_pixels) return result;
      move();
    }
    gather(true);
    if (pixels_ < fewest_pixels) return result;
    result.exposures_s = t_;
    const Eigen::MatrixXd covariance = linear::solve_ldlt(
        kept_normal(), Eigen::MatrixXd(Eigen::MatrixXd::Identity(index(told_.size()), index(told_.size()))));
    const double factor = std::max(1.0, chi_square_ / std::max(1.0, freedom_));
    for (std::size_t i = 0; i < told_.size(); ++i)
      result.sigma_s[told_[i]] = t_[told_[i]] * std::sqrt(factor * covariance(index(i), index(i)));
    return result;
  }

 private:
  static Eigen::Index index(std::size_t i) { return static_cast<Eigen::Index>(i); }

  // Normal equations for d, each pixel's rate eliminated.
  void gather(bool leave_moved_out) {
    normal_ = Eigen::MatrixXd::Zero(index(count_), index(count_));
    right_ = Eigen::VectorXd::Zero(index(count_));
    chi_square_ = freedom_ = 0, pixels_ = 0;
    std::vector<std::size_t> used;
    for (std::size_t p = 0; p < s_.codes[0].size(); ++p) {
      const double rate = rate_of(s_, t_, p, used);
      if (used.size() < 2 || !(rate > 0)) continue;
      double chi_square = 0, information = 0, sum = 0;
      for (const std::size_t k : used) {
        const double expected = rate * t_[k], variance = noise_variance(s_.noise, expected),
                     off = s_.codes[k][p] - expected;
        chi_square += off * off / variance, information += t_[k] * t_[k] / variance, sum += t_[k] * off / variance;
      }
      const double freedom = static_cast<double>(used.size()) - 1;
      if (leave_moved_out && stats::chi2_upper(chi_square, freedom) < least_p) continue;
      chi_square_ += chi_square, freedom_ += freedom, ++pixels_;
      for (const std::size_t k : used) {
        const double expected = rate * t_[k], weight = 1 / noise_variance(s_.noise, expected),
                     shared = weight * expected * t_[k];
        normal_(index(k), index(k)) += weight * expected * expected;
        right_[index(k)] += weight * expected * (s_.codes[k][p] - expected) - shared * sum / information;
        for (const std::size_t j : used)
          normal_(index(k), index(j)) -=
              shared * rate * t_[j] * t_[j] / noise_variance(s_.noise, rate * t_[j]) / information;
      }
    }
    choose();
  }

  // The unit is the exposure that says most; what says nothing beside it stays as stated.
  void choose() {
    Eigen::Index unit = 0;
    const double most = normal_.diagonal().maxCoeff(&unit);
    if (!chosen_) unit_ = static_cast<std::size_t>(unit), chosen_ = true;
    told_.clear();
    for (std::size_t k = 0; k < count_; ++k)
      if (k != unit_ && normal_(index(k), index(k)) > least_share * most) told_.push_back(k);
  }
  Eigen::MatrixXd kept_normal() const {
    Eigen::MatrixXd kept(index(told_.size()), index(told_.size()));
    for (std::size_t i = 0; i < told_.size(); ++i)
      for (std::size_t j = 0; j < told_.size(); ++j)
        kept(index(i), index(j)) = normal_(index(told_[i]), index(told_[j]));
    return kept;
  }
  void move() {
    if (told_.empty()) return;
    Eigen::VectorXd right(index(told_.size()));
    for (std::size_t i = 0; i < told_.size(); ++i) right[index(i)] = right_[index(told_[i])];
    const Eigen::VectorXd step = linear::solve_ldlt(kept_normal(), right);
    for (std::size_t i = 0; i < told_.size(); ++i) t_[told_[i]] *= 1 + std::clamp(step[index(i)], -0.3, 0.3);
  }

  ExposureSamples s_;
  std::size_t count_;
  std::vector<double> t_;
  Eigen::MatrixXd normal_;
  Eigen::VectorXd right_;
  std::vector<std::size_t> told_;  // exposures whose times are refined
  std::size_t unit_ = 0, pixels_ = 0;
  bool chosen_ = false;
  double chi_square_ = 0, freedom_ = 0;
};

}  // namespace

RefinedExposures refine_exposures(const ExposureSamples& samples) {
  return Refinement(samples).run();
}

namespace {

// Least squares of squared residuals over V = x / gain + read^2, weighted by 1 / (2 V^2), what Gaussian noise has.
struct Transfer {
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  std::size_t pixels = 0;
};

Transfer photon_transfer(const ExposureSamples& s) {
  Transfer sums;
  std::vector<std::size_t> used;
  for (std::size_t p = 0; p < s.codes[0].size(); ++p) {
    const double rate = rate_of(s, s.exposures_s, p, used);
    if (used.size() < 2) continue;
    double chi_square = 0, information = 0;
    for (const std::size_t k : used) {
      const double t = s.exposures_s[k], variance = noise_variance(s.noise, rate * t);
      information += t * t / variance, chi_square += std::pow(s.codes[k][p] - rate * t, 2) / variance;
    }
    if (stats::chi2_upper(chi_square, static_cast<double>(used.size()) - 1) < least_p) continue;
    ++sums.pixels;
    for (const std::size_t k : used) {
      const double t = s.exposures_s[k], expected = std::max(0.0, rate * t),
                   variance = noise_variance(s.noise, expected), left = 1 - t * t / variance / information;
      if (left < 0.02) continue;
      const double square = std::pow(s.codes[k][p] - rate * t, 2) / left;
      const Eigen::Vector2d by(expected, 1);
      const double weight = left / (2 * variance * variance);
      sums.normal += weight * by * by.transpose(), sums.right += weight * square * by;
    }
  }
  return sums;
}

}  // namespace

std::optional<StackNoise> noise_of_stack(ExposureSamples samples) {
  // Not below what no sensor has: noise without width weighs without limit.
  const double least_read = 0.05 * samples.noise.read, most_gain = 1e4 * samples.noise.gain;
  Eigen::Matrix2d covariance;
  for (int round = 0; round < 12; ++round) {
    const Transfer sums = photon_transfer(samples);
    if (sums.pixels < fewest_pixels) return {};
    const Eigen::Matrix2d& n = sums.normal;
    covariance << n(1, 1), -n(0, 1), -n(0, 1), n(0, 0);
    covariance /= n(0, 0) * n(1, 1) - n(0, 1) * n(0, 1);
    const Eigen::Vector2d found = covariance * sums.right;
    samples.noise.gain = 1 / std::max(found[0], 1 / most_gain);
    samples.noise.read = std::sqrt(std::max(found[1], least_read * least_read));
  }
  const manifest::Noise& n = samples.noise;
  return StackNoise{n, n.gain * n.gain * std::sqrt(covariance(0, 0)), std::sqrt(covariance(1, 1)) / (2 * n.read)};
}

}  // namespace gonio::photograph
