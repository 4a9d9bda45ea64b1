// See reflectance_surface.h.
#include "explain/tables/reflectance_surface.h"

#include <algorithm>
#include <cmath>

#include "surface/fresnel.h"
#include "surface/mechanisms/surface_fluorescence.h"
#include "surface/microfacet.h"
#include "surface/thin_film.h"

namespace gonio::explain::tables {
namespace {

constexpr double reference_f0 = 0.04;  // at which the lobes are read off: their shape does not depend on it

void set(surface::Values& values, std::optional<std::size_t> place, double value) {
  if (place) values.v[*place] = {value, value, value};
}

}  // namespace

std::optional<std::size_t> parameter_place(const surface::Model& model, const std::string& name) {
  const auto& all = model.info().parameters;
  const auto found = std::find_if(all.begin(), all.end(), [&](const auto& p) { return p.name == name; });
  if (found == all.end()) return {};
  return static_cast<std::size_t>(found - all.begin());
}

SurfacePlaces::SurfacePlaces(const surface::Model& model)
    : albedo(parameter_place(model, "albedo")),
      f0(parameter_place(model, "f0")),
      alpha(parameter_place(model, "alpha")),
      retro(parameter_place(model, "retro")),
      dielectric(f0 && model.info().parameters[*f0].components == 1) {}

ReflectanceEvaluation::ReflectanceEvaluation(const ReflectanceState& state, const ReflectanceRows& rows)
    : state_(state), rows_(rows), places_(*state.model) {
  if (state.film.film_m == 0 && state.ridges.share == 0) return;
  incidence_.resize(rows.band_name.size());
  for (const surface::Values& values : state.triples) {
    surface::Values bare = values;
    set(bare, places_.albedo, 0);
    set(bare, places_.retro, 0);
    bare_.push_back(bare);
    if (places_.dielectric) set(bare, places_.f0, reference_f0);
    glazed_.push_back(bare);
  }
  if (state.ridges.share == 0) return;
  const double alpha = std::max(0.02, state.triples[0].scalar(*places_.alpha)),
               azimuth = state.ridges.azimuth_rad - pi / 2;
  for (const double turn : {0.0, pi}) saws_.emplace_back(state.ridges.tilt_rad, alpha, alpha, azimuth + turn);
}

const ReflectanceEvaluation::Shared& ReflectanceEvaluation::look(std::size_t row, std::size_t triple) {
  const Vec3 wo = rows_.wo[row], wi = rows_.wi[row];
  const bool seen = last_.row < rows_.rows() && rows_.wo[last_.row] == wo && rows_.wi[last_.row] == wi;
  if (seen && last_.triple == triple) return last_;
  last_.row = row, last_.triple = triple;
  last_.f = last_.gloss = {};
  if (!(rows_.weight[row] > 0)) return last_;
  last_.f = state_.model->evaluate(state_.triples[triple], wo, wi);
  if (state_.ridges.share > 0) last_.gloss = state_.model->evaluate(bare_[triple], wo, wi);
  if (state_.film.film_m > 0 && !seen) look_beneath_film(row, triple);
  return last_;
}

// What a clear interface without its base is like is the same in all bands.
void ReflectanceEvaluation::look_beneath_film(std::size_t row, std::size_t triple) {
  const Vec3 wo = rows_.wo[row], wi = rows_.wi[row];
  const double eta = surface::eta_of_f0(f0(3 * triple));  // of a clear interface, the same in all bands
  last_.lobes = state_.model->evaluate(glazed_[triple], wo, wi);
  last_.half_cosine = surface::half_cosine(wo, wi);
  last_.reference = surface::fresnel_dielectric(last_.half_cosine, surface::eta_of_f0(reference_f0));
  last_.plain = surface::fresnel_dielectric(last_.half_cosine, eta);
  last_.passes = (1 - surface::fresnel_dielectric(wi.z, eta)) * (1 - surface::fresnel_dielectric(wo.z, eta));
}

double ReflectanceEvaluation::f0(std::size_t band) const {
  return state_.triples[band / 3].rgb(*places_.f0)[static_cast<int>(band % 3)];
}

double ReflectanceEvaluation::fresnel(std::size_t band, double cosine) const {
  const double at_normal = f0(band);
  if (places_.dielectric) return surface::fresnel_dielectric(cosine, surface::eta_of_f0(at_normal));
  return surface::fresnel_schlick(cosine, {at_normal, at_normal, at_normal}).x;
}

double ReflectanceEvaluation::coated(std::size_t band, double cosine) const {
  return surface::fresnel_film(cosine, surface::eta_of_f0(f0(band)), state_.film.film_eta, state_.film.film_m,
                               rows_.band_m[band]);
}

double ReflectanceEvaluation::film(std::size_t row, std::size_t band, double f, const Shared& shared) const {
  Incidence& in = incidence_[band];
  if (in.cosine != rows_.wi[row].z) in = {rows_.wi[row].z, coated(band, rows_.wi[row].z)};
  const double lobes = shared.lobes[static_cast<int>(band % 3)] / shared.reference;
  const double base = f - lobes * shared.plain;
  const double passes = (1 - in.coated) * (1 - coated(band, rows_.wo[row].z)) / shared.passes;
  return f + lobes * (coated(band, shared.half_cosine) - shared.plain) + base * (passes - 1);
}

double ReflectanceEvaluation::ridged(std::size_t row, std::size_t band, const Shared& shared) const {
  const Vec3 wo = rows_.wo[row], wi = rows_.wi[row];
  double lobe = 0;
  for (const surface::Ridges& saw : saws_) {
    const Vec3 wof = saw.to_facet(wo), wif = saw.to_facet(wi);
    if (wof.z > 0 && wif.z > 0) lobe += 0.5 * saw.lobe(wo, wi, wof, wif);
  }
  const double gloss = shared.gloss[static_cast<int>(band % 3)];
  return state_.ridges.share * (fresnel(band, surface::half_cosine(wo, wi)) * lobe - gloss);
}

double ReflectanceEvaluation::value(std::size_t row, std::size_t band, const Shared& shared) const {
  if (!(rows_.weight[row] > 0)) return 0;
  double f = shared.f[static_cast<int>(band % 3)];
  if (state_.film.film_m > 0) f = film(row, band, f, shared);
  if (state_.ridges.share > 0) f += ridged(row, band, shared);
  const FluorescenceTerm& glow = state_.fluorescence;
  if (glow.emission > 0)
    f += equation::surface_fluorescence(glow.emission, glow.centre_m, glow.width_m, rows_.band_m[band]) *
         rows_.excitation[row];
  return state_.gain * f;
}

}  // namespace gonio::explain::tables
