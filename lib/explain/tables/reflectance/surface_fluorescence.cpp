// surface.fluorescence in tables of reflectance whose light changes in the exciting band.
#include "surface/mechanisms/surface_fluorescence.h"

#include <algorithm>

#include "explain/tables/reflectance_binding.h"

namespace gonio::explain::tables::reflectance {
namespace {

bool shows_excitation(const ReflectanceRows& rows, const SurfacePlaces&) {
  const std::vector<double>& column = rows.excitation;
  return !rows.band_m.empty() && !column.empty() &&
         *std::max_element(column.begin(), column.end()) > *std::min_element(column.begin(), column.end());
}

std::vector<std::vector<Parameter>> bands(const std::vector<Parameter>& declared, bool) {
  std::vector<Parameter> own = declared;
  for (std::size_t k = 1; k < own.size(); ++k) own[k].size = 1e-8;
  return {own};
}

}  // namespace

const ReflectanceBinding& surface_fluorescence() {
  static const ReflectanceBinding binding{.mechanism = mechanism::surface_fluorescence,
                                          .order = 100,
                                          .kind = ReflectanceSlot::Kind::fluorescence,
                                          .shows = shows_excitation,
                                          .ranges = bands};
  return binding;
}

}  // namespace gonio::explain::tables::reflectance
