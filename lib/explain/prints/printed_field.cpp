// See printed_field.h.
#include "explain/prints/printed_field.h"

#include <algorithm>
#include <cmath>

#include "print/cure.h"
#include "print/mechanisms/print_membrane.h"

namespace gonio::explain::prints {

Field grown(const Sent& sent, const Setting& setting, const Lights& lights) {
  Field field;
  field.width = sent.wide() * cells_per_pixel, field.height = sent.high() * cells_per_pixel;
  field.corner_m = sent.corner_m;
  field.cell_m = sent.cell_m();
  print::Printer fine = setting.printer;
  fine.pixel_m = field.cell_m;
  fine.width_px *= cells_per_pixel, fine.height_px *= cells_per_pixel;
  fine.bleed = {};  // which is in the light
  print::Cure cure(fine, {0, 0, field.width, field.height});
  std::vector<double> bottom{0};
  for (std::size_t k = 0; k < lights.size(); ++k) bottom.push_back(bottom.back() + fine.thickness_m(k));
  for (std::size_t k = lights.size(); k-- > 0;) cure.add(lights[k], bottom[k], bottom[k + 1]);
  const print::CuredSurface& surface = cure.surface();
  const auto finite = [](float v) { return std::isfinite(v) ? static_cast<double>(v) : 0.0; };
  field.top_m.resize(surface.top_m.size()), field.ceiling_m.resize(surface.top_m.size());
  std::ranges::transform(surface.top_m, field.top_m.begin(), finite);
  std::ranges::transform(surface.ceiling_m, field.ceiling_m.begin(), finite);
  return field;
}

std::pair<int, int> shift_cells(const Sent& sent, const Setting& setting) {
  const Vec2 cell_m = sent.cell_m();
  return {static_cast<int>(std::lround(setting.shift_m.x / cell_m.x)),
          static_cast<int>(std::lround(setting.shift_m.y / cell_m.y))};
}

std::shared_ptr<const Field> printed_field(const Sent& sent, const Setting& setting, const GrownOf& grown_of) {
  const Vec2 cell_m = sent.cell_m();
  Vec2 by{0, 0};
  if (setting.shifted_from > 0) by = {setting.shift_m.x / cell_m.x, setting.shift_m.y / cell_m.y};
  const Vec2 whole{std::floor(by.x), std::floor(by.y)}, part = by - whole;
  std::shared_ptr<Field> mixed;
  for (const auto& [x, y] : {std::pair{0, 0}, std::pair{1, 0}, std::pair{0, 1}, std::pair{1, 1}}) {
    const double weight = (x == 0 ? 1 - part.x : part.x) * (y == 0 ? 1 - part.y : part.y);
    if (weight == 0) continue;
    Setting own = setting;
    own.cut_m = 0;
    own.shift_m = {(whole.x + x) * cell_m.x, (whole.y + y) * cell_m.y};
    if (whole.x + x == 0 && whole.y + y == 0) own.shifted_from = 0;
    const std::shared_ptr<const Field> one = grown_of(own);
    if (weight == 1 && !(setting.cut_m > 0)) return one;
    if (!mixed) {
      mixed = std::make_shared<Field>(*one);
      mixed->top_m.assign(one->top_m.size(), 0.0);
    }
    for (std::size_t i = 0; i < one->top_m.size(); ++i)
      mixed->top_m[i] += weight * (setting.cut_m > 0
                                       ? equation::print_membrane(one->top_m[i], one->ceiling_m[i], setting.cut_m)
                                       : one->top_m[i]);
  }
  return mixed;
}

Field printed_field(const Sent& sent, const Setting& setting) {
  return *printed_field(sent, setting, [&sent](const Setting& own) {
    Lights lights = lights_of(sent, own, [&sent](double tail_m) {
      return std::make_shared<const Lights>(tails_of(sent, tail_m));
    });
    if (own.shifted_from > 0) {
      const auto [x, y] = shift_cells(sent, own);
      lights = moved(lights, sent, own.shifted_from, x, y);
    }
    return std::make_shared<const Field>(grown(sent, own, lights));
  });
}

}  // namespace gonio::explain::prints
