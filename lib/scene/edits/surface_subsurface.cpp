// surface.subsurface: a matte surface becomes a half space of the same albedo with the given diffuse mean free paths
// and no interface; the standard dipole spreads the light.
#include <algorithm>
#include <cmath>
#include <vector>

#include "scene/edit.h"
#include "surface/dipole_model.h"

namespace gonio::mechanism {
const Mechanism& surface_subsurface();
}

namespace gonio::scene::edits {
namespace {

// Lambert's law alone: the roughness of a matte surface would be lost.
bool can_scatter(const Surface& surface) {
  if (surface.model->info().id != "diffuse" || surface.varies() || surface.base) return false;
  const auto& own = surface.model->info().parameters;
  const auto rough = std::ranges::find(own, "sigma_rad", &manifest::ParameterInfo::name);
  return rough == own.end() || surface.values.scalar(static_cast<std::size_t>(rough - own.begin())) == 0;
}
double single_albedo(double albedo) {  // the alpha' at which diffusion theory sends back `albedo`
  const surface::InteriorFresnel interior(1);
  double low = 0, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (surface::standard_reflectance({1 - middle, middle, 0}, interior) < albedo ? low : high) = middle;
  }
  return 0.5 * (low + high);
}
void scatter(Surface& surface, const Amounts& amounts) {
  constexpr double shortest_m = 1e-6;  // of a band without: far below any pixel
  const Rgb albedo = surface.values.rgb(0);
  std::vector<double> absorbs, scatters;
  for (int c = 0; c < 3; ++c) {
    const double a = std::min(single_albedo(albedo[c]), 1 - 1e-6);
    const double per_m = 1 / (std::max(shortest_m, amounts[static_cast<std::size_t>(c)]) * std::sqrt(3 * (1 - a)));
    absorbs.push_back((1 - a) * per_m);
    scatters.push_back(a * per_m);
  }
  surface.model = surface::find("dipole");
  surface.parameters = {{"eta", manifest::Parameter(1.0)},
                        {"sigma_a_per_m", manifest::Parameter(absorbs)},
                        {"sigma_s_per_m", manifest::Parameter(scatters)}};
}

}  // namespace

const Edit& surface_subsurface() {
  static const Edit edit{.mechanism = mechanism::surface_subsurface, .fits_surface = can_scatter, .surface = scatter};
  return edit;
}

}  // namespace gonio::scene::edits
