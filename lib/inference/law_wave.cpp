// See law_wave.h.
#include "inference/law_wave.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <set>

#include "linear/qr.h"
#include "linear/symmetric_eigen.h"
#include "stats/distributions.h"
#include "stats/intervals.h"

namespace gonio::inference {
namespace {

constexpr double least_periods = 3, most_periods = 150;  // in the range
constexpr double values_of_a_period = 3;                 // that differ, at least
constexpr double steps = 4;                              // of a resolved frequency
constexpr std::size_t waves_at_once = 24;                // bounds the memory
constexpr int fine_steps = 24;                           // on either side of the best, a resolved frequency wide
constexpr double least_survivor = 1e-3;                  // of a wave's squared length, after projection

std::vector<Term> wave(std::size_t condition, double frequency) {
  const double scale = 1 / (2 * std::numbers::pi * frequency);
  return {{{}, "cos", condition, scale, true, condition, 0}, {{}, "sin", condition, scale, true, condition, 0}};
}

// Projected columns of several waves, two for each, and the residual. Each wave's angles are those of the one before,
// turned on by what their frequencies differ: they are equally spaced but for a few, so that one turn does for all. A
// few dozen turns, each as exact as a sine.
Eigen::MatrixXd projected_waves(const LawData& data, std::size_t condition, const std::vector<double>& frequencies) {
  const std::vector<double>& values = data.system().observations().conditions[condition].values;
  RawColumns columns;
  columns.reserve(2 * frequencies.size());
  for (const Term& t : wave(condition, frequencies[0])) columns.push_back(column_of(data.system(), t));
  std::vector<double> cosine(values.size(), 1.0), sine(values.size(), 0.0);
  double turn = 0;
  for (std::size_t k = 1; k < frequencies.size(); ++k) {
    const double further = frequencies[k] - frequencies[k - 1];
    if (!(std::abs(further - turn) <= 1e-14 * frequencies[k])) {
      turn = further;
      for (std::size_t i = 0; i < values.size(); ++i)
        if (const double angle = 2 * std::numbers::pi * turn * values[i]; std::isfinite(angle))
          cosine[i] = std::cos(angle), sine[i] = std::sin(angle);
    }
    const std::vector<double>&c = columns[2 * k - 2], &s = columns[2 * k - 1];
    std::vector<double> next_c(c.size()), next_s(c.size());
    for (std::size_t i = 0; i < c.size(); ++i) {
      next_c[i] = c[i] * cosine[i] - s[i] * sine[i];
      next_s[i] = s[i] * cosine[i] + c[i] * sine[i];
    }
    columns.push_back(std::move(next_c));
    columns.push_back(std::move(next_s));
  }
  return data.projected(columns);
}

// Fall of chi-square by the k-th wave on the rows of `mask`.
double fall_of(const Eigen::MatrixXd& projected, std::size_t k, const Mask& mask) {
  Eigen::Matrix2d gram = Eigen::Matrix2d::Zero();
  Eigen::Vector2d score = Eigen::Vector2d::Zero();
  const auto first = static_cast<Eigen::Index>(2 * k);
  for (Eigen::Index i = 0; i < projected.rows(); ++i) {
    if (!mask.empty() && !mask[static_cast<std::size_t>(i)]) continue;
    const Eigen::Vector2d c = projected.row(i).segment<2>(first).transpose();
    gram += c * c.transpose();
    score += c * projected(i, projected.cols() - 1);
  }
  const linear::SymmetricEigen<Eigen::Matrix2d> eigen(gram);
  double fall = 0;
  for (Eigen::Index d = 0; d < 2; ++d)
    if (eigen.eigenvalues()[d] > least_survivor * eigen.eigenvalues()[1])
      fall += std::pow(eigen.eigenvectors().col(d).dot(score), 2) / eigen.eigenvalues()[d];
  return fall;
}

struct Found {
  std::size_t condition = 0;
  double frequency = 0, resolved = 0, fall = 0;
  std::size_t looks = 0;
};

// The best of all frequencies of one condition.
Found best_frequency(const LawData& data, std::size_t condition) {
  Found found{condition, 0, 0, 0, 0};
  const ConditionKind kind = kind_of(data.system(), condition);
  if (!kind.usable || kind.periodic) return found;
  std::set<double> values;
  for (const double v : data.system().observations().conditions[condition].values)
    if (std::isfinite(v)) values.insert(v);
  found.resolved = 1 / (kind.upper - kind.lower);
  const double most = std::min(most_periods, static_cast<double>(values.size()) / values_of_a_period);
  std::vector<double> frequencies;
  for (double n = least_periods; n <= most; n += 1 / steps) frequencies.push_back(n * found.resolved);
  for (std::size_t first = 0; first < frequencies.size(); first += waves_at_once) {
    const std::vector<double> some(
        frequencies.begin() + static_cast<std::ptrdiff_t>(first),
        frequencies.begin() + static_cast<std::ptrdiff_t>(std::min(frequencies.size(), first + waves_at_once)));
    const Eigen::MatrixXd projected = projected_waves(data, condition, some);
    for (std::size_t k = 0; k < some.size(); ++k)
      if (const double fall = fall_of(projected, k, {}); fall > found.fall)
        found.fall = fall, found.frequency = some[k];
  }
  found.looks = frequencies.size();
  return found;
}

// Frequencies about the best one and their projected columns.
struct Tuning {
  std::size_t condition = 0;
  std::vector<double> frequencies;
  Eigen::MatrixXd projected;
  double at(const Mask& mask) const {
    std::size_t best = frequencies.size() / 2;
    double most = fall_of(projected, best, mask);
    for (std::size_t k = 0; k < frequencies.size(); ++k)
      if (const double fall = fall_of(projected, k, mask); fall > most) most = fall, best = k;
    return frequencies[best];
  }
};

Tuning tuning(const LawData& data, std::size_t condition, double centre, double reach, double lower) {
  Tuning t{condition, {}, {}};
  for (int k = -fine_steps; k <= fine_steps; ++k)
    t.frequencies.push_back(std::max(lower, centre + reach * k / fine_steps));
  t.projected = projected_waves(data, condition, t.frequencies);
  return t;
}

// Chance of such a wave without one: Wald with the sandwich over blocks, the period being a third number.
double chance(const LawData& data, const std::vector<Term>& terms, std::size_t looks) {
  RawColumns columns;
  for (const Term& t : terms) columns.push_back(column_of(data.system(), t));
  const Eigen::VectorXd c = data.coefficients(columns, {});
  const double statistic = c.dot(linear::LeastNorm(data.covariance(columns, c)).solve(c));
  return stats::sidak(stats::chi2_upper(statistic, 3), static_cast<double>(looks));
}

}  // namespace

Wave find_wave(const LawData& data, const std::vector<std::size_t>& conditions, double level) {
  Found best;
  std::size_t looks = 0;
  for (const std::size_t c : conditions) {
    const Found found = best_frequency(data, c);
    looks += found.looks;
    if (found.fall > best.fall) best = found;
  }
  if (!(best.fall > 0)) return {};
  const double lower = least_periods * best.resolved;
  const auto about_it = [&](double centre, double reach) { return tuning(data, best.condition, centre, reach, lower); };
  const double near = about_it(best.frequency, best.resolved / steps).at({});
  const double frequency = about_it(near, best.resolved / (steps * fine_steps)).at({});
  if (!(frequency > lower)) return {};  // a longer wave would serve better
  Wave result{wave(best.condition, frequency), 0, {}};
  if (chance(data, result.terms, looks) > level) return {};
  const auto about = std::make_shared<Tuning>(about_it(frequency, best.resolved));
  result.fall = fall_of(about->projected, about->frequencies.size() / 2, {});
  result.tuned = [about](const Mask& mask) { return wave(about->condition, about->at(mask)); };
  return result;
}

}  // namespace gonio::inference
