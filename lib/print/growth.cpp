// See growth.h.
#include "print/growth.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "linear/solve.h"
#include "optim/least_squares.h"
#include "stats/sign_flip.h"

namespace gonio::print {
namespace {

constexpr double um = 1e-6;
constexpr std::size_t least_greys = 5, least_growing = 3, least_repetitions = 4;

// x: alpha and beta in um, gamma.
GrowthLaw law_of(const Eigen::VectorXd& x) {
  return {x[0] * um, x[1] * um, x[2]};
}

class Growth final : public optim::Model {
 public:
  Growth(const PrintedGradient& printed, const std::vector<double>& means_m, const std::vector<double>& sigmas_m)
      : greys_(printed.greys), means_m_(means_m), sigmas_m_(sigmas_m) {}
  bool residuals(const Eigen::VectorXd& x, Eigen::VectorXd& r) const override {
    const GrowthLaw law = law_of(x);
    if (!(law.beta_m > 0)) return false;
    r.resize(static_cast<Eigen::Index>(greys_.size()));
    for (std::size_t i = 0; i < greys_.size(); ++i)
      r[static_cast<Eigen::Index>(i)] = (law.height_m(greys_[i]) - means_m_[i]) / sigmas_m_[i];
    return r.allFinite();
  }
  Eigen::MatrixXd slopes(const Eigen::VectorXd& x, const Eigen::VectorXd&) const override {
    const GrowthLaw law = law_of(x);
    Eigen::MatrixXd j(static_cast<Eigen::Index>(greys_.size()), 3);
    for (std::size_t i = 0; i < greys_.size(); ++i) {
      const std::array<double, 3> s = law.slopes(greys_[i]);
      const auto row = static_cast<Eigen::Index>(i);
      j(row, 0) = s[0] * um / sigmas_m_[i], j(row, 1) = s[1] * um / sigmas_m_[i], j(row, 2) = s[2] / sigmas_m_[i];
    }
    return j;
  }

