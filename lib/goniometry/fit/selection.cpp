// See selection.h.
#include "goniometry/fit/selection.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/parallel.h"

namespace gonio::goniometry {

FitError Errors::rms() const {
  const auto root = [](double sum, std::size_t n) {
    return n > 0 ? std::sqrt(sum / static_cast<double>(n)) : std::numeric_limits<double>::quiet_NaN();
  };
  return {root(scaled, count), root(log1p, count), root(decades, bright)};
}

void Errors::add(const Errors& other) {
  scaled += other.scaled, log1p += other.log1p, decades += other.decades;
  count += other.count, bright += other.bright;
  band_log1p.resize(other.band_log1p.size());
  band_count.resize(other.band_count.size());
  for (std::size_t b = 0; b < band_log1p.size(); ++b)
    band_log1p[b] += other.band_log1p[b], band_count[b] += other.band_count[b];
}

Errors errors_of(const Problem& problem, const Candidate& candidate, const std::vector<double>& x, const Rows& rows) {
  const std::size_t bands = problem.bands();
  const auto triples = candidate.triples(x, bands);
  std::vector<double> m(bands);
  Errors e;
  e.band_log1p.assign(bands, 0);
  e.band_count.assign(bands, 0);
  for (const std::uint32_t r : rows) {
    problem.predict(candidate, triples, r, m);
    for (std::size_t b = 0; b < bands; ++b) {
      if (!problem.used(r, b)) continue;
      const double f = problem.samples().f[r * bands + b], scaled = problem.residual(r, b, m[b]),
                   z = problem.log1p_residual(r, b, m[b]);
      e.scaled += scaled * scaled;
      e.log1p += z * z;
      e.band_log1p[b] += z * z;
      ++e.band_count[b], ++e.count;
      if (!(f > 0)) continue;
      const double decades = std::log10(f / std::max(m[b], 1e-12));
      e.decades += decades * decades;
      ++e.bright;
    }
  }
  return e;
}

std::vector<Rows> folds_of(const Problem& problem, const std::vector<Rows>& blocks, int count) {
  if (count < 2) return {};
  const Samples& s = problem.samples();
  std::map<std::size_t, Rows> series;
  for (const std::uint32_t r : problem.rows()) series[s.series.empty() ? 0 : s.series[r]].push_back(r);
  std::vector<Rows> parts;
  if (series.size() >= 4) {
    for (auto& [id, rows] : series) parts.push_back(rows);
    std::ranges::stable_sort(parts, {}, [&](const Rows& rows) { return s.wi[rows.front()].z; });
  } else {
    parts = blocks;
  }
  std::vector<Rows> folds(std::min(parts.size(), static_cast<std::size_t>(count)));
  if (folds.size() < 2) return {};
  for (std::size_t k = 0; k < parts.size(); ++k)
    folds[k % folds.size()].insert(folds[k % folds.size()].end(), parts[k].begin(), parts[k].end());
  for (Rows& fold : folds) std::ranges::sort(fold);
  return folds;
}

std::vector<Errors> held_out(const Problem& problem, const Candidate& candidate, const Solution& solution,
                             const std::vector<Rows>& folds) {
  std::vector<Errors> errors(folds.size());
  parallel_for(0, folds.size(), [&](std::size_t k) {
    Rows seen;
    std::ranges::set_difference(problem.rows(), folds[k], std::back_inserter(seen));
    const Solution without = solve(problem, candidate, solution.x, seen, 15);
    errors[k] = errors_of(problem, candidate, without.x, folds[k]);
  });
  return errors;
}

Excess excess(const std::vector<Errors>& a, const std::vector<Errors>& b) {
  double all = 0, sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) all += static_cast<double>(a[k].count), sum += a[k].scaled - b[k].scaled;
  if (!(all > 0)) return {};
  const double mean = sum / all, folds = static_cast<double>(a.size());
  double squares = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const double off = a[k].scaled - b[k].scaled - mean * static_cast<double>(a[k].count);
    squares += off * off;
  }
  return {mean, std::sqrt(squares * folds / (folds - 1)) / all};
}

}  // namespace gonio::goniometry
