// See table_noise.h.
#include "explain/tables/table_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "stats/intervals.h"

namespace gonio::explain::tables {
namespace {

using Pairs = std::vector<std::pair<double, double>>;  // value, squared difference scaled to a variance

constexpr double median_of_chi2_1 = 0.454936423119572;
constexpr std::size_t bins = 10, fewest_pairs = 8;

// Rows of equal conditions within a group of the table, and further takes.
Pairs repeated_pairs(const Table& table, std::span<const double> y, std::span<const double> prediction,
                     const std::vector<std::vector<double>>& repeats, const std::vector<std::size_t>& conditions) {
  Pairs pairs;
  const std::size_t observed = table.observed.size();
  std::map<std::vector<double>, std::size_t> last;
  for (std::size_t r = 0; r < table.rows(); ++r) {
    std::vector<double> key;
    for (const std::size_t c : conditions) key.push_back(table.values[c][r]);
    const auto [entry, fresh] = last.try_emplace(key, r);
    for (std::size_t k = 0; !fresh && k < observed; ++k) {
      const double d = y[r * observed + k] - y[entry->second * observed + k];
      pairs.emplace_back(prediction[r * observed + k], 0.5 * d * d);
    }
    entry->second = r;
  }
  if (pairs.size() < std::max(fewest_pairs, table.rows() / 10)) pairs.clear();
  for (const std::vector<double>& take : repeats)
    for (std::size_t i = 0; i < take.size(); ++i) {
      const double d = take[i] - y[i];
      if (std::isfinite(d)) pairs.emplace_back(prediction[i], 0.5 * d * d);
    }
  return pairs;
}

// Second differences along an ordering in which `changing` varies fastest, the other conditions being equal or next.
Pairs neighbour_pairs(const Table& table, std::span<const double> y, std::span<const double> prediction,
                      const std::vector<std::size_t>& conditions, std::size_t changing) {
  std::vector<std::size_t> order(table.rows());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    for (const std::size_t c : conditions) {
      if (c == changing || table.values[c][a] == table.values[c][b]) continue;
      return table.values[c][a] < table.values[c][b];
    }
    return changing != Table::none && table.values[changing][a] < table.values[changing][b];
  });
  Pairs pairs;
  const std::size_t observed = table.observed.size();
  for (std::size_t k = 0; k < observed; ++k)
    for (std::size_t i = 1; i + 1 < order.size(); ++i) {
      const auto residual = [&](std::size_t place) {
        return y[order[place] * observed + k] - prediction[order[place] * observed + k];
      };
      const double d = residual(i - 1) - 2 * residual(i) + residual(i + 1);
      pairs.emplace_back(prediction[order[i] * observed + k], d * d / 6);
    }
  return pairs;
}

double typical(const Pairs& pairs) {
  std::vector<double> variance;
  for (const auto& [value, v] : pairs) variance.push_back(v);
  return stats::median(variance) / median_of_chi2_1;
}

// Along the ordering whose differences are smallest.
Pairs closest_pairs(const Table& table, std::span<const double> y, std::span<const double> prediction,
                    const std::vector<std::size_t>& conditions) {
  Pairs best = neighbour_pairs(table, y, prediction, conditions, Table::none);
  for (const std::size_t c : conditions) {
    Pairs pairs = neighbour_pairs(table, y, prediction, conditions, c);
    if (typical(pairs) < typical(best)) best = std::move(pairs);
  }
  return best;
}

// Non-negative least squares in three unknowns by coordinate descent, weights 1 / var^2 of the last round.
NoiseModel fitted(const std::vector<std::array<double, 2>>& points) {
  std::array<double, 3> a{};
  std::vector<double> weight;
  for (const auto& [m, v] : points) weight.push_back(1 / (v * v));
  for (int round = 0; round < 5; ++round) {
    for (int sweep = 0; sweep < 200; ++sweep)
      for (std::size_t j = 0; j < 3; ++j) {
        double above = 0, below = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
          const double m = points[i][0];
          const std::array<double, 3> basis = {1, m, m * m};
          const double others = a[0] + a[1] * basis[1] + a[2] * basis[2] - a[j] * basis[j];
          above += weight[i] * basis[j] * (points[i][1] - others);
          below += weight[i] * basis[j] * basis[j];
        }
        a[j] = below > 0 ? std::max(0.0, above / below) : 0;
      }
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double m = points[i][0], v = std::max(a[0] + a[1] * m + a[2] * m * m, 1e-300);
      weight[i] = 1 / (v * v);
    }
  }
  return {a[0], a[1], a[2], {}, false};
}

}  // namespace

double NoiseModel::sigma(double value) const {
  const double m = std::abs(value);
  return std::sqrt(read2 + shot * m + share2 * m * m);
}

NoiseModel fit_noise(Pairs pairs) {
  for (auto& [value, v] : pairs) value = std::abs(value);
  std::stable_sort(pairs.begin(), pairs.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  const double scale = pairs.empty() || pairs.back().first == 0 ? 1 : pairs.back().first;
  const double everywhere = typical(pairs) / (scale * scale);
  if (!(everywhere > 0)) return {};
  std::vector<std::array<double, 2>> points;
  const std::size_t parts = std::min(bins, std::max<std::size_t>(1, pairs.size() / 8));
  for (std::size_t b = 0; b < parts; ++b) {
    const auto first = pairs.begin() + static_cast<std::ptrdiff_t>(b * pairs.size() / parts);
    const auto last = pairs.begin() + static_cast<std::ptrdiff_t>((b + 1) * pairs.size() / parts);
    double m = 0;
    for (auto p = first; p != last; ++p) m += p->first / static_cast<double>(last - first);
    const double v = typical(Pairs(first, last)) / (scale * scale);
    points.push_back({m / scale, std::max(v, 1e-6 * everywhere)});
  }
  NoiseModel model = fitted(points);
  model.read2 *= scale * scale;
  model.shot *= scale;
  return model;
}

double neighbour_scatter(const Table& table, std::span<const double> whitened,
                         const std::vector<std::size_t>& conditions) {
  const std::vector<double> nothing(whitened.size(), 0.0);
  return std::sqrt(typical(closest_pairs(table, whitened, nothing, conditions)));
}

NoiseModel table_noise(const Table& table, std::span<const double> observed, std::span<const double> prediction,
                       const std::vector<std::vector<double>>& repeats, const std::vector<std::size_t>& conditions) {
  const Pairs repeated = repeated_pairs(table, observed, prediction, repeats, conditions);
  NoiseModel model;
  if (!repeated.empty()) {
    model = fit_noise(repeated);
    model.how = "from " + std::to_string(repeated.size()) + " repeated observations";
  } else {
    Pairs best = closest_pairs(table, observed, prediction, conditions);
    model = fit_noise(std::move(best));
    model.how = "from differences between neighbouring rows";
    model.from_neighbours = true;
  }
  // Values without any scatter (a simulation) have the noise of their rounding.
  double square = 0;
  for (const double f : prediction) square += f * f / static_cast<double>(prediction.size());
  model.read2 = std::max(model.read2, 1e-18 * square + std::numeric_limits<double>::min());
  return model;
}

}  // namespace gonio::explain::tables
