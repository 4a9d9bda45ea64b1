// See row_noise.h.
#include "explain/volumes/row_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "base/parallel.h"
#include "stats/intervals.h"

namespace gonio::explain::volumes {
namespace {

constexpr std::size_t neighbours = 6, further = 18, halvings = 4;
constexpr double beyond = 6, cell_voxels = 8, plainly_noisier = 1.5;

// The nearest rows of the same kind to each row of it, of edges those that face alike; nearest first.
using Near = std::vector<std::vector<std::uint32_t>>;
Near nearest_rows(const std::vector<Row>& rows, const std::vector<std::size_t>& kind) {
  Near result(kind.size());
  parallel_for(
      0, kind.size(),
      [&](std::size_t n) {
        const Row& own = rows[kind[n]];
        std::vector<std::pair<double, std::uint32_t>> near;
        for (std::size_t m = 0; m < kind.size(); ++m) {
          const Row& other = rows[kind[m]];
          if (m == n || (!is_grey(own.reading) && dot(other.normal, own.normal) < 0.7)) continue;
          near.emplace_back(dot(other.at_m - own.at_m, other.at_m - own.at_m), static_cast<std::uint32_t>(m));
        }
        const std::size_t count = std::min(neighbours + further, near.size());
        std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
        for (std::size_t k = 0; k < count; ++k) result[n].push_back(near[k].second);
      },
      32);
  return result;
}

// How far readings are off, beyond what was simulated, against those near them; over sigma.
struct Differences {
  std::vector<double> own;   // less the median of the six nearest
  std::vector<double> near;  // the mean of the six nearest less that of the next eighteen
};

Differences differences(const std::vector<Row>& rows, const std::vector<std::size_t>& kind, const Near& near,
                        const std::vector<double>& simulated) {
  Differences result{std::vector<double>(kind.size()), std::vector<double>(kind.size())};
  const auto off = [&](std::size_t n) { return rows[kind[n]].value - simulated[n]; };
  for (std::size_t n = 0; n < kind.size(); ++n) {
    std::vector<double> values;
    double sum = 0, beyond_sum = 0;
    for (std::size_t k = 0; k < near[n].size(); ++k) {
      const double value = off(near[n][k]);
      if (k < neighbours) values.push_back(value);
      (k < neighbours ? sum : beyond_sum) += value;
    }
    const double sigma = rows[kind[n]].sigma;
    result.own[n] = values.empty() ? 0 : (off(n) - stats::median(values)) / sigma;
    if (near[n].size() == neighbours + further)
      result.near[n] = (sum / neighbours - beyond_sum / static_cast<double>(further)) / sigma;
  }
  return result;
}

// What was simulated, less the ripples that edges have with their places on the grid of voxels.
std::vector<double> without_ripples(const std::vector<double>& simulated, const Near& near) {
  std::vector<double> result;
  for (std::size_t n = 0; n < simulated.size(); ++n) {
    double sum = simulated[n];
    for (const std::uint32_t m : near[n]) sum += simulated[m];
    result.push_back(sum / static_cast<double>(near[n].size() + 1));
  }
  return result;
}

// How much wider than all the differences of a row's neighbours and its own are; one where that is not plainly more: in
// the slices of dense parts a volume is noisier than elsewhere.
std::vector<double> local_widths(const std::vector<double>& differences, const Near& near) {
  const double all = std::max(1e-3, stats::robust_sigma(differences));
  std::vector<double> result;
  for (std::size_t n = 0; n < differences.size(); ++n) {
    std::vector<double> own{std::abs(differences[n])};
    for (const std::uint32_t m : near[n]) own.push_back(std::abs(differences[m]));
    const double ratio = stats::median(own) / (0.6745 * all);
    result.push_back(ratio > plainly_noisier ? ratio : 1);
  }
  return result;
}

// The median of six normal numbers has 0.215 of the variance of one.
constexpr double median_variance = 0.215;

}  // namespace

std::size_t settle_row_noise(std::vector<Row>& rows, double) {
  std::vector<char> out(rows.size(), 0);
  for (std::size_t kind = 0; kind < readings; ++kind) {
    std::vector<std::size_t> own;
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (rows[i].reading == static_cast<Reading>(kind)) own.push_back(i);
    if (own.size() <= neighbours) continue;
    // One sigma for all of a kind is steadier than each fit's own word.
    std::vector<double> stated;
    for (const std::size_t i : own) stated.push_back(rows[i].sigma);
    const double typical = stats::median(stated);
    for (const std::size_t i : own) rows[i].sigma = std::clamp(rows[i].sigma, 0.7 * typical, 3 * typical);
    const Near near = nearest_rows(rows, own);
    std::vector<double> simulated;
    for (const std::size_t i : own) simulated.push_back(rows[i].simulated);
    Differences d = differences(rows, own, near, simulated);
    // Walls that stand elsewhere than believed, or pixels that lay elsewhere, have other ripples: rather none, then.
    if (kind <= static_cast<std::size_t>(Reading::width)) {
      const std::vector<double> smooth = without_ripples(simulated, near);
      Differences other = differences(rows, own, near, smooth);
      if (stats::robust_sigma(other.own) < stats::robust_sigma(d.own)) {
        d = std::move(other);
        for (std::size_t n = 0; n < own.size(); ++n) rows[own[n]].simulated = smooth[n];
      }
    }
    const double factor = std::max(1e-3, stats::robust_sigma(d.own)) / std::sqrt(1 + median_variance);
    // What neighbours share counts as if every reading had it for itself.
    const double alone = factor * std::sqrt(1.0 / neighbours + 1.0 / static_cast<double>(further));
    const double shared = std::max(1.0, stats::robust_sigma(d.near) / alone);
    const std::vector<double> wider = local_widths(d.own, near);
    for (std::size_t n = 0; n < own.size(); ++n) {
      out[own[n]] = std::abs(d.own[n]) > beyond * factor * wider[n] * std::sqrt(1 + median_variance);
      rows[own[n]].sigma *= factor * shared * wider[n];
    }
  }
  const std::size_t before = rows.size();
  std::vector<Row> kept;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (!out[i]) kept.push_back(rows[i]);
  rows = std::move(kept);
  return before - rows.size();
}

std::pair<std::size_t, std::size_t> group_rows(std::vector<Row>& rows, double voxel_m) {
  std::vector<std::pair<std::size_t, std::size_t>> parts{{0, rows.size()}};
  const auto axis = [](const Row& row, int a) { return row.at_m[a]; };
  for (std::size_t h = 0; h < halvings; ++h) {
    std::vector<std::pair<std::size_t, std::size_t>> halves;
    for (const auto& [first, last] : parts) {
      const auto begin = rows.begin() + static_cast<std::ptrdiff_t>(first),
                 end = rows.begin() + static_cast<std::ptrdiff_t>(last), middle = begin + (end - begin) / 2;
      int widest = 0;
      double most = -1;
      for (int a = 0; a < 3; ++a) {
        const auto [low, high] =
            std::minmax_element(begin, end, [&](const Row& p, const Row& q) { return axis(p, a) < axis(q, a); });
        if (axis(*high, a) - axis(*low, a) > most) most = axis(*high, a) - axis(*low, a), widest = a;
      }
      std::stable_sort(begin, end, [&](const Row& p, const Row& q) { return axis(p, widest) < axis(q, widest); });
      const auto cut = static_cast<std::size_t>(middle - rows.begin());
      halves.push_back({first, cut});
      halves.push_back({cut, last});
    }
    parts = std::move(halves);
  }
  std::map<std::array<long, 4>, std::uint32_t> blocks;
  for (std::size_t g = 0; g < parts.size(); ++g)
    for (std::size_t i = parts[g].first; i < parts[g].second; ++i) {
      Row& row = rows[i];
      row.group = g;
      std::array<long, 4> cell{static_cast<long>(g), 0, 0, 0};
      for (int a = 0; a < 3; ++a)
        cell[static_cast<std::size_t>(a) + 1] = std::lround(std::floor(row.at_m[a] / (cell_voxels * voxel_m)));
      row.block = blocks.try_emplace(cell, static_cast<std::uint32_t>(blocks.size())).first->second;
    }
  return {parts.size(), blocks.size()};
}

}  // namespace gonio::explain::volumes
