// Conditions of readings of a print: what of the pictures, of the simulated surface and of the place they stand for.
#include <algorithm>
#include <cmath>
#include <limits>

#include "explain/prints/prints_outcome.h"

namespace gonio::explain {
namespace {

using prints::Reading, prints::Readings, prints::Sent;

// Mean grey of the pixels about one in the picture of its layer, less its own.
double neighbours(const Sent& sent, const Reading& r) {
  const std::vector<float>& picture = sent.layers[static_cast<std::size_t>(r.layer - 1)];
  double sum = 0, count = 0;
  for (int dy = -2; dy <= 2; ++dy)
    for (int dx = -2; dx <= 2; ++dx) {
      const int x = r.x_px + dx, y = r.y_px + dy;
      if ((dx == 0 && dy == 0) || x < 0 || y < 0 || x >= sent.wide() || y >= sent.high()) continue;
      const double weight = 1.0 / (dx * dx + dy * dy);
      sum += weight * static_cast<double>(picture[static_cast<std::size_t>(y) * static_cast<std::size_t>(sent.wide()) +
                                                  static_cast<std::size_t>(x)]);
      count += weight;
    }
  return count > 0 ? sum / count - r.grey : 0;
}

// Light of later layers that goes through those between, each of which keeps half of it.
double later_light(const Sent& sent, const Reading& r) {
  const std::size_t pixel =
      static_cast<std::size_t>(r.y_px) * static_cast<std::size_t>(sent.wide()) + static_cast<std::size_t>(r.x_px);
  double sum = 0, share = 0.5;
  for (std::size_t k = static_cast<std::size_t>(r.layer); k < sent.layers.size(); ++k, share *= 0.5)
    sum += share * static_cast<double>(sent.layers[k][pixel]);
  return sum;
}

}  // namespace

std::vector<Condition> print_conditions(const PrintsInput& input, const Readings& readings) {
  std::vector<Condition> conditions;
  const Sent& sent = input.sent;
  const Vec2 pixel = sent.printer.pixel_m;
  const auto add = [&](const char* name, const char* unit, const char* curve_unit, auto value, auto direction) {
    Condition c{name, unit, "print", {}, {}, curve_unit};
    for (const Reading& r : readings.rows) c.values.push_back(value(r)), c.direction.push_back(direction(r));
    conditions.push_back(std::move(c));
  };
  const auto one = [](const Reading&) { return 1.0; };
  const double layer_um = 1e6 * sent.printer.layer_m;
  const auto slope_x = [=](const Reading& r) { return r.slope_x / layer_um; };
  const auto slope_y = [=](const Reading& r) { return r.slope_y / layer_um; };
  const auto bend = [=](const Reading& r) { return r.bend / layer_um; };
  const auto x = [&](const Reading& r) { return (r.at_m.x - sent.centre_m.x) / pixel.x; };
  const auto y = [&](const Reading& r) { return (r.at_m.y - sent.centre_m.y) / pixel.y; };
  const auto layer = [](const Reading& r) { return static_cast<double>(r.layer); };
  add(
      "print.grey", "1", "1", [](const Reading& r) { return r.grey; }, one);
  add(
      "print.below-top", "um", "1", [](const Reading& r) { return r.below_top_um; }, one);
  add(
      "print.neighbours", "1", "1", [&](const Reading& r) { return neighbours(sent, r); }, one);
  add(
      "print.edge", "um", "1", [](const Reading& r) { return std::hypot(r.slope_x, r.slope_y); }, one);
  add(
      "print.later-light", "1", "1", [&](const Reading& r) { return later_light(sent, r); }, one);
  add(
      "print.height", "um", "1", [](const Reading& r) { return r.height_um; }, one);
  add("print.layer", "1", "1", layer, one);
  add("print.slope-x", "1", "px", layer, slope_x);
  add("print.slope-y", "1", "px", layer, slope_y);
  add("print.size-x", "px", "px", x, slope_x);
  add("print.size-y", "px", "px", y, slope_y);
  add("print.place-x", "px", "px^2", x, bend);
  add("print.place-y", "px", "px^2", y, bend);
  return conditions;
}

}  // namespace gonio::explain
