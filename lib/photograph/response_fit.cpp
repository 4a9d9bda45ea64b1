// See response_fit.h.
#include "photograph/response_fit.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "linear/solve.h"
#include "photograph/response_curve.h"
#include "stats/distributions.h"
#include "stats/intervals.h"

namespace gonio::photograph {
namespace {

constexpr int rounds = 40, rounds_of_start = 6;
constexpr double start_low = 8, start_high = 247;  // readings that count at the start
constexpr double lowest = 0.5, highest = 254.5, clear_of_ends = 3;
constexpr double least_p = 1e-4;  // of a patch's chi-square: below it something moved
constexpr std::size_t fewest_patches = 50, bins = 8;
constexpr double least_variance = 1e-3;  // codes^2
constexpr double bend_sigma = 1;         // of second differences of q's coefficients: weak
constexpr double longest_step = 0.7, settled = 1e-4;
constexpr double prior_times = 2;  // what `shutter_sigma` counts, in exposures

class Channel {
 public:
  Channel(const std::vector<ResponsePatch>& patches, const std::vector<double>& log_times)
      : patches_(patches), log_times_(log_times), light_(patches.size()), state_(patches.size()) {
    variance_.fill(1);
  }

  ResponseCurveShape shape;

  // The light of each patch, and which of its readings count.
  void place(const Eigen::VectorXd& off, bool start) {
    for (std::size_t p = 0; p < patches_.size(); ++p) {
      State& s = state_[p];
      if (start || s.used.empty()) begin(p, off);
      for (int pass = 0; pass < 4 && !s.used.empty(); ++pass) {
        double sum = 0, information = 0;
        for (const std::size_t k : s.used) {
          const double code = expected(p, k, off), a = 1 / shape.slope(code), w = 1 / variance(code);
          sum += w * a * (patches_[p].readings[k].code - code), information += w * a * a;
        }
        light_[p] += std::clamp(sum / information, -1.0, 1.0);
        if (pass == 0 && !start) choose(p, off);
      }
    }
  }

  // Adds to the normal equations of q's coefficients and the times, lights eliminated.
  void gather(const Eigen::VectorXd& off, bool drop, Eigen::MatrixXd& normal, Eigen::VectorXd& right) {
    const Eigen::Index m = ResponseCurveShape::terms, n = m + index(log_times_.size());
    normal = Eigen::MatrixXd::Zero(n, n), right = Eigen::VectorXd::Zero(n);
    chi_square_ = freedom_ = 0, told_ = dropped_ = 0;
    squares_.fill(0), counts_.fill(0);
    for (std::size_t p = 0; p < patches_.size(); ++p) {
      const State& s = state_[p];
      if (s.used.size() < 2) continue;
      Eigen::MatrixXd own = Eigen::MatrixXd::Zero(n, n);
      Eigen::VectorXd shared = Eigen::VectorXd::Zero(n), own_right = Eigen::VectorXd::Zero(n);
      double information = 0, chi_square = 0;
      for (const std::size_t k : s.used) {
        const double code = expected(p, k, off), a = 1 / shape.slope(code), w = 1 / variance(code),
                     left = patches_[p].readings[k].code - code;
        Eigen::VectorXd row = Eigen::VectorXd::Zero(n);
        row.head(m) = -a * shape.gradient(code);
        row[m + index(patches_[p].readings[k].time)] = a;
        own += w * row * row.transpose(), shared += w * a * row, own_right += w * left * row;
        information += w * a * a, chi_square += w * left * left;
      }
      const double free = static_cast<double>(s.used.size()) - 1;
      if (drop && stats::chi2_upper(chi_square, free) < least_p) {
        ++dropped_;
        continue;
      }
      ++told_, chi_square_ += chi_square, freedom_ += free;
      normal += own - shared * shared.transpose() / information, right += own_right;
      count(p, off, information);
    }
  }

  // What codes scatter by, from squares that the patches' own lights have left of them.
  void learn_noise() {
    double all = 0, count = 0;
    for (std::size_t b = 0; b < bins; ++b) all += squares_[b], count += counts_[b];
    for (std::size_t b = 0; b < bins; ++b)
      variance_[b] = std::max(least_variance, (squares_[b] + 10 * all / count) / (counts_[b] + 10));
  }

  double chi_square() const { return chi_square_; }
  double freedom() const { return freedom_; }
  std::size_t told() const { return told_; }

