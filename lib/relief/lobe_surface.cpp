// See lobe_surface.h.
#include "relief/lobe_surface.h"

#include <algorithm>
#include <cmath>

#include "surface/slopes.h"

namespace gonio::relief {
namespace {

const std::string beckmann = "beckmann-";

double number(const manifest::Parameters& parameters, const manifest::ModelInfo& info, const char* name) {
  if (const auto found = parameters.find(name); found != parameters.end()) return found->second.scalar();
  const auto declared = std::ranges::find(info.parameters, name, &manifest::ParameterInfo::name);
  return declared == info.parameters.end() ? 0 : declared->preset.value_or(0);
}

bool has(const manifest::ModelInfo& info, const char* name) {
  return std::ranges::find(info.parameters, name, &manifest::ParameterInfo::name) != info.parameters.end();
}

// The facets' model, or its sibling of the other distribution.
std::string model_for(const std::string& facets, const std::string& distribution) {
  const std::string plain = facets.starts_with(beckmann) ? facets.substr(beckmann.size()) : facets;
  const std::string wanted = distribution == "beckmann" ? beckmann + plain : plain;
  return surface::find(wanted) != nullptr ? wanted : facets;
}

const SlopeFit& fit_for(const std::string& model, const Normals& normals) {
  const std::string distribution = model.starts_with(beckmann) ? "beckmann" : "ggx";
  for (const SlopeFit& fit : normals.fits)
    if (fit.distribution == distribution) return fit;
  return normals.fits.front();
}

// alpha and anisotropy of the model from the two widths, with sigmas to first order.
void enter_roughness(manifest::Surface& surface, double along, double across, double sigma_along, double sigma_across) {
  const double ratio = along > 0 ? across / along : 1;
  surface.parameters["alpha"] = along;
  surface.parameters["anisotropy"] = std::clamp((1 - ratio) / 0.9, 0.0, 1.0);
  surface.sigma["alpha"] = {sigma_along};
  if (along > 0) surface.sigma["anisotropy"] = {std::hypot(ratio * sigma_along, sigma_across) / along / 0.9};
}

// Mean over a cell of the table, 3 x 3 places.
Rgb mean_over(const surface::Model& model, const surface::Values& values, Vec3 wi, const LobeTable& lobe, int theta,
              int phi) {
  Rgb sum;
  for (const double t : {-1.0, 0.0, 1.0})
    for (const double p : {-1.0, 0.0, 1.0})
      sum += model.evaluate(values,
                            direction_of(lobe.theta_rad(theta) + t / 3 * pi / 2 / lobe.theta_cells,
                                         lobe.phi_rad(phi) + p / 3 * 2 * pi / lobe.phi_cells),
                            wi);
  return sum / 9;
}

}  // namespace

RoughSurface surface_of(const std::string& facets, const manifest::Parameters& parameters, const Normals& normals) {
  const surface::Model* own = surface::find(facets);
  if (own == nullptr || normals.fits.empty()) return {{}, "there are no normals", false};
  const manifest::ModelInfo& info = own->info();
  if (!has(info, "alpha") || !has(info, "anisotropy") || !has(info, "azimuth_rad"))
    return {{}, "\"" + facets + "\" has no roughness that slopes could add to", false};
  if (number(parameters, info, "anisotropy") > 0) return {{}, "the facets have an axis of their own", false};
  manifest::Surface surface;
  surface.model = model_for(facets, normals.fits.front().distribution);
  surface.parameters = parameters;
  const SlopeFit& fit = fit_for(surface.model, normals);
  const double alpha = number(parameters, info, "alpha");
  const double along = std::hypot(fit.alpha_u, alpha), across = std::hypot(fit.alpha_v, alpha);
  if (along > 1) return {{}, "the map is rougher than alpha = 1", false};
  const auto passed_on = [](double part, double whole, double sigma) {
    return whole > 0 ? sigma * part / whole : sigma;
  };
  enter_roughness(surface, along, across, passed_on(fit.alpha_u, along, fit.sigma_alpha_u),
                  passed_on(fit.alpha_v, across, fit.sigma_alpha_v));
  surface.parameters["azimuth_rad"] = fit.azimuth_rad;
  surface.sigma["azimuth_rad"] = {fit.sigma_azimuth_rad};
  return {surface, {}, across < 0.1 * along};
}

std::optional<double> log1p_rms(const manifest::Surface& surface, const std::vector<TracedLobe>& lobes) {
  constexpr double steepest = 85 * pi / 180;
  if (surface.parameters.at("alpha").scalar() < surface::smooth_alpha) return {};
  const Material material = material_of(surface.model, surface.parameters, "surface");
  double squares = 0;
  std::size_t count = 0;
  for (const auto& [wi, lobe] : lobes)
    for (int t = 0; t < lobe.theta_cells && lobe.theta_rad(t) < steepest; ++t)
      for (int p = 0; p < lobe.phi_cells; ++p) {
        const Rgb modelled = mean_over(*material.model, material.values, wi, lobe, t, p);
        const Rgb traced = lobe.table[static_cast<std::size_t>(t * lobe.phi_cells + p)].value;
        const double cosines = 100 * wi.z * std::cos(lobe.theta_rad(t));
        for (int c = 0; c < 3; ++c, ++count)
          squares += std::pow(std::log1p(cosines * traced[c]) - std::log1p(cosines * modelled[c]), 2);
      }
  return count > 0 ? std::optional(std::sqrt(squares / static_cast<double>(count))) : std::nullopt;
}

}  // namespace gonio::relief
