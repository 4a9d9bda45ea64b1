// light.ambient on readings: an open plane receives pi times the radiance of its surroundings, for as long as the
// exposure lasts. Without a channel all three radiances are one number.
#include "light/mechanisms/light_ambient.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "explain/tables/table_model.h"

namespace gonio::explain::tables::terms {

const Term& light_ambient() {
  static const Term term{
      .mechanism = mechanism::light_ambient,
      .order = term_order::light + 10,
      .columns = {{.name = "exposure_s", .unit = "s", .meaning = "left out: 1", .needed = false},
                  {.name = "channel", .unit = "", .meaning = "0, 1, 2; left out: all alike", .needed = false}},
      .models = {"sensor", "light", "expression"},
      .applies = [](const Table&) { return true; },
      .act =
          [](double f, std::span<const double> at, std::span<const double> p) {
            const double exposure = std::isnan(at[0]) ? 1 : at[0];
            const std::size_t band = std::isnan(at[1]) || at[1] < 0 || at[1] > 2 ? 0 : static_cast<std::size_t>(at[1]);
            return f + equation::light_ambient(p[band]) * exposure;
          },
      .adapt =
          [](const Table& table, double scale, std::span<TermParameter> p) {
            const std::vector<double>* exposure = table.find("exposure_s");
            const double longest = exposure == nullptr ? 1 : *std::max_element(exposure->begin(), exposure->end());
            const double unit = scale / (std::numbers::pi * std::max(longest, 1e-12));
            for (TermParameter& band : p) band = {0.01 * unit, 0, 0.5 * unit, 0.01 * unit};
            if (table.varies("channel")) return;
            for (std::size_t k = 1; k < p.size(); ++k) p[k].use = TermParameter::Use::same;
          }};
  return term;
}

}  // namespace gonio::explain::tables::terms