  ResponseCurve described() const {
    ResponseCurve c;
    std::vector<double> codes, sigmas;
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(index(log_times_.size()));
    for (std::size_t p = 0; p < patches_.size(); ++p)
      for (const std::size_t k : state_[p].used)
        if (state_[p].used.size() > 1) codes.push_back(expected(p, k, none)), sigmas.push_back(sigma(codes.back()));
    c.lowest = stats::quantile(codes, 0.005) / 255, c.highest = stats::quantile(codes, 0.995) / 255;
    c.noise = stats::median(sigmas), c.patches = told_, c.dropped = dropped_;
    return c;
  }

 private:
  struct State {
    std::vector<std::size_t> used;  // readings
  };
  static Eigen::Index index(std::size_t i) { return static_cast<Eigen::Index>(i); }
  double variance(double code) const {
    const double at = std::clamp(code / 255 * bins - 0.5, 0.0, bins - 1.0);
    const auto below = std::min(static_cast<std::size_t>(at), bins - 2);
    const double share = at - static_cast<double>(below);
    return variance_[below] * (1 - share) + variance_[below + 1] * share;
  }
  double sigma(double code) const { return std::sqrt(variance(code)); }
  double expected(std::size_t p, std::size_t k, const Eigen::VectorXd& off) const {
    const std::size_t time = patches_[p].readings[k].time;
    return shape.code(light_[p] + log_times_[time] + off[index(time)]);
  }

  void begin(std::size_t p, const Eigen::VectorXd& off) {
    State& s = state_[p];
    s.used.clear();
    double sum = 0, weight = 0;
    for (std::size_t k = 0; k < patches_[p].readings.size(); ++k) {
      const auto& [time, code] = patches_[p].readings[k];
      if (code < start_low || code > start_high) continue;
      const double w = std::pow(shape.slope(code), -2);
      sum += w * (shape.value(code) - log_times_[time] - off[index(time)]), weight += w;
      s.used.push_back(k);
    }
    if (weight > 0) light_[p] = sum / weight;
  }
  void choose(std::size_t p, const Eigen::VectorXd& off) {
    State& s = state_[p];
    s.used.clear();
    for (std::size_t k = 0; k < patches_[p].readings.size(); ++k) {
      const double code = expected(p, k, off), margin = clear_of_ends * std::max(0.5, sigma(code));
      if (code - margin > lowest && code + margin < highest) s.used.push_back(k);
    }
  }
  void count(std::size_t p, const Eigen::VectorXd& off, double information) {
    for (const std::size_t k : state_[p].used) {
      const double code = expected(p, k, off), a = 1 / shape.slope(code), w = 1 / variance(code);
      const auto b = static_cast<std::size_t>(std::clamp(code / 255 * bins, 0.0, bins - 1.0));
      squares_[b] += std::pow(patches_[p].readings[k].code - code, 2), counts_[b] += 1 - w * a * a / information;
    }
  }

  const std::vector<ResponsePatch>& patches_;
  const std::vector<double>& log_times_;
  std::vector<double> light_;  // log
  std::vector<State> state_;
  std::array<double, bins> variance_{}, squares_{}, counts_{};  // codes^2
  double chi_square_ = 0, freedom_ = 0;
  std::size_t told_ = 0, dropped_ = 0;
};

class Finding {
 public:
  Finding(const ResponseData& data, double shutter_sigma) : data_(data), shutter_(shutter_sigma) {
    if (data.times_s.size() < 2)
      throw Error(Exit::data, "exposures", "are all of one time", "two exposure times at least, better five");
    for (const double t : data.times_s) log_times_.push_back(std::log(t));
    off_ = Eigen::VectorXd::Zero(index(log_times_.size()));
    for (const auto& patches : data.patches) channels_.emplace_back(patches, log_times_);
    width_ = shutter_;
  }

  FoundResponse run() {
    for (int round = 0; round < rounds; ++round) {
      const bool start = round < rounds_of_start;
      for (Channel& c : channels_) c.place(off_, start);
      gather(!start);
      if (round == rounds - 1) break;
      const double step = move();
      if (step < settled && round > 2 * rounds_of_start) round = rounds - 2;
      if (round > 1)
        for (Channel& c : channels_) c.learn_noise();
      if (!start) widen();
    }
    return described();
  }

 private:
  static Eigen::Index index(std::size_t i) { return static_cast<Eigen::Index>(i); }
  static constexpr Eigen::Index m = ResponseCurveShape::terms;
  Eigen::Index times_at() const { return m * index(channels_.size()); }

