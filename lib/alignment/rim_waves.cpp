// See rim_waves.h.
#include "alignment/rim_waves.h"

#include <cmath>
#include <map>
#include <utility>

#include "stats/distributions.h"

namespace gonio::alignment {
namespace {

constexpr double piece_px = 32, alike_px = 16;  // of a mean, and over which masks may err alike
constexpr double usual_limit_px = 0.75;
constexpr double false_alarm = 1e-3;
constexpr double least_share = 0.5;  // of a piece's points that the loss has to count

}  // namespace

RimWaves rim_waves(const Question& question, const Fitted& fitted, std::size_t body, double most_sigma_px) {
  const double coarser = most_sigma_px / usual_limit_px;
  RimWaves waves;
  double squares = 0;
  for (std::size_t k = 0; k < fitted.sightings.size(); ++k) {
    if (question.sightings[k].subject.body != body) continue;
    const SightingFit& fit = fitted.sightings[k];
    const auto& points = question.sightings[k].points;
    struct Sum {
      double offset = 0, weight = 0, expected = 0, points = 0;
    };
    std::map<std::pair<std::uint32_t, long>, Sum> sums;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!(fit.weight[i] > 0)) continue;
      Sum& sum = sums[{points[i].loop, static_cast<long>(points[i].arc_px / piece_px)}];
      sum.offset += fit.weight[i] * fit.offset_px[i], sum.weight += fit.weight[i];
      sum.expected += std::pow(coarser * points[i].sigma_px, 2), sum.points += 1;
    }
    for (const auto& [place, sum] : sums) {
      if (sum.points < 0.5 * piece_px || sum.weight < least_share * sum.points) continue;
      const double mean = sum.offset / sum.weight;
      squares += mean * mean / (sum.expected / sum.points * alike_px / piece_px);
      waves.rms_px += mean * mean, ++waves.pieces;
    }
  }
  if (waves.pieces == 0) return waves;
  const auto n = static_cast<double>(waves.pieces);
  waves.rms_px = std::sqrt(waves.rms_px / n);
  waves.limit_px = waves.rms_px * std::sqrt(stats::chi2_quantile(1 - false_alarm, n) / std::max(squares, 1e-12));
  return waves;
}

}  // namespace gonio::alignment
