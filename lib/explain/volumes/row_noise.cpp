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

constexpr std::size_t neighbours = 6, halvings = 4;
constexpr double beyond = 6, cell_voxels = 8;

// Differences of every row of a kind from the median of its neighbours, over sigma.
std::vector<double> differences(const std::vector<Row>& rows, const std::vector<std::size_t>& kind) {
  std::vector<double> result(kind.size());
  parallel_for(
      0, kind.size(),
      [&](std::size_t n) {
        const Row& own = rows[kind[n]];
        std::vector<std::pair<double, double>> near;  // distance, value
        for (const std::size_t m : kind) {
          if (m == kind[n] || (own.reading <= Reading::width && dot(rows[m].normal, own.normal) < 0.7)) continue;
          near.emplace_back(dot(rows[m].at_m - own.at_m, rows[m].at_m - own.at_m), rows[m].value);
        }
        const std::size_t count = std::min(neighbours, near.size());
        std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
        std::vector<double> values;
        for (std::size_t k = 0; k < count; ++k) values.push_back(near[k].second);
        result[n] = values.empty() ? 0 : (own.value - stats::median(values)) / own.sigma;
      },
      32);
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
    const std::vector<double> d = differences(rows, own);
    const double factor = std::max(1e-3, stats::robust_sigma(d)) / std::sqrt(1 + median_variance);
    for (std::size_t n = 0; n < own.size(); ++n) {
      out[own[n]] = std::abs(d[n]) > beyond * factor * std::sqrt(1 + median_variance);
      rows[own[n]].sigma *= factor;
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
