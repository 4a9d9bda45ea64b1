// Surfaces as other renderers see them (scene/exchange/look.h).
//
// Oren & Nayar's matte (surface/oren_nayar.h) is A (1 + B / A s / t), s = wi.wo - wiz woz and t = max(wiz, woz) for
// s > 0; for s < 0 it is A.
#include "scene/exchange/look.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "surface/dipole_model.h"
#include "surface/fresnel.h"
#include "surface/oren_nayar.h"

namespace gonio::scene {
namespace {

// A surface's values by the names of its parameters.
class Named {
 public:
  explicit Named(const Surface& surface) : surface_(surface) {}
  bool has(std::string_view name) const { return index(name) >= 0; }
  Rgb rgb(std::string_view name, Rgb otherwise = {}) const {
    const int i = index(name);
    return i >= 0 ? surface_.values.rgb(static_cast<std::size_t>(i)) : otherwise;
  }
  double scalar(std::string_view name, double otherwise = 0) const {
    return rgb(name, {otherwise, otherwise, otherwise}).x;
  }

 private:
  int index(std::string_view name) const {
    const auto& all = surface_.model->info().parameters;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (all[i].name == name) return static_cast<int>(i);
    return -1;
  }
  const Surface& surface_;
};

double index_of_f0(double f0) {
  const double r = std::sqrt(std::clamp(f0, 0.0, 0.999));
  return (1 + r) / (1 - r);
}

Rgb reflectance_of_metal(Rgb eta, Rgb k) {
  const auto one = [](double n, double kk) { return ((n - 1) * (n - 1) + kk * kk) / ((n + 1) * (n + 1) + kk * kk); };
  return {one(eta.x, k.x), one(eta.y, k.y), one(eta.z, k.z)};
}

void add_roughness(Look& look, const Named& named, const surface::Model& model) {
  const double both = named.scalar("alpha");
  look.alpha_x = named.scalar("alpha_x", both);
  look.alpha_y = named.scalar("alpha_y", look.alpha_x * (1 - 0.9 * named.scalar("anisotropy")));
  look.azimuth_rad = named.scalar("azimuth_rad");
  look.beckmann = model.info().id.find("beckmann") != std::string::npos || named.scalar("beckmann") > 0;
}

void make_translucent(Look& look, const Named& named, const surface::Subsurface& subsurface) {
  look.kind = Look::Kind::translucent;
  surface::Medium& medium = look.medium;
  medium.eta = named.rgb("eta", {1.3, 1.3, 1.3});
  medium.sigma_a_per_m = named.rgb("sigma_a_per_m");
  medium.sigma_s_per_m = named.rgb("sigma_s_per_m");
  medium.g = named.rgb("g");
  look.eta = level(medium.eta);
  const auto length = [](double sigma_a, double sigma_s, double g) {
    const double sigma_t = sigma_a + sigma_s * (1 - g);
    return 1 / std::sqrt(std::max(3 * sigma_a * sigma_t, 1e-12 * sigma_t * sigma_t + 1e-30));
  };
  const Rgb &a = medium.sigma_a_per_m, &s = medium.sigma_s_per_m, &g = medium.g;
  look.diffuse_length_m = {length(a.x, s.x, g.x), length(a.y, s.y, g.y), length(a.z, s.z, g.z)};
  if (const auto* dipole = dynamic_cast<const surface::DipoleSubsurface*>(&subsurface)) {
    const Rgb& r = dipole->diffuse_reflectance();
    look.colour = {std::min(r.x, 1.0), std::min(r.y, 1.0), std::min(r.z, 1.0)};
  }
}

void make_metal(Look& look, const Named& named) {
  look.kind = Look::Kind::metal;
  look.complex_index = named.has("k");
  look.metal_eta = named.rgb("eta");
  look.metal_k = named.rgb("k");
  look.colour = look.complex_index ? reflectance_of_metal(look.metal_eta, look.metal_k) : named.rgb("f0");
}

void make_matte(Look& look, const Named& named) {
  look.colour = named.rgb("albedo");
  look.sigma_rad = named.scalar("sigma_rad");
  look.own_albedo = named.has("eta");  // interfaced-diffuse states the base itself, coated-diffuse what is seen of it
  const double f0 = named.scalar("f0");
  const bool interface = f0 > 0 || (look.own_albedo && named.scalar("eta") > 1);
  look.kind = interface ? Look::Kind::coated : Look::Kind::matte;
  look.eta = named.has("f0") ? index_of_f0(f0) : named.scalar("eta", 1);
  if (look.own_albedo) look.colour = albedo_through(look.colour, mean_internal_reflectance(look.eta));
}

// Surfaces whose parameters say more than a look can hold are none of those below; what stands at its preset says
// nothing.
bool says_more(const Surface& surface) {
  static const std::set<std::string_view> known = {
      "albedo", "alpha",         "alpha_x",       "alpha_y",   "anisotropy",  "azimuth_rad",      "eta", "f0", "g",
      "k",      "sigma_a_per_m", "sigma_s_per_m", "sigma_rad", "thickness_m", "single_scattering"};
  const auto at_preset = [&](const manifest::ParameterInfo& p) {
    if (!p.preset) return false;
    const auto found = surface.parameters.find(p.name);
    if (found == surface.parameters.end() || !found->second.given()) return true;
    return std::ranges::all_of(found->second.value, [&](double v) { return v == *p.preset; });
  };
  return std::ranges::any_of(surface.model->info().parameters,
                             [&](const auto& p) { return !known.contains(p.name) && !at_preset(p); });
}

void lose(std::vector<Loss>& losses, const std::string& pointer, std::string what, std::string instead) {
  losses.push_back({pointer, std::move(what), std::move(instead)});
}

// Of glass and translucent bodies, whose Rgb indices one number must stand for.
void check_dispersion(const Look& look, const std::string& pointer, std::vector<Loss>& losses) {
  if (look.medium.disperses()) lose(losses, pointer, "an index per band (dispersion)", "their mean");
}

// A matte with the surface's albedo.
void make_unlike(Look& look, const Appearance& appearance, const Surface& surface, std::vector<Loss>& losses) {
  surface::Values values = surface.values;
  surface::Layer base;
  if (surface.base) {
    const Surface& beneath = appearance.surfaces[*surface.base];
    base = {beneath.model, beneath.values};
    values.base = &base;
  }
  look = {};
  look.colour = surface.model->albedo(values, {std::sqrt(0.5), 0, std::sqrt(0.5)});
  lose(losses, "/surfaces/" + surface.id + "/model", "the surface model \"" + surface.model->info().id + "\"",
       "a matte with its albedo at 45 degrees");
}

// A coat over `base`. Over a matte it is an interface to it; light passes an absorbing coat twice.
void make_coat(Look& look, const Named& named, const Look& base, const std::string& pointer,
               std::vector<Loss>& losses) {
  const double eta = named.scalar("eta", 1), alpha = look.alpha_x;
  const Rgb depth = named.rgb("sigma_a_per_m") * named.scalar("thickness_m");
  look = base;
  if (max_component(depth) > 0) {
    const Rgb passed{std::exp(-2 * depth.x), std::exp(-2 * depth.y), std::exp(-2 * depth.z)};
    lose(losses, pointer + "/sigma_a_per_m", "absorption within a coat", "a base darker by it, as seen straight on");
    look.colour *= passed;
    look.complex_index = false;
  }
  if (!(eta > 1)) return;
  if (base.kind == Look::Kind::matte) {
    look.kind = Look::Kind::coated;
    look.own_albedo = true;
    look.eta = eta;
    look.alpha_x = look.alpha_y = alpha;
    look.colour = albedo_through(look.colour, mean_internal_reflectance(eta));
  } else if (base.kind == Look::Kind::metal && base.coat_eta == 0) {
    look.coat_eta = eta;
    look.coat_alpha = alpha;
  } else {
    lose(losses, pointer + "/base", "a coat over such a surface", "the surface beneath alone");
  }
}

}  // namespace

RoughMatte rough_matte(double sigma_rad) {
  const surface::OrenNayar law(sigma_rad);
  const Vec3 up{0, 0, 1}, tilted{std::sqrt(0.5), 0, std::sqrt(0.5)};
  const double a = law.shape(up, up);  // s = 0
  // wi = wo = tilted: s = 1/2, t = sqrt(1/2)
  return {a, (law.shape(tilted, tilted) / a - 1) * std::sqrt(2.0)};
}

// 1 - (1 - F_ext) / eta^2 with F_ext = 2 integral of F(c) c dc, by the midpoint rule.
double mean_internal_reflectance(double eta) {
  constexpr int steps = 2000;
  double outside = 0;
  for (int i = 0; i < steps; ++i) {
    const double c = (i + 0.5) / steps;
    outside += 2 * surface::fresnel_dielectric(c, eta) * c / steps;
  }
  return 1 - (1 - outside) / (eta * eta);
}

Look look_of(const Appearance& appearance, const Surface& surface, std::vector<Loss>& losses) {
  const Named named(surface);
  const surface::Model& model = *surface.model;
  const std::string pointer = "/surfaces/" + surface.id;
  Look look;
  add_roughness(look, named, model);
  if (says_more(surface)) {
    make_unlike(look, appearance, surface, losses);
  } else if (surface.base) {
    make_coat(look, named, look_of(appearance, appearance.surfaces[*surface.base], losses), pointer, losses);
  } else if (const surface::Subsurface* subsurface = model.subsurface(surface.values)) {
    make_translucent(look, named, *subsurface);
    check_dispersion(look, pointer, losses);
  } else if (const auto inside = model.interior(surface.values); model.transmits() && inside) {
    look.kind = Look::Kind::glass;
    look.medium = *inside;
    look.eta = level(inside->eta);
    check_dispersion(look, pointer, losses);
  } else if (named.has("albedo")) {
    make_matte(look, named);
  } else if ((named.has("eta") && named.has("k")) || named.has("f0")) {
    make_metal(look, named);
  } else {
    make_unlike(look, appearance, surface, losses);
  }
  const std::string colour = named.has("albedo") ? "albedo" : "f0";
  for (const Texture& texture : surface.textures) {
    if (texture.name == colour || (texture.name == "alpha" && look.coat_eta == 0))
      look.textures[texture.name] = &texture;
    else
      lose(losses, pointer + "/textures/" + texture.name, "a texture of " + texture.name, "the parameter's one value");
  }
  return look;
}

}  // namespace gonio::scene
