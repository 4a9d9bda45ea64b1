// print.layer-shift: one hypothesis for each layer above the lowest that is seen.
#include "print/mechanisms/print_layer_shift.h"

#include <algorithm>
#include <cmath>

#include "explain/prints/print_term.h"

namespace gonio::explain::prints::terms {
namespace {

constexpr double fewest_cells = 0.02;  // share of a map that must be of a layer, to have been seen

// Layers whose tops are seen, and of those all but the lowest.
std::vector<Form> forms_of(const Sent& sent) {
  const Field field = printed_field(sent, stated(sent));
  std::vector<std::size_t> seen(sent.layers.size(), 0);
  double top_m = 0;
  for (std::size_t k = 0; k < seen.size(); ++k) {
    top_m += sent.printer.thickness_m(k);
    for (const double ceiling : field.ceiling_m) seen[k] += std::abs(ceiling - top_m) < 1e-3 * sent.printer.layer_m;
  }
  std::vector<Form> forms;
  bool below = false;
  for (std::size_t k = 0; k < seen.size(); ++k) {
    if (static_cast<double>(seen[k]) < fewest_cells * static_cast<double>(field.top_m.size())) continue;
    if (below) forms.push_back({{"x_m", "y_m"}, false, "layer " + std::to_string(k + 1), static_cast<double>(k + 1)});
    below = true;
  }
  return forms;
}

}  // namespace

const Term& print_layer_shift() {
  static const Term term{.mechanism = mechanism::print_layer_shift,
                         .forms = forms_of,
                         .bounds =
                             [](const Sent& sent) {
                               const Vec2 pixel = sent.printer.pixel_m;
                               return std::vector<Bounds>{{0, -4 * pixel.x, 4 * pixel.x, 0.1 * pixel.x},
                                                          {0, -4 * pixel.y, 4 * pixel.y, 0.1 * pixel.y},
                                                          {0, 0, 1e6, 0}};
                             },
                         .set =
                             [](Setting& setting, const Sent&, const Form& form, std::span<const double> p) {
                               setting.shifted_from = form.held;
                               setting.shift_m = {p[0], p[1]};
                             },
                         .gradual = true};
  return term;
}

}  // namespace gonio::explain::prints::terms
