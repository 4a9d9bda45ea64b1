// surface.subsurface: a matte surface becomes a half space of the same albedo with the given diffuse mean free paths
// and no interface; a coated one, of which the albedo is that seen through the interface, keeps its own. The standard
// dipole spreads the light.
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "scene/edit.h"
#include "surface/dipole_model.h"
#include "surface/fresnel.h"

namespace gonio::mechanism {
const Mechanism& surface_subsurface();
}

namespace gonio::scene::edits {
namespace {

// Of a parameter that is one number; nothing where the model has none of that name.
std::optional<double> value_of(const Surface& surface, const char* name) {
  const auto& own = surface.model->info().parameters;
  const auto found = std::ranges::find(own, name, &manifest::ParameterInfo::name);
  if (found == own.end()) return {};
  return surface.values.scalar(static_cast<std::size_t>(found - own.begin()));
}

// Lambert's law alone: the roughness of a matte surface would be lost.
bool can_scatter(const Surface& surface) {
  const std::string& id = surface.model->info().id;
  if ((id != "diffuse" && id != "coated-diffuse") || surface.varies() || surface.base) return false;
  return value_of(surface, "sigma_rad").value_or(0) == 0;
}
double single_albedo(double albedo, double eta) {  // the alpha' at which diffusion theory sends back `albedo`
  const surface::InteriorFresnel interior(eta);
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
  const double f0 = value_of(surface, "f0").value_or(0), eta = f0 > 0 ? surface::eta_of_f0(f0) : 1;
  const std::optional<double> alpha = value_of(surface, "alpha");
  std::vector<double> absorbs, scatters;
  for (int c = 0; c < 3; ++c) {
    const double a = std::min(single_albedo(albedo[c], eta), 1 - 1e-6);
    const double per_m = 1 / (std::max(shortest_m, amounts[static_cast<std::size_t>(c)]) * std::sqrt(3 * (1 - a)));
    absorbs.push_back((1 - a) * per_m);
    scatters.push_back(a * per_m);
  }
  surface.model = surface::find("dipole");
  surface.parameters = {{"eta", manifest::Parameter(eta)},
                        {"sigma_a_per_m", manifest::Parameter(absorbs)},
                        {"sigma_s_per_m", manifest::Parameter(scatters)}};
  if (f0 > 0 && alpha) surface.parameters["alpha"] = manifest::Parameter(*alpha);
}

}  // namespace

const Edit& surface_subsurface() {
  static const Edit edit{.mechanism = mechanism::surface_subsurface, .fits_surface = can_scatter, .surface = scatter};
  return edit;
}

}  // namespace gonio::scene::edits