 private:
  const std::vector<double>& greys_;
  const std::vector<double>&means_m_, &sigmas_m_;
};

void check(const PrintedGradient& printed, const char* place) {
  const std::vector<double>& greys = printed.greys;
  if (greys.size() < least_greys)
    throw Error(Exit::data, place, format("has %zu grey values", greys.size()), "print five or more");
  for (std::size_t i = 0; i < greys.size(); ++i)
    if (!(greys[i] >= 0 && greys[i] <= 1) || (i > 0 && !(greys[i] > greys[i - 1])))
      throw Error(Exit::data, place, format("grey value %zu is %g", i + 1, greys[i]),
                  "give them from 0 to 1, each above the one before");
  if (printed.repetitions_m.size() < least_repetitions)
    throw Error(Exit::data, place, format("was printed %zu times", printed.repetitions_m.size()),
                "print the gradient four times or more: their scatter is the fit's noise");
  for (std::size_t r = 0; r < printed.repetitions_m.size(); ++r)
    if (printed.repetitions_m[r].size() != greys.size())
      throw Error(Exit::data, place,
                  format("repetition %zu has %zu heights for %zu grey values", r + 1, printed.repetitions_m[r].size(),
                         greys.size()),
                  "measure every field of every repetition");
}

struct Means {
  std::vector<double> mean_m, sigma_m;
};
// Scatter of a field by all repetitions, joined with that of all fields: few repetitions know their own badly.
Means means_of(const PrintedGradient& printed) {
  const std::size_t levels = printed.greys.size();
  const auto n = static_cast<double>(printed.repetitions_m.size());
  Means m{std::vector<double>(levels), std::vector<double>(levels)};
  std::vector<double> variance(levels);
  double pooled = 0;
  for (std::size_t i = 0; i < levels; ++i) {
    for (const std::vector<double>& r : printed.repetitions_m) m.mean_m[i] += r[i] / n;
    for (const std::vector<double>& r : printed.repetitions_m)
      variance[i] += (r[i] - m.mean_m[i]) * (r[i] - m.mean_m[i]) / (n - 1);
    pooled += variance[i] / static_cast<double>(levels);
  }
  constexpr double least = 1e-10;  // of a height: exact heights weigh alike
  for (std::size_t i = 0; i < levels; ++i)
    m.sigma_m[i] = std::sqrt(std::max(((n - 1) * variance[i] + 4 * pooled) / (n + 3), least * least) / n);
  return m;
}

// Nothing is known of gamma: a scan, with alpha and beta by straight lines through what grows.
Eigen::VectorXd first_guess(const PrintedGradient& printed, const Means& means, const char* place) {
  const std::vector<double>& greys = printed.greys;
  const double top = *std::ranges::max_element(means.mean_m);
  std::vector<std::size_t> grows;
  for (std::size_t i = 0; i < greys.size(); ++i)
    if (means.mean_m[i] > std::max(0.05 * top, 3 * means.sigma_m[i])) grows.push_back(i);
  if (grows.size() < least_growing)
    throw Error(Exit::data, place, format("grew at %zu grey values", grows.size()),
                "expose longer: three or more must grow");
  Eigen::VectorXd best(3);
  double least = std::numeric_limits<double>::infinity();
  for (double gamma = -0.5; gamma < greys[grows[0]] - 1e-4; gamma += 0.005) {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0, left = 0;
    for (const std::size_t i : grows) {
      const double l = std::log(greys[i] - gamma), h = means.mean_m[i] / um;
      n += 1, x += l, y += h, xx += l * l, xy += l * h;
    }
    const double beta = (n * xy - x * y) / (n * xx - x * x), alpha = (y - beta * x) / n;
    if (!(beta > 0)) continue;
    for (const std::size_t i : grows)
      left += std::pow(alpha + beta * std::log(greys[i] - gamma) - means.mean_m[i] / um, 2);
    if (left < least) least = left, best << alpha, beta, gamma;
  }
  if (!std::isfinite(least))
    throw Error(Exit::data, place, "heights do not rise with grey values", "are bright and dark exchanged?");
  return best;
}

// Chance of what the means leave about the law, along smooth curves of the level's rank that the law cannot follow.
double lack_of_fit(const PrintedGradient& printed, const GrowthLaw& law, const Eigen::MatrixXd& whitened_slopes,
                   const std::vector<double>& sigmas_m) {
  const auto levels = static_cast<Eigen::Index>(printed.greys.size());
  const std::size_t blocks = printed.repetitions_m.size();
  const Eigen::Index wanted = std::min<Eigen::Index>({6, levels - 3, static_cast<Eigen::Index>(blocks) / 3});
  std::vector<Eigen::VectorXd> basis;
  const auto add = [&](Eigen::VectorXd v) {
    const double before = v.norm();
    for (int pass = 0; pass < 2; ++pass)
      for (const Eigen::VectorXd& b : basis) v -= b.dot(v) * b;
    if (v.norm() > 1e-6 * before) basis.push_back(v.normalized());
  };
  for (Eigen::Index k = 0; k < 3; ++k) add(whitened_slopes.col(k));
  const std::size_t tangents = basis.size();
  for (Eigen::Index degree = 0; static_cast<Eigen::Index>(basis.size() - tangents) < wanted && degree < levels;
       ++degree) {
    Eigen::VectorXd v(levels);
    for (Eigen::Index i = 0; i < levels; ++i)
      v[i] = std::cos(static_cast<double>(degree) * std::acos(-1.0) * (static_cast<double>(i) + 0.5) /
                      static_cast<double>(levels));
    add(v);
  }
  stats::ScoreFamily family;
  family.directions = basis.size() - tangents;
  if (family.directions == 0) return 1;
  for (const std::vector<double>& r : printed.repetitions_m)
    for (std::size_t k = tangents; k < basis.size(); ++k) {
      double sum = 0;
      for (Eigen::Index i = 0; i < levels; ++i) {
        const auto l = static_cast<std::size_t>(i);
        sum += basis[k][i] * (r[l] - law.height_m(printed.greys[l])) / sigmas_m[l];
      }
      family.contributions.push_back(sum);
    }
  constexpr int draws = 1999;
  constexpr std::uint64_t seed = 31;
  return stats::sign_flip_test({family}, blocks, 1, draws, seed).global_p;
}

// What each repetition alone would do to the numbers: their scatter is the covariance.
std::array<std::array<double, 3>, 3> by_repetitions(const PrintedGradient& printed, const Means& means,
                                                    const Eigen::MatrixXd& j) {
  const Eigen::MatrixXd information = j.transpose() * j;
  const Eigen::MatrixXd influence = linear::inverse(Eigen::Matrix3d(information)) * j.transpose();
  const auto n = static_cast<double>(printed.repetitions_m.size());
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const std::vector<double>& r : printed.repetitions_m) {
    Eigen::VectorXd d(j.rows());
    for (Eigen::Index i = 0; i < j.rows(); ++i) {
      const auto l = static_cast<std::size_t>(i);
      d[i] = (r[l] - means.mean_m[l]) / means.sigma_m[l];
    }
    const Eigen::Vector3d moved = influence * d;
    sum += moved * moved.transpose() / (n * (n - 1));
  }
  const double units[3] = {um, um, 1};
  std::array<std::array<double, 3>, 3> c{};
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b)
      c[a][b] = sum(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) * units[a] * units[b];
  return c;
}

}  // namespace

double GrowthLaw::threshold() const {
  return gamma + std::exp(-alpha_m / beta_m);
}

double GrowthLaw::height_m(double grey) const {
  if (!(grey > gamma)) return 0;
  const double height_m = alpha_m + beta_m * std::log(grey - gamma);
  // Beside the threshold, where rounding would decide, by the threshold itself; elsewhere the exponential is spared.
  const double close = 1e-9 * beta_m;
  return height_m > close || (height_m > -close && grey > threshold()) ? std::max(0.0, height_m) : 0;
}

