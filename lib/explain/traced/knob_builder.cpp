// See knob_builder.h.
#include "explain/traced/knob_builder.h"

#include <algorithm>
#include <cmath>

#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/surface.h"
#include "scene/model_choice.h"

namespace gonio::mechanism {
const Mechanism& surface_directional_subsurface();
const Mechanism& surface_polish();
const Mechanism& surface_print_layers();
const Mechanism& surface_print_slopes();
const Mechanism& surface_roughness();
const Mechanism& surface_subsurface();
const Mechanism& volume_absorption();
const Mechanism& volume_index();
}  // namespace gonio::mechanism

namespace gonio::explain::traced {
namespace {

using manifest::Document;
using Values = std::span<const double>;

constexpr double of_a_size = 0.1;  // usual change of a mechanism's number, over its typical size
const std::vector<double> absorbing{0, 3, 12, 40, 120}, indices{-0.06, -0.02, 0, 0.02, 0.06};

}  // namespace

std::vector<double> stated_of(const scene::Surface& surface, const std::string& name) {
  const auto& own = surface.model->info().parameters;
  const auto at = static_cast<std::size_t>(scene::find_parameter(surface.model->info(), name) - own.data());
  const Rgb v = surface.values.rgb(at);
  return own[at].components == 1 ? std::vector{v.x} : std::vector{v.x, v.y, v.z};
}

std::size_t KnobBuilder::respond(std::vector<double> nodes, double stated, std::function<void(Document&, double)> set) {
  all_.responses.push_back({std::move(nodes), stated, std::move(set)});
  return all_.responses.size() - 1;
}
std::size_t KnobBuilder::knob(Parameter parameter, Acts acts, std::size_t response, int channel, std::size_t surface) {
  all_.knobs.push_back({std::move(parameter), acts, response, channel, surface});
  return all_.knobs.size() - 1;
}
Parameter KnobBuilder::of(const mechanism::Parameter& m, const std::string& before) {
  Parameter p;
  p.name = before + m.name, p.unit = m.unit;
  p.start = m.start, p.neutral = m.neutral, p.lower = m.lower, p.upper = m.upper;
  p.size = m.typical > 0 ? of_a_size * m.typical : 1e-3;
  return p;
}
void KnobBuilder::within_nodes(Parameter& p, const std::vector<double>& nodes) {
  p.lower = std::max(p.lower, nodes.front()), p.upper = std::min(p.upper, nodes.back());
  p.start = std::clamp(p.start, p.lower, p.upper);
}
Question& KnobBuilder::ask(const mechanism::Mechanism* mechanism, std::vector<std::string> on,
                           std::vector<std::size_t> knobs) {
  all_.questions.push_back({mechanism, std::move(on), std::move(knobs)});
  return all_.questions.back();
}

void KnobBuilder::of_surface(std::size_t a) {
  const scene::Surface& surface = scene_.appearance.surfaces[all_.surfaces[a].surface];
  const auto one_number = [&](const char* name) {  // by the manifest, not band by band from a file
    return surface.model->transmits() && scene::find_parameter(surface.model->info(), name) &&
           !surface.spectra.contains(name);
  };
  if (one_number("sigma_a_per_m")) absorption(surface);
  if (one_number("eta")) index(surface);
  if (surface.model->info().id == "dipole") directional(surface);
  if (all_.surfaces[a].rough) roughness(a);
}

void KnobBuilder::absorption(const scene::Surface& surface) {
  const mechanism::Mechanism& m = mechanism::volume_absorption();
  const std::vector<double> stated = stated_of(surface, "sigma_a_per_m");
  const std::size_t response = respond(absorbing, 0, [id = surface.id, stated](Document& d, double x) {
    d.surfaces.at(id).parameters["sigma_a_per_m"].value = {stated[0] + x, stated[1] + x, stated[2] + x};
  });
  std::vector<std::size_t> knobs;
  for (std::size_t c = 0; c < 3; ++c) {
    Parameter p = of(m.parameters[0], m.id + ".");
    p.name = surface.id + "/" + "rgb"[c] + "/" + m.parameters[0].name;
    within_nodes(p, absorbing);
    knobs.push_back(knob(std::move(p), Acts::multiplies, response, static_cast<int>(c)));
  }
  ask(&m, {surface.id}, knobs).write = [id = surface.id, stated](Document& d, Values v, Values sigma) {
    manifest::Surface& entry = d.surfaces.at(id);
    entry.parameters["sigma_a_per_m"].value = {stated[0] + v[0], stated[1] + v[1], stated[2] + v[2]};
    entry.sigma["sigma_a_per_m"].assign(sigma.begin(), sigma.end());
  };
}

void KnobBuilder::index(const scene::Surface& surface) {
  const mechanism::Mechanism& m = mechanism::volume_index();
  const double stated = stated_of(surface, "eta")[0];
  const auto set = [id = surface.id, stated](Document& d, double x) {
    d.surfaces.at(id).parameters["eta"].value = {stated + x};
  };
  Parameter p = of(m.parameters[0], m.id + ".");
  within_nodes(p, indices);
  const std::size_t k = knob(std::move(p), Acts::adds, respond(indices, 0, set));
  ask(&m, {surface.id}, {k}).write = [set, id = surface.id](Document& d, Values v, Values sigma) {
    set(d, v[0]);
    d.surfaces.at(id).sigma["eta"] = {sigma[0]};
  };
}

void KnobBuilder::directional(const scene::Surface& surface) {
  const mechanism::Mechanism& m = mechanism::surface_directional_subsurface();
  const auto set = [id = surface.id, parameters = surface.parameters](Document& d, double) {
    manifest::Surface& entry = d.surfaces.at(id);
    entry.model = "directional-dipole", entry.parameters = parameters, entry.sigma.clear();
    const auto use = d.mechanisms.find(mechanism::surface_subsurface().id);
    if (use == d.mechanisms.end()) return;
    std::erase(use->second.on, id);
    if (use->second.on.empty()) d.mechanisms.erase(use);
  };
  Parameter p = of(m.parameters[0], m.id + ".");
  const std::size_t k = knob(std::move(p), Acts::adds, respond({0, 1}, 0, set));
  ask(&m, {surface.id}, {k}).write = [set](Document& d, Values, Values) { set(d, 1); };
}

void KnobBuilder::roughness(std::size_t a) {
  const auto one = [&](const mechanism::Mechanism& m, std::vector<Acts> acts) {
    std::vector<std::size_t> knobs;
    for (std::size_t i = 0; i < acts.size(); ++i)
      knobs.push_back(knob(of(m.parameters[i], m.id + "."), acts[i], 0, -1, a));
    ask(&m, {all_.surfaces[a].name}, knobs);
  };
  one(mechanism::surface_roughness(), {Acts::more});
  one(mechanism::surface_print_slopes(), {Acts::slopes});
  one(mechanism::surface_print_layers(), {Acts::layers, Acts::layer_m, Acts::layer_offset_m});
  one(mechanism::surface_polish(), {Acts::reach_m, Acts::polish});
}

}  // namespace gonio::explain::traced
