// See rim_offsets.h.
#include "alignment/rim_offsets.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"

namespace gonio::alignment {
namespace {

constexpr double least_weight = 0.1;  // of what counts
const Loss loss{2.5, std::numeric_limits<double>::infinity()};

double median(std::vector<double> v) {
  if (v.empty()) return 0;
  const auto middle = v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2);
  std::nth_element(v.begin(), middle, v.end());
  return *middle;
}
// Standard deviation of one point, by the median of sizes.
double sigma_of(const std::vector<double>& sizes) {
  return std::max(0.01, 1.4826 * median(sizes));
}

}  // namespace

double Loss::cost(double d) const {
  const double s = std::min(std::abs(d), reach) / width;
  return width * width * std::log1p(s * s);
}

bool beneath(const Setting& s, std::size_t body, const RimPlace& place) {
  return s.ground && height_of(s, body, place.mesh_point) < 0;
}

SightingFit offsets_of(const Setting& s, const Sighting& sighting, const SeenPoints& seen, double reach_px) {
  SightingFit fit;
  fit.offset_px.assign(sighting.points.size(), std::numeric_limits<double>::quiet_NaN());
  fit.weight.assign(sighting.points.size(), 0);
  const ModelRim rim(s, sighting.subject);
  if (!rim.exists()) return fit;
  std::vector<double> sizes;
  std::size_t counts = 0;
  for (std::size_t i = 0; i < sighting.points.size(); ++i) {
    const RimPoint& point = sighting.points[i];
    if (!point.counts) continue;
    ++counts;
    const auto place = rim.nearest(point.pixel, point.outward, reach_px);
    if (!place || beneath(s, sighting.subject.body, *place)) {
      counts -= place.has_value();
      continue;
    }
    fit.offset_px[i] = place->distance_px;
    sizes.push_back(std::abs(place->distance_px));
  }
  fit.sigma_px = sigma_of(sizes);
  double squares = 0, sum = 0, met = 0;
  const double near = 1 + 3 * fit.sigma_px;
  for (std::size_t i = 0; i < sighting.points.size(); ++i) {
    const double d = fit.offset_px[i];
    if (std::isfinite(d)) fit.weight[i] = loss.weight(d / fit.sigma_px), met += std::abs(d) < near;
    if (fit.weight[i] > least_weight)
      squares += d * d, sum += d, ++fit.counted;
    else if (sighting.points[i].counts)
      ++fit.left_out;
  }
  if (fit.counted > 0) {
    const auto n = static_cast<double>(fit.counted);
    fit.rms_px = std::sqrt(squares / n), fit.mean_px = sum / n;
  }
  fit.met = counts > 0 ? met / static_cast<double>(counts) : 0;
  std::size_t visible = 0, explained = 0;
  for (const RimPlace& place : rim.places(1)) {
    if (beneath(s, sighting.subject.body, place) || (sighting.unseen && sighting.unseen(place.pixel))) continue;
    ++visible;
    explained += seen.nearest(place.pixel, place.outward, near).has_value();
  }
  fit.explained = visible > 0 ? static_cast<double>(explained) / static_cast<double>(visible) : 0;
  return fit;
}

double rms_offset(const Setting& s, const Question& question, double reach_px) {
  struct Sum {
    double squares = 0, counted = 0;
  };
  std::vector<Sum> sums(question.sightings.size());
  parallel_for(0, sums.size(), [&](std::size_t k) {
    const Sighting& sighting = question.sightings[k];
    const ModelRim rim(s, sighting.subject);
    std::vector<double> sizes;
    for (const RimPoint& point : sighting.points) {
      if (!point.counts) continue;
      const auto place = rim.exists() ? rim.nearest(point.pixel, point.outward, reach_px) : std::nullopt;
      if (!place)
        sizes.push_back(reach_px);
      else if (!beneath(s, sighting.subject.body, *place))
        sizes.push_back(std::abs(place->distance_px));
    }
    const double sigma = sigma_of(sizes);
    for (const double d : sizes)
      if (loss.weight(d / sigma) > least_weight) sums[k].squares += d * d, sums[k].counted += 1;
  });
  Sum all;
  for (const Sum& sum : sums) all.squares += sum.squares, all.counted += sum.counted;
  return all.counted > 0 ? std::sqrt(all.squares / all.counted) : 0;
}

}  // namespace gonio::alignment
