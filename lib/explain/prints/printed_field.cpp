// See printed_field.h.
#include "explain/prints/printed_field.h"

#include <algorithm>
#include <cmath>

#include "print/mechanisms/print_membrane.h"
#include "print/mechanisms/print_overcure.h"

namespace gonio::explain::prints {

namespace {

// What a difference on either side agrees about: nothing at the rim of an even picture, which is sharp.
double agreed(double before, double after) {
  return before * after > 0 ? std::min(std::abs(before), std::abs(after)) : 0;
}

// From the last layer down, as print/cure.h has it, but cell by cell: light that crosses the threshold within a cell
// cures a part of it, and what is beside it is seen through. So surfaces change evenly with what moves light; by whole
// cells a fit would not see walls move, nor how well it knows them.
class Growing {
 public:
  Growing(const print::Printer& printer, Field& field)
      : growth_(printer.growth),
        overcure_m_(printer.overcure_m.value_or(0)),
        threshold_(printer.growth.threshold()),
        field_(field),
        total_(field.top_m.size(), 0.0),
        seen_(field.top_m.size(), 1.0) {}
  void add(const std::vector<float>& light, double bottom_m, double top_m) {
    const double kept = above_m_ > 0 ? equation::print_overcure(above_m_, overcure_m_) : 0, layer_m = top_m - bottom_m;
    above_m_ = layer_m;
    for (std::size_t i = 0; i < total_.size(); ++i) total_[i] = static_cast<double>(light[i]) + kept * total_[i];
    const bool sharp = growth_.proportional() || growth_.height_m(0, layer_m) > 0;
    for (int y = 0; y < field_.height; ++y)
      for (int x = 0; x < field_.width; ++x) {
        const std::size_t i =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(field_.width) + static_cast<std::size_t>(x);
        // Light that only went through later layers cures beneath them: what is below is covered.
        if (seen_[i] == 0) continue;
        const double width = sharp ? 0 : varies(x, y, i);
        const double above = total_[i] - threshold_, part = sharp || above > width / 2 ? 1
                                                            : width > 0 ? std::max(0.0, above / width + 0.5)
                                                                        : 0;
        if (part == 0) continue;
        const double mean = part < 1 ? threshold_ + part * width / 2 : total_[i];
        const double height_m = std::min(growth_.height_m(mean, layer_m), layer_m);
        if (!(height_m > 0)) continue;
        field_.top_m[i] += seen_[i] * part * (bottom_m + height_m);
        if (seen_[i] > 0.5 && seen_[i] * (1 - part) <= 0.5) field_.ceiling_m[i] = top_m;
        seen_[i] *= 1 - part;
      }
  }

 private:
  double varies(int x, int y, std::size_t i) const {  // light across the cell
    const auto width = static_cast<std::size_t>(field_.width);
    double sum = 0;
    if (x > 0 && x + 1 < field_.width) sum += agreed(total_[i] - total_[i - 1], total_[i + 1] - total_[i]);
    if (y > 0 && y + 1 < field_.height) sum += agreed(total_[i] - total_[i - width], total_[i + width] - total_[i]);
    return sum;
  }
  const print::Growth& growth_;
  double overcure_m_, threshold_, above_m_ = 0;
  Field& field_;
  std::vector<double> total_, seen_;
};

}  // namespace

Field grown(const Sent& sent, const Setting& setting, const Lights& lights) {
  Field field;
  field.width = sent.wide() * cells_per_pixel, field.height = sent.high() * cells_per_pixel;
  field.corner_m = sent.corner_m;
  field.cell_m = sent.cell_m();
  const auto cells = static_cast<std::size_t>(field.width) * static_cast<std::size_t>(field.height);
  field.top_m.assign(cells, 0.0), field.ceiling_m.assign(cells, 0.0);
  Growing growing(setting.printer, field);
  std::vector<double> bottom{0};
  for (std::size_t k = 0; k < lights.size(); ++k) bottom.push_back(bottom.back() + setting.printer.thickness_m(k));
  for (std::size_t k = lights.size(); k-- > 0;) growing.add(lights[k], bottom[k], bottom[k + 1]);
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
      mixed->top_m[i] += weight * (setting.cut_m > 0 && one->ceiling_m[i] > 0
                                       ? equation::print_membrane(one->top_m[i], one->ceiling_m[i], setting.cut_m)
                                       : one->top_m[i]);
  }
  return mixed;
}

Field printed_field(const Sent& sent, const Setting& setting) {
  return *printed_field(sent, setting, [&sent](const Setting& own) {
    Lights lights =
        lights_of(sent, own, [&sent](double tail_m) { return std::make_shared<const Lights>(tails_of(sent, tail_m)); });
    if (own.shifted_from > 0) {
      const auto [x, y] = shift_cells(sent, own);
      lights = moved(lights, sent, own.shifted_from, x, y);
    }
    return std::make_shared<const Field>(grown(sent, own, lights));
  });
}

}  // namespace gonio::explain::prints