double GrowthLaw::grey(double height_m) const {
  return height_m > 0 ? gamma + std::exp((height_m - alpha_m) / beta_m) : 0;
}

std::array<double, 3> GrowthLaw::slopes(double grey) const {
  if (!(grey > threshold())) return {};
  return {1, std::log(grey - gamma), -beta_m / (grey - gamma)};
}

GrowthTable::GrowthTable(std::vector<double> greys, std::vector<double> heights_m, std::span<const double> weights)
    : greys_(std::move(greys)), heights_m_(std::move(heights_m)), slopes_(greys_.size()) {
  struct Pool {
    double sum, weight;
    std::size_t size;
  };
  std::vector<Pool> pools;
  for (std::size_t i = 0; i < greys_.size(); ++i) {
    pools.push_back({heights_m_[i] * weights[i], weights[i], 1});
    while (pools.size() > 1 &&
           pools.back().sum / pools.back().weight < pools[pools.size() - 2].sum / pools[pools.size() - 2].weight) {
      const Pool last = pools.back();
      pools.pop_back();
      pools.back() = {pools.back().sum + last.sum, pools.back().weight + last.weight, pools.back().size + last.size};
    }
  }
  std::size_t at = 0;
  for (const Pool& p : pools)
    for (std::size_t k = 0; k < p.size; ++k) heights_m_[at++] = p.sum / p.weight;
  const std::size_t n = greys_.size();
  std::vector<double> secant(n > 1 ? n - 1 : 0);
  for (std::size_t i = 0; i + 1 < n; ++i) secant[i] = (heights_m_[i + 1] - heights_m_[i]) / (greys_[i + 1] - greys_[i]);
  // Harmonic means keep it rising (Fritsch & Butland 1984).
  for (std::size_t i = 1; i + 1 < n; ++i)
    slopes_[i] = secant[i - 1] > 0 && secant[i] > 0 ? 2 / (1 / secant[i - 1] + 1 / secant[i]) : 0;
  if (n > 1) slopes_[0] = secant[0], slopes_[n - 1] = secant[n - 2];
}

std::size_t GrowthTable::piece(double grey) const {
  const auto above = std::ranges::upper_bound(greys_, grey);
  return static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(above - greys_.begin() - 1, 0, static_cast<std::ptrdiff_t>(greys_.size()) - 2));
}

double GrowthTable::height_m(double grey) const {
  const double within = std::clamp(grey, greys_.front(), greys_.back());
  const std::size_t i = piece(within);
  const double width = greys_[i + 1] - greys_[i], t = (within - greys_[i]) / width, s = 1 - t;
  return heights_m_[i] * s * s * (1 + 2 * t) + heights_m_[i + 1] * t * t * (1 + 2 * s) +
         width * s * t * (slopes_[i] * s - slopes_[i + 1] * t);
}

std::optional<double> GrowthTable::grey(double height_m) const {
  if (height_m > heights_m_.back()) return std::nullopt;
  if (height_m <= heights_m_.front()) return greys_.front();
  double low = greys_.front(), high = greys_.back();
  while (high - low > 1e-12) {
    const double middle = (low + high) / 2;
    (this->height_m(middle) < height_m ? low : high) = middle;
  }
  return high;
}

std::array<double, 3> GrowthFit::sigma() const {
  return {std::sqrt(covariance[0][0]), std::sqrt(covariance[1][1]), std::sqrt(covariance[2][2])};
}

double GrowthFit::height_sigma_m(double grey) const {
  const std::array<double, 3> s = law.slopes(grey);
  double variance = 0;
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b) variance += s[a] * s[b] * covariance[a][b];
  return std::sqrt(std::max(0.0, variance));
}

GrowthFit fit_growth(const PrintedGradient& printed, const char* place) {
  check(printed, place);
  const Means means = means_of(printed);
  const Growth model(printed, means.mean_m, means.sigma_m);
  const optim::Fit fitted = optim::fit(model, first_guess(printed, means, place));
  if (!fitted.determined)
    throw Error(Exit::data, place, "does not tell alpha, beta and gamma apart", "print more grey values that grow");
  const Eigen::MatrixXd j = model.slopes(fitted.x, {});
  std::vector<double> weights;
  for (const double s : means.sigma_m) weights.push_back(1 / (s * s));
  GrowthFit result{.law = law_of(fitted.x),
                   .covariance = by_repetitions(printed, means, j),
                   .degrees = static_cast<double>(printed.repetitions_m.size()) - 1,
                   .means_m = means.mean_m,
                   .mean_sigmas_m = means.sigma_m,
                   .table = GrowthTable(printed.greys, means.mean_m, weights)};
  result.lack_of_fit_p = lack_of_fit(printed, result.law, j, means.sigma_m);
  for (std::size_t i = 0; i < printed.greys.size(); ++i)
    result.rms_m += std::pow(result.law.height_m(printed.greys[i]) - means.mean_m[i], 2) /
                    static_cast<double>(printed.greys.size());
  result.rms_m = std::sqrt(result.rms_m);
  return result;
}

}  // namespace gonio::print
