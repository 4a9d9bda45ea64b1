// See moving_model.h.
#include "io/moving_model.h"

#include <algorithm>
#include <cmath>

namespace gonio::io {

std::vector<double> angles_at(const MovingModel& model, double time_s) {
  const auto& keys = model.keys;
  if (keys.empty()) return {};
  const auto after = std::ranges::upper_bound(keys, time_s, {}, &ModelKey::time_s);
  if (after == keys.begin()) return keys.front().angles_rad;
  if (after == keys.end()) return keys.back().angles_rad;
  const ModelKey &a = *(after - 1), &b = *after;
  const double share = (time_s - a.time_s) / (b.time_s - a.time_s);  // a is not after time_s, b is
  std::vector<double> angles(a.angles_rad);
  for (std::size_t h = 0; h < angles.size(); ++h) angles[h] += share * (b.angles_rad[h] - a.angles_rad[h]);
  return angles;
}

std::vector<PlacedNode> placed_nodes(const MovingModel& model, double time_s) {
  const std::vector<double> angles = angles_at(model, time_s);
  std::vector<PlacedNode> at(model.nodes.size());
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    const ModelNode& node = model.nodes[i];
    at[i] = {matrix_of(node.placed.rotation), node.placed.translation_m};
    if (node.parent >= 0) {
      const PlacedNode& parent = at[static_cast<std::size_t>(node.parent)];
      at[i] = {parent.rotation * at[i].rotation, parent.rotation * at[i].origin_m + parent.origin_m};
    }
    if (node.hinge < 0) continue;
    const double angle = angles[static_cast<std::size_t>(node.hinge)], c = std::cos(angle), s = std::sin(angle);
    at[i].rotation = at[i].rotation * Mat3{{c, -s, 0, s, c, 0, 0, 0, 1}};
  }
  return at;
}

int colour_at(const ModelNode& node, double time_s) {
  int colour = node.colour;
  for (const ColourChange& change : node.changes)
    if (change.from_s <= time_s) colour = change.colour;
  return colour;
}

}  // namespace gonio::io
