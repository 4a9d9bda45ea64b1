// reference.tile on readings whose angles are known. What an expression predicts may as well be the tile's own reading:
// there both signs stand.
//
// In tables of reflectance it is the sample's readings over those of a white tile that sends less than it should
// towards grazing, so that both numbers are at least 0. Three alternatives of one family, either angle alone and both:
// a number that ends at 0 belongs to no name.
#include "scene/mechanisms/reference_tile.h"

#include <array>
#include <cmath>

#include "explain/tables/table_model.h"

namespace gonio::explain::tables::terms {
namespace {

enum class Shown { both, incidence, exitance };

template <Shown shown>
void at_least_zero(const Table&, double, std::span<TermParameter> p) {
  for (TermParameter& number : p) number.lower = 0, number.upper = 1;
  if (shown == Shown::both) return;
  TermParameter& other = p[shown == Shown::incidence ? 1 : 0];
  other.start = 0;
  other.use = TermParameter::Use::fixed;
}

template <Shown shown>
Term of_reflectance() {
  return {.mechanism = mechanism::reference_tile,
          .order = term_order::reference,
          .columns = {{.name = "theta_i", .unit = "rad", .meaning = "incidence", .needed = shown != Shown::exitance},
                      {.name = "theta_o", .unit = "rad", .meaning = "exitance", .needed = shown != Shown::incidence}},
          .models = {"surface"},
          .adapt = at_least_zero<shown>};
}

}  // namespace

const Term& reference_tile() {
  static const std::array<Term, 3> alternatives{of_reflectance<Shown::both>(), of_reflectance<Shown::exitance>(),
                                                of_reflectance<Shown::incidence>()};
  static const Term term{.mechanism = mechanism::reference_tile,
                         .order = term_order::reference,
                         .columns = {{"theta_i", "rad", "incidence"},
                                     {.name = "theta_o", .unit = "rad", .meaning = "exitance", .needed = false}},
                         .models = {"expression"},
                         .act =
                             [](double f, std::span<const double> at, std::span<const double> p) {
                               const double cos_o = std::isnan(at[1]) ? 1 : std::cos(at[1]);
                               return f * equation::reference_tile(p[0], p[1], std::cos(at[0]), cos_o);
                             },
                         .adapt =
                             [](const Table& table, double, std::span<TermParameter> p) {
                               if (table.varies("theta_o")) return;
                               p[1].start = 0;
                               p[1].use = TermParameter::Use::fixed;
                             },
                         .alternatives = alternatives};
  return term;
}

}  // namespace gonio::explain::tables::terms
