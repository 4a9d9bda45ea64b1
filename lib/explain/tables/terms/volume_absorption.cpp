// volume.absorption on readings whose path through the material is known.
#include "scene/mechanisms/volume_absorption.h"

#include <algorithm>
#include <cmath>

#include "explain/tables/table_model.h"

namespace gonio::explain::tables::terms {

const Term& volume_absorption() {
  static const Term term{.mechanism = mechanism::volume_absorption,
                         .order = term_order::volume,
                         .columns = {{"path_m", "m", "length through the material"}},
                         .models = {"sensor", "volume", "expression"},
                         .adapt = [](const Table& table, double, std::span<TermParameter> p) {
                           const std::vector<double>& path = *table.find("path_m");
                           const double longest = std::max(1e-9, *std::max_element(path.begin(), path.end()));
                           p[0] = {0.1 / longest, 0, 20 / longest, 0.1 / longest};
                         }};
  return term;
}

}  // namespace gonio::explain::tables::terms
