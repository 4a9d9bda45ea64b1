// sensor.non-linearity as a quadratic of a predicted reading, stated at the table's largest value. Equation:
// render/sensor_chain.h, step 6.
#include "explain/tables/table_model.h"

namespace gonio::mechanism {
const Mechanism& sensor_non_linearity();
}

namespace gonio::explain::tables {

const Term& sensor_non_linearity() {
  static const Term term{
      .mechanism = mechanism::sensor_non_linearity,
      .order = term_order::non_linearity,
      .models = {"sensor", "light", "volume", "expression"},
      .applies = [](const Table&) { return true; },
      .act = [](double f, std::span<const double>, std::span<const double> p) { return f * (1 + p[0] * f / p[1]); },
      .adapt =
          [](const Table&, double scale, std::span<TermParameter> p) {
            p[1] = {scale, scale, scale, scale, TermParameter::Use::fixed};
            for (std::size_t k = 2; k < p.size(); ++k) {
              p[k].start = mechanism::sensor_non_linearity().parameters[k].neutral;
              p[k].use = TermParameter::Use::fixed;
            }
          }};
  return term;
}

}  // namespace gonio::explain::tables
