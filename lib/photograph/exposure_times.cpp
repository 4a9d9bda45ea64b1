// See exposure_times.h.
#include "photograph/exposure_times.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "linear/solve.h"
#include "stats/distributions.h"

namespace gonio::photograph {
namespace {

constexpr int rounds = 5;
constexpr double clear_of_full = 4;         // standard deviations
constexpr double least_p = 1e-4;            // of a pixel's chi-square: below it something moved
constexpr double least_share = 1e-6;        // of the best exposure's information
constexpr std::size_t fewest_pixels = 100;  // to say anything

class Refinement {
 public:
  explicit Refinement(const ExposureSamples& s) : s_(s), count_(s.exposures_s.size()), t_(s.exposures_s) {}

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

  // The rate that one pixel's usable samples say, and which they are.
  double rate_of(std::size_t pixel, std::vector<std::size_t>& used) const {
    double light = 0, time = 0;
    for (std::size_t k = 0; k < count_; ++k)
      if (!std::isnan(s_.codes[k][pixel])) light += s_.codes[k][pixel], time += t_[k];
    double rate = time > 0 ? light / time : 0;
    for (int pass = 0; pass < 3; ++pass) {
      double sum = 0, information = 0;
      used.clear();
      for (std::size_t k = 0; k < count_; ++k) {
        const double expected = rate * t_[k], variance = s_.noise.variance(expected);
        if (std::isnan(s_.codes[k][pixel]) || expected + clear_of_full * std::sqrt(variance) > s_.full_scale) continue;
        sum += t_[k] * s_.codes[k][pixel] / variance, information += t_[k] * t_[k] / variance;
        used.push_back(k);
      }
      if (information > 0) rate = sum / information;
    }
    return rate;
  }

  // Normal equations for d, each pixel's rate eliminated.
  void gather(bool leave_moved_out) {
    normal_ = Eigen::MatrixXd::Zero(index(count_), index(count_));
    right_ = Eigen::VectorXd::Zero(index(count_));
    chi_square_ = freedom_ = 0, pixels_ = 0;
    std::vector<std::size_t> used;
    for (std::size_t p = 0; p < s_.codes[0].size(); ++p) {
      const double rate = rate_of(p, used);
      if (used.size() < 2 || !(rate > 0)) continue;
      double chi_square = 0, information = 0, sum = 0;
      for (const std::size_t k : used) {
        const double expected = rate * t_[k], variance = s_.noise.variance(expected), off = s_.codes[k][p] - expected;
        chi_square += off * off / variance, information += t_[k] * t_[k] / variance, sum += t_[k] * off / variance;
      }
      const double freedom = static_cast<double>(used.size()) - 1;
      if (leave_moved_out && stats::chi2_upper(chi_square, freedom) < least_p) continue;
      chi_square_ += chi_square, freedom_ += freedom, ++pixels_;
      for (const std::size_t k : used) {
        const double expected = rate * t_[k], weight = 1 / s_.noise.variance(expected),
                     shared = weight * expected * t_[k];
        normal_(index(k), index(k)) += weight * expected * expected;
        right_[index(k)] += weight * expected * (s_.codes[k][p] - expected) - shared * sum / information;
        for (const std::size_t j : used)
          normal_(index(k), index(j)) -= shared * rate * t_[j] * t_[j] / s_.noise.variance(rate * t_[j]) / information;
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

  const ExposureSamples& s_;
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

}  // namespace gonio::photograph
