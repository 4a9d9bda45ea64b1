// See simulation.h.
#include "explain/prints/simulation.h"

#include <algorithm>

namespace gonio::explain::prints {
namespace {

constexpr double kept_bytes = 192e6;  // of each memo

// How many of so many numbers of a cell.
std::size_t kept(const Sent& sent, double bytes_of_a_cell, std::size_t most) {
  const double cells = cells_per_pixel * cells_per_pixel * static_cast<double>(sent.wide()) * sent.high();
  return std::clamp(static_cast<std::size_t>(kept_bytes / std::max(1.0, bytes_of_a_cell * cells)), std::size_t{6},
                    most);
}
std::size_t kept_lights(const Sent& sent, std::size_t most) {
  return kept(sent, sizeof(float) * static_cast<double>(std::max<std::size_t>(1, sent.layers.size())), most);
}

std::vector<double> key_of_light(const Setting& s) {
  const print::Bleed& bleed = s.printer.bleed;
  return {s.tilt.x, s.tilt.y, bleed.sigma_m, bleed.tail_share, bleed.tail_m};
}
// The table of a growth is the printer's own, the law what terms change.
std::vector<double> key_of_growth(const Setting& s) {
  std::vector<double> key = key_of_light(s);
  const print::Growth& growth = s.printer.growth;
  const print::GrowthLaw law = growth.law().value_or(print::GrowthLaw{});
  key.insert(key.end(), {law.alpha_m, law.beta_m, law.gamma, growth.law() ? 1.0 : 0.0, growth.table() ? 1.0 : 0.0,
                         s.printer.overcure_m.value_or(-1), s.shifted_from, s.shift_m.x, s.shift_m.y});
  return key;
}

}  // namespace

Simulation::Simulation(const Sent& sent)
    : sent_(sent),
      tails_(kept_lights(sent, 16)),
      lights_(kept_lights(sent, 64)),
      grown_(kept(sent, 3 * sizeof(double), 128)),
      fields_(kept(sent, 3 * sizeof(double), 16)) {}

std::shared_ptr<const Lights> Simulation::light_of(const Setting& setting) const {
  return lights_.at(key_of_light(setting), [&] {
    return lights_of(sent_, setting,
                     [this](double tail_m) { return tails_.at({tail_m}, [&] { return tails_of(sent_, tail_m); }); });
  });
}

std::shared_ptr<const Field> Simulation::grown_of(const Setting& setting) const {
  std::vector<double> key = key_of_growth(setting);
  if (!(setting.shifted_from > 0)) std::fill(key.end() - 3, key.end(), 0.0);
  return grown_.at(key, [&] {
    const std::shared_ptr<const Lights> light = light_of(setting);
    if (!(setting.shifted_from > 0)) return grown(sent_, setting, *light);
    const auto [x, y] = shift_cells(sent_, setting);
    return grown(sent_, setting, moved(*light, sent_, setting.shifted_from, x, y));
  });
}

std::shared_ptr<const Field> Simulation::field(const Setting& setting) const {
  const auto make = [&] { return printed_field(sent_, setting, [this](const Setting& own) { return grown_of(own); }); };
  if (!(setting.cut_m > 0) && !(setting.shifted_from > 0)) return make();
  std::vector<double> key = key_of_growth(setting);
  key.push_back(setting.cut_m);
  return fields_.at(key, [&] { return *make(); });
}

}  // namespace gonio::explain::prints
