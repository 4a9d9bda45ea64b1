// What a correction did to edges.
#include <algorithm>
#include <cmath>

#include "volume/contour.h"
#include "volume/correct.h"
#include "volume/threshold.h"

namespace gonio::volume {
namespace {

constexpr std::size_t most_edges = 20000;
constexpr double ten_to_ninety = 2.5631;  // of a normal distribution, in standard deviations

double median_of(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

EdgeChange edge_change(io::VolumeSource& before, io::VolumeSource& after, double threshold, double noise) {
  const Contour surface = contour(before, {.threshold = threshold});
  const std::size_t every = std::max<std::size_t>(1, surface.positions.size() / most_edges);
  const std::vector<Edge> first = edges(before, surface, {.noise = noise}, every),
                          second = edges(after, surface, {.noise = noise}, every);
  EdgeChange change;
  std::vector<double> width_before, width_after;
  double squares = 0;
  for (std::size_t e = 0; e < std::min(first.size(), second.size()); ++e) {
    if (!first[e].good || !second[e].good) continue;
    width_before.push_back(ten_to_ninety * first[e].width), width_after.push_back(ten_to_ninety * second[e].width);
    const double shift = second[e].position - first[e].position;
    change.mean_shift_voxels += shift, squares += shift * shift;
  }
  change.edges = width_before.size();
  if (change.edges == 0) return change;
  const auto count = static_cast<double>(change.edges);
  change.mean_shift_voxels /= count, change.rms_shift_voxels = std::sqrt(squares / count);
  change.sigma_mean_shift =
      std::sqrt(std::max(0.0, squares / count - change.mean_shift_voxels * change.mean_shift_voxels) / count);
  change.width_before_voxels = median_of(std::move(width_before));
  change.width_after_voxels = median_of(std::move(width_after));
  return change;
}

}  // namespace gonio::volume
