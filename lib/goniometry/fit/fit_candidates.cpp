// See fit_candidates.h. Variants free or hold what a model's parameters offer:
//   second_share, second_alpha                a second population of facets
//   retro, retro_alpha, retro_falloff         light sent back to the lamp, counted as a lobe
//   anisotropy_0, anisotropy_45; anisotropy, azimuth_rad     a direction; where both are offered, the first, which has
//                                             no jump where the sample has none
//   sigma_rad                                 a rough matte base, by Oren & Nayar's qualitative law (matte_form 0)
// Held always: lengths that only their ratios' slopes show (wavelength_u_m), masking as derived (projections), and
// residue on reliefs (residue_share, residue_alpha), which is a hypothesis of explain's.
#include "goniometry/fit/fit_candidates.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace gonio::goniometry {
namespace {

struct Variant {
  bool second = false, retro = false, direction = false, rough_base = false;
};

bool has(const surface::Model& model, const std::string& name) {
  return std::ranges::any_of(model.info().parameters, [&](const auto& p) { return p.name == name; });
}
bool relief(const surface::Model& model) {
  return has(model, "ridge_rad") || has(model, "amplitude_m");
}

std::string words(const Variant& v) {
  std::string text;
  const auto add = [&](bool when, const char* word) {
    if (when) text += (text.empty() ? "" : ", ") + std::string(word);
  };
  add(v.second, "two lobes");
  add(v.retro, "light sent back");
  add(v.direction, "anisotropic");
  add(v.rough_base, "rough base");
  return text;
}

bool freed(const surface::Model& model, const std::string& name, const Variant& v) {
  if (name.starts_with("second_")) return v.second;
  if (name.starts_with("retro")) return v.retro;
  if (name == "sigma_rad") return v.rough_base;
  if (name == "anisotropy_0" || name == "anisotropy_45") return v.direction;
  if (name == "anisotropy") return v.direction && !has(model, "anisotropy_0");
  if (name == "azimuth_rad") return relief(model) || (v.direction && !has(model, "anisotropy_0"));
  return name != "wavelength_u_m" && name != "matte_form" && name != "projections" && !name.starts_with("residue_");
}

double held_value(const manifest::ParameterInfo& p) {
  if (p.name == "wavelength_u_m") return 1e-4;
  if (p.preset) return *p.preset;
  return std::clamp(0.5, p.lower, p.upper);
}

Candidate candidate_of(const surface::Model& model, const Variant& v, double least) {
  Candidate c;
  c.model = &model;
  c.variant = words(v);
  c.lobes = 1 + (v.second ? 1 : 0) + (v.retro ? 1 : 0);
  const auto& parameters = model.info().parameters;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const auto& p = parameters[i];
    const double held = held_value(p);
    c.held.v[i] = {held, held, held};
    if (!freed(model, p.name, v)) continue;
    Slot slot{.parameter = i, .lower = p.lower, .upper = p.upper};
    const bool width = p.name.starts_with("alpha") || p.name == "second_alpha";
    if (width) slot.lower = std::max({slot.lower, least, 1e-4});
    slot.logarithmic = width || p.name.ends_with("_m");
    slot.periodic = p.name == "azimuth_rad";
    // Axes of roughness are lines: half a turn brings the same surface back, and one number stands for both.
    if (slot.periodic && !relief(model)) slot.lower = -pi / 2, slot.upper = pi / 2;
    // Shares of nothing and of all have no slope by what they share.
    if (p.name == "anisotropy") slot.upper = 0.98;
    (p.components == 3 ? c.colours : c.shared).push_back(slot);
  }
  return c;
}

std::vector<Variant> variants(const surface::Model& model, const FitOptions& options, bool anisotropic) {
  if (relief(model)) return {Variant{}};
  const bool second = has(model, "second_share"), retro = has(model, "retro"), base = has(model, "sigma_rad"),
             direction = anisotropic && (has(model, "anisotropy") || has(model, "anisotropy_0"));
  std::vector<Variant> all;
  for (int k = 0; k < 16; ++k) {
    const Variant v{(k & 1) != 0, (k & 2) != 0, (k & 4) != 0, (k & 8) != 0};
    if ((v.second && !second) || (v.retro && !retro) || (v.direction && !direction) || (v.rough_base && !base))
      continue;
    if (1 + int{v.second} + int{v.retro} > options.lobes) continue;
    // What a simpler model says in the same way.
    if (second && !v.second && !v.retro && !v.direction && options.models.empty()) continue;
    if (v.rough_base && v.direction && options.models.empty()) continue;
    all.push_back(v);
  }
  return all;
}

std::string known() {
  std::string ids;
  for (const surface::Model* model : surface::all_models()) ids += (ids.empty() ? "" : ", ") + model->info().id;
  return ids;
}

std::string refusal(const surface::Model& model, const FitOptions& options, bool anisotropic) {
  const manifest::ModelInfo& info = model.info();
  if (info.attachment != manifest::Attachment::none) return "its numbers are a table: reconstruct one instead";
  if (info.takes_base)
    return "it lies on another surface, whose numbers it shares: interfaced-diffuse is the matte case";
  if (model.thin()) return "light passes through it, and a reflectance shows a part: diffuse is what it reflects";
  if (model.transmits()) return "light passes through it, and a reflectance shows a part: metal has the same lobe";
  if (has(model, "sigma_s_per_m"))
    return "light leaves it elsewhere than it entered: interfaced-diffuse is its limit for wide light";
  if (has(model, "sheen")) return "its parts are other models: glossy, metal, glossy-metal";
  if (relief(model) && !anisotropic && options.models.empty()) return "it needs samples that turn about the normal";
  if (relief(model) && has(model, "amplitude_m") && options.models.empty())
    return "slow and seldom: name it to have it fitted";
  return {};
}

}  // namespace

std::vector<Candidate> candidates(const FitOptions& options, bool anisotropic, double least, const std::string& place,
                                  std::vector<Refusal>& refusals) {
  std::vector<const surface::Model*> models;
  for (const std::string& id : options.models) {
    models.push_back(surface::find(id));
    if (models.back() == nullptr)
      throw Error(Exit::data, place, "there is no surface model \"" + id + "\"", "one of " + known());
  }
  if (options.models.empty()) models.assign(surface::all_models().begin(), surface::all_models().end());
  std::vector<Candidate> all;
  for (const surface::Model* model : models) {
    const std::string why = refusal(*model, options, anisotropic);
    if (!why.empty()) {
      refusals.push_back({model->info().id, "", why});
      continue;
    }
    for (const Variant& v : variants(*model, options, anisotropic)) all.push_back(candidate_of(*model, v, least));
  }
  std::ranges::stable_sort(all, {}, [](const Candidate& c) { return c.shared.size() + 2 * c.colours.size(); });
  return all;
}

}  // namespace gonio::goniometry
