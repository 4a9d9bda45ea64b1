#include "surface/dipole_model.h"

#include <algorithm>
#include <cmath>

#include "surface/polarization.h"

namespace gonio::surface {
namespace {

constexpr double left_out = 1e-3;  // of the energy: what enters farther away than the reach

DipoleInterface interface_of(const Values& values) {
  return {values.scalar(dipole_eta), values.scalar(dipole_alpha)};
}
DipoleMedium medium_of(const Values& values, int i) {
  return {values.rgb(dipole_sigma_a)[i], values.rgb(dipole_sigma_s)[i], values.rgb(dipole_g)[i]};
}
Rgb grey(double x) {
  return {x, x, x};
}

}  // namespace

double standard_reflectance(const DipoleMedium& medium, const InteriorFresnel& interior) {
  if (!medium.scatters()) return 0;
  const auto [real_m, virtual_m] = standard_depths(medium, interior);
  return medium.albedo_reduced / 2 * (std::exp(-medium.sigma_tr * real_m) + std::exp(-medium.sigma_tr * virtual_m));
}

std::array<double, 2> standard_depths(const DipoleMedium& medium, const InteriorFresnel& interior) {
  const double reflected = 1 - 4 * interior.c_phi, real_m = 1 / medium.sigma_t_reduced;
  return {real_m, real_m + 4 * (1 + reflected) / (1 - reflected) * medium.diffusion_m};
}

std::vector<manifest::ParameterInfo> dipole_parameters() {
  return {{.name = "eta",
           .unit = "1",
           .preset = 1.5,
           .lower = 1,
           .upper = 2.6,
           .meaning = "refractive index of the medium over that of what surrounds it"},
          {.name = "alpha",
           .unit = "1",
           .preset = 0.1,
           .lower = 0,
           .upper = max_alpha,
           .meaning = "GGX roughness of the interface; below 0.02 it is smooth"},
          {.name = "sigma_a_per_m",
           .unit = "1/m",
           .components = 3,
           .rgb = true,
           .preset = {},
           .lower = 0,
           .upper = 1e7,
           .meaning = "absorption coefficient of the medium at red, green and blue; the same everywhere"},
          {.name = "sigma_s_per_m",
           .unit = "1/m",
           .components = 3,
           .rgb = true,
           .preset = {},
           .lower = 0,
           .upper = 1e7,
           .meaning = "scattering coefficient of the medium at red, green and blue; the same everywhere"},
          {.name = "g",
           .unit = "1",
           .components = 3,
           .rgb = true,
           .preset = 0,
           .lower = -0.95,
           .upper = 0.99,
           .meaning = "mean cosine of the scattering angle; the same everywhere"}};
}

DipoleSubsurface::DipoleSubsurface(const Values& values, bool directional)
    : eta_(values.scalar(dipole_eta)),
      normaliser_(1 / (pi * (1 - interface_of(values).reflects_mean()))),
      directional_(directional),
      interior_(eta_),
      media_{medium_of(values, 0), medium_of(values, 1), medium_of(values, 2)} {}

Entrance DipoleSubsurface::enter(const Values& values, Vec3 wi, Vec2 u) const {
  const DipoleInterface interface = interface_of(values);
  if (directional_) return interface.enter(wi, u);
  return {1 - interface.reflects(wi.z), refracted_inwards(wi, {0, 0, 1}, eta_)};
}

Entrance DipoleSubsurface::leave(const Values& values, Vec3 travel, Vec2 u) const {
  return interface_of(values).leave(travel, u);
}

void DipoleSubsurface::set_distances(int band, const Sources& sources) {
  const DipoleMedium& medium = this->medium(band);
  if (!medium.scatters()) return;
  DipoleDistances& distances = distances_[static_cast<std::size_t>(band)];
  distances = DipoleDistances(sources, medium.sigma_tr);
  reach_m_ = std::max(reach_m_, distances.reach_m(left_out));
}

void DipoleSubsurface::finish_distances() {
  for (std::size_t i = 0; i < 3; ++i) {  // bands that do not scatter use another's
    for (std::size_t k = 1; k < 3 && !media_[i].scatters(); ++k)
      if (media_[(i + k) % 3].scatters()) {
        distances_[i] = distances_[(i + k) % 3];
        break;
      }
    distances_[i].cut(reach_m_);
  }
}

Rgb DipoleModel::reflectance(const Values& values) const {
  if (const auto* built = static_cast<const DipoleSubsurface*>(values.prepared)) return built->diffuse_reflectance();
  const InteriorFresnel interior(values.scalar(dipole_eta));
  return {standard_reflectance(medium_of(values, 0), interior), standard_reflectance(medium_of(values, 1), interior),
          standard_reflectance(medium_of(values, 2), interior)};
}

double DipoleModel::share(const Values& values, Vec3 wo) const {
  const auto* built = static_cast<const DipoleSubsurface*>(values.prepared);
  const double reflects = interface_of(values).reflects(wo.z);
  double comes_back = built ? std::min(1.0, mean(built->diffuse_reflectance())) : 0.5;
  if (built && built->straight()) comes_back = std::max(comes_back, 0.2);
  const double below = (1 - reflects) * comes_back;
  return below > 0 ? reflects / (reflects + below) : 1;
}

Rgb DipoleModel::evaluate(const Values& values, Vec3 wo, Vec3 wi) const {
  return wo.z > 0 && wi.z > 0 ? grey(interface_of(values).lobe(wo, wi)) : Rgb{};
}

Sample DipoleModel::sample(const Values& values, Vec3 wo, Vec2 u, double u_lobe) const {
  return wo.z > 0 ? interface_of(values).sample(wo, u, u_lobe, share(values, wo)) : Sample{};
}

double DipoleModel::pdf(const Values& values, Vec3 wo, Vec3 wi) const {
  return wo.z > 0 && wi.z > 0 ? share(values, wo) * interface_of(values).lobe_pdf(wo, wi) : 0;
}

optics::MuellerRgb DipoleModel::mueller(const Values& values, Vec3 wo, Vec3 wi) const {
  const optics::Mueller facet = dielectric_facet(values.scalar(dipole_eta), wo, wi);
  return {facet, facet, facet};
}

Rgb DipoleModel::albedo(const Values& values, Vec3 wo) const {
  if (wo.z <= 0) return {};
  const double reflects = interface_of(values).reflects(wo.z);
  return grey(reflects) + reflectance(values) * (1 - reflects);
}

const Subsurface* DipoleModel::subsurface(const Values& values) const {
  const auto* built = static_cast<const DipoleSubsurface*>(values.prepared);
  return built && (built->scatters() || built->straight()) ? built : nullptr;
}

std::shared_ptr<const Prepared> DipoleModel::prepare(const Values& values, const std::filesystem::path&,
                                                     const std::string&) const {
  return build(values);
}

}  // namespace gonio::surface