  void gather(bool drop) {
    const Eigen::Index times = index(log_times_.size()), n = times_at() + times;
    normal_ = Eigen::MatrixXd::Zero(n, n), right_ = Eigen::VectorXd::Zero(n);
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      Eigen::MatrixXd normal;
      Eigen::VectorXd right;
      channels_[c].gather(off_, drop, normal, right);
      if (channels_[c].told() < fewest_patches)
        throw Error(Exit::data, "exposures",
                    format("have %zu places whose %s two of them tell between darkest and brightest code",
                           channels_[c].told(), data_.channels[c].c_str()),
                    "exposures a factor of two to four apart, of a view with dark and bright parts that are smooth");
      const Eigen::Index at = m * index(c);
      normal_.block(at, at, m, m) = normal.topLeftCorner(m, m);
      normal_.block(at, times_at(), m, times) = normal.topRightCorner(m, times);
      normal_.block(times_at(), at, times, m) = normal.bottomLeftCorner(times, m);
      normal_.block(times_at(), times_at(), times, times) += normal.bottomRightCorner(times, times);
      right_.segment(at, m) += right.head(m), right_.tail(times) += right.tail(times);
      add_smoothness(at, channels_[c].shape.coefficients());
    }
    const double prior = 1 / std::max(1e-12, width_ * width_);
    for (Eigen::Index j = 0; j < times; ++j)
      normal_(times_at() + j, times_at() + j) += prior, right_[times_at() + j] -= prior * off_[j];
  }
  void add_smoothness(Eigen::Index at, const Eigen::VectorXd& q) {
    constexpr double weight = 1 / (bend_sigma * bend_sigma);
    for (Eigen::Index i = 0; i + 2 < m; ++i) {
      const Eigen::Vector3d by(1, -2, 1);
      normal_.block(at + i, at + i, 3, 3) += weight * by * by.transpose();
      right_.segment(at + i, 3) -= weight * by.dot(q.segment(i, 3)) * by;
    }
  }

  double move() {  // its largest step
    Eigen::VectorXd step = linear::Ldlt(normal_).solve(right_);
    const double most = step.cwiseAbs().maxCoeff();
    if (most > longest_step) step *= longest_step / most;
    for (std::size_t c = 0; c < channels_.size(); ++c)
      channels_[c].shape.set(channels_[c].shape.coefficients() + step.segment(m * index(c), m));
    off_ += step.tail(off_.size());
    return most;
  }
  // The prior of the times, by what they turned out to be off; offset and slope over log time are not told.
  void widen() {
    if (shutter_ == 0) return;
    const double free = static_cast<double>(log_times_.size()) - 2;
    width_ = std::sqrt((prior_times * shutter_ * shutter_ + off_.squaredNorm()) / (prior_times + free));
  }

  FoundResponse described() {
    FoundResponse found;
    const Eigen::MatrixXd covariance =
        linear::Ldlt(normal_).solve(Eigen::MatrixXd(Eigen::MatrixXd::Identity(normal_.rows(), normal_.cols())));
    double chi_square = 0, freedom = 0;
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      ResponseCurve curve = channels_[c].described();
      curve.channel = data_.channels[c];
      curve.rows = rows_of(channels_[c].shape, covariance.block(m * index(c), m * index(c), m, m), 255 * curve.lowest,
                           255 * curve.highest);
      found.curves.push_back(std::move(curve));
      chi_square += channels_[c].chi_square(), freedom += channels_[c].freedom();
    }
    found.chi_square_per_freedom = chi_square / std::max(1.0, freedom - static_cast<double>(normal_.rows()));
    const Eigen::MatrixXd of_times = covariance.bottomRightCorner(off_.size(), off_.size());
    Eigen::VectorXd along = Eigen::Map<const Eigen::VectorXd>(log_times_.data(), off_.size());
    along.array() -= along.mean();
    for (Eigen::Index j = 0; j < off_.size(); ++j) {
      const double stated = data_.times_s[static_cast<std::size_t>(j)], t = stated * std::exp(off_[j]);
      found.times_s.push_back(shutter_ > 0 ? t : stated);
      found.times_sigma.push_back(shutter_ > 0 ? t * std::sqrt(of_times(j, j)) : 0);
    }
    if (shutter_ > 0) found.exponent_sigma = std::sqrt(along.dot(of_times * along)) / along.squaredNorm();
    return found;
  }

  const ResponseData& data_;
  double shutter_, width_ = 0;
  std::vector<double> log_times_;
  std::vector<Channel> channels_;
  Eigen::VectorXd off_, right_;
  Eigen::MatrixXd normal_;
};

}  // namespace

FoundResponse find_response(const ResponseData& data, double shutter_sigma) {
  return Finding(data, shutter_sigma).run();
}

}  // namespace gonio::photograph
