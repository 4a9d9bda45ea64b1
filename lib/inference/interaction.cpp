// See interaction.h.
#include "inference/interaction.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "inference/law_data.h"
#include "stats/distributions.h"
#include "stats/intervals.h"

namespace gonio::inference {
namespace {

constexpr std::size_t columns_at_once = 48;  // bounds the memory
constexpr double least_survivor = 0.02;      // of a column's length, after projection
constexpr std::size_t least_blocks = 16;     // fewer cannot carry a small chance

// Ranks from -1 to 1 among the rows in use; zero where the condition does not apply. Equal values share a rank.
std::vector<double> ranks_of(const System& system, const Condition& condition) {
  std::vector<std::size_t> rows;
  for (const std::size_t g : system.groups)
    for (std::size_t i = system.observations().first[g]; i < system.observations().first[g + 1]; ++i)
      if (system.weight(i) > 0 && std::isfinite(condition.values[i])) rows.push_back(i);
  std::sort(rows.begin(), rows.end(), [&](std::size_t a, std::size_t b) {
    return condition.values[a] != condition.values[b] ? condition.values[a] < condition.values[b] : a < b;
  });
  std::vector<double> rank(condition.values.size(), 0.0);
  for (std::size_t first = 0; first < rows.size();) {
    std::size_t last = first;
    while (last < rows.size() && condition.values[rows[last]] == condition.values[rows[first]]) ++last;
    for (std::size_t k = first; k < last; ++k)
      rank[rows[k]] = static_cast<double>(first + last) / static_cast<double>(rows.size()) - 1;
    first = last;
  }
  return rank;
}

struct Pair {
  std::size_t first = 0, second = 0;
  const std::vector<double>* direction = nullptr;  // null: 1
};
std::vector<Pair> pairs_of(const std::vector<Condition>& conditions) {
  std::vector<Pair> pairs;
  for (std::size_t a = 0; a < conditions.size(); ++a)
    for (std::size_t b = a + 1; b < conditions.size(); ++b) {
      const std::vector<double>&one = conditions[a].direction, &other = conditions[b].direction;
      pairs.push_back({a, b, one.empty() ? nullptr : &one});
      if (one != other) pairs.push_back({a, b, other.empty() ? nullptr : &other});
    }
  return pairs;
}

struct Sums {
  double score = 0, squares = 0, length = 0, raw = 0;
};
// Over the blocks, of one projected column against the residual.
Sums over_blocks(const System& system, const Eigen::MatrixXd& projected, Eigen::Index column, std::size_t blocks) {
  const std::vector<std::uint32_t>& block = system.observations().block;
  std::vector<double> score(blocks, 0.0);
  Sums s;
  for (Eigen::Index i = 0; i < projected.rows(); ++i) {
    const auto row = static_cast<std::size_t>(i);
    const double w = system.weight(row), c = projected(i, column);
    if (!(w > 0)) continue;
    score[block[row]] += c * projected(i, projected.cols() - 1);
    s.length += c * c;
    s.raw += c * c / (w * w);
  }
  for (const double u : score) s.score += u, s.squares += u * u;
  return s;
}

}  // namespace

std::optional<Interaction> interaction(const System& system, const Fit& fit) {
  const Observations& o = system.observations();
  const std::vector<Pair> pairs = pairs_of(o.conditions);
  const LawData data(system, fit.values, fit.inner);
  if (pairs.empty() || data.blocks() < least_blocks) return std::nullopt;
  std::vector<std::vector<double>> ranks;
  for (const Condition& c : o.conditions) ranks.push_back(ranks_of(system, c));
  Interaction best;
  double largest = 0, rows = 0, norm = 0, squares = 0, looks = 0;
  Sums at_best;
  for (std::size_t first = 0; first < pairs.size(); first += columns_at_once) {
    RawColumns columns;
    for (std::size_t k = first; k < std::min(pairs.size(), first + columns_at_once); ++k) {
      columns.emplace_back(o.rows(), 0.0);
      for (const std::size_t g : system.groups)
        for (std::size_t i = o.first[g]; i < o.first[g + 1]; ++i)
          columns.back()[i] = ranks[pairs[k].first][i] * ranks[pairs[k].second][i] *
                              (pairs[k].direction == nullptr ? 1 : (*pairs[k].direction)[i]);
    }
    const Eigen::MatrixXd projected = data.projected(columns);
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const Sums s = over_blocks(system, projected, static_cast<Eigen::Index>(k), data.blocks());
      double full = 0;
      for (std::size_t i = 0; i < o.rows(); ++i) full += std::pow(columns[k][i] * system.weight(i), 2);
      if (!(s.length > least_survivor * least_survivor * full) || !(s.squares > 0)) continue;
      looks += 1;
      const double t = s.score * s.score / s.squares;
      if (!(t > largest)) continue;
      largest = t, at_best = s;
      best.first = pairs[first + k].first, best.second = pairs[first + k].second;
    }
    if (first > 0) continue;
    for (Eigen::Index i = 0; i < projected.rows(); ++i) squares += std::pow(projected(i, projected.cols() - 1), 2);
  }
  if (!(largest > 0)) return std::nullopt;
  for (const std::size_t g : system.groups)
    for (std::size_t i = o.first[g]; i < o.first[g + 1]; ++i)
      if (system.weight(i) > 0) rows += 1, norm += o.norm[i];
  const double fall = at_best.score * at_best.score / at_best.length;
  const double size = at_best.score / at_best.length;
  best.p = stats::sidak(stats::chi2_upper(largest, 1), looks);
  best.power = rows > 0 ? fall / rows : 0;
  best.effect = system.problem().importance() == Importance::share_of_signal
                    ? (norm > 0 ? std::sqrt(size * size * at_best.raw / norm) : 0)
                    : 1 - std::sqrt(std::max(0.0, 1 - fall / squares));
  return best;
}

}  // namespace gonio::inference
