// See knobs.h.
#include "explain/traced/knobs.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "explain/traced/knob_builder.h"
#include "manifest/document.h"
#include "manifest/sections/image.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "scene/model_choice.h"

namespace gonio::mechanism {
const Mechanism& geometry_pose();
const Mechanism& light_ambient();
const Mechanism& light_position();
}  // namespace gonio::mechanism

namespace gonio::explain::traced {
namespace {

using manifest::Document;
using Values = std::span<const double>;

constexpr double sigmas = 4;  // to the outer nodes of what is known to a sigma
const std::vector<double> roughnesses{0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.55, 0.75, 1};

void use_mechanism(Document& document, const std::string& id, const std::vector<std::string>& on,
                   const std::string& name, const std::vector<double>& value, const std::vector<double>& sigma) {
  manifest::MechanismUse& use = document.mechanisms[id];
  use.on = on;
  use.parameters[name] = manifest::Parameter(value);
  if (!sigma.empty()) use.sigma[name] = sigma;
}

class Declaration : private KnobBuilder {
 public:
  using KnobBuilder::KnobBuilder;

  Knobs run(std::span<const std::size_t> surfaces) {
    for (const std::size_t s : surfaces) asked(s);
    brightness();
    free_surfaces();
    free_mechanisms();
    poses();
    lamps();
    for (std::size_t a = 0; a < all_.surfaces.size(); ++a) of_surface(a);
    ambient();
    return std::move(all_);
  }

 private:
  static Parameter plain(const std::string& name, const std::string& unit, double value, double lower, double upper,
                         double size) {
    Parameter p;
    p.name = name, p.unit = unit, p.start = p.neutral = value, p.lower = lower, p.upper = upper, p.size = size;
    return p;
  }

  void asked(std::size_t s) {
    const scene::Surface& surface = scene_.appearance.surfaces[s];
    Asked a{.name = surface.id, .surface = s};
    const manifest::Surface& entry = document_.surfaces.at(surface.id);
    const bool varies = entry.laws.contains("alpha") || entry.textures.contains("alpha") ||
                        entry.vertices.contains("alpha") || entry.labels.contains("alpha");
    // By the bounds of the model that the manifest names, whatever mechanisms made of it.
    const auto* alpha = scene::find_parameter(surface::find(entry.model)->info(), "alpha");
    if (alpha != nullptr && scene::find_parameter(surface.model->info(), "alpha") && !varies) {
      a.rough = true;
      a.stated.alpha = stated_of(surface, "alpha")[0];
      a.stated.lower = alpha->lower, a.stated.upper = std::min(1.0, alpha->upper);
      std::vector<double> nodes{a.stated.alpha};
      for (const double node : roughnesses)
        if (node >= alpha->lower && node <= alpha->upper && std::abs(node - a.stated.alpha) > 0.02)
          nodes.push_back(node);
      std::ranges::sort(nodes);
      a.response = respond(std::move(nodes), a.stated.alpha, [name = surface.id](Document& d, double value) {
        d.surfaces.at(name).parameters["alpha"].value = {value};
      });
      all_.responses.back().fine = true;
    }
    all_.surfaces.push_back(std::move(a));
  }

  // Of lamps that bear one name in `share`, or of one alone; and of pictures.
  void brightness() {
    std::map<std::string, std::vector<std::string>> shared;
    for (const std::string& name : recordings_.lights)
      for (const char* key : {"watt_per_sr", "watt_per_m2"}) {
        const auto& parameters = document_.lights.at(name).parameters;
        const auto found = parameters.find(key);
        if (found == parameters.end() || !found->second.free) continue;
        shared[found->second.share.empty() ? "lights/" + name + "/" + key : found->second.share].push_back(name);
      }
    for (const auto& [name, lamps] : shared) {
      std::vector<std::size_t> images;
      bool alone = true;  // with others on, brightness is no factor
      for (std::size_t g = 0; g < recordings_.images.size(); ++g) {
        const auto& on = recordings_.images[g].lights;
        const auto mine = std::ranges::count_if(
            on, [&](std::size_t l) { return std::ranges::count(lamps, recordings_.lights[l]) > 0; });
        if (mine > 0) images.push_back(g);
        alone = alone && (mine == 0 || static_cast<std::size_t>(mine) == on.size());
      }
      if (!alone || images.empty()) continue;
      const std::size_t k = knob(plain(name, "1", 1, 0.01, 100, 0.05), Acts::brightness, 0);
      all_.knobs[k].images = images;
      ask(nullptr, {}, {k}).write = [lamps](Document& d, Values v, Values sigma) {
        for (const std::string& lamp : lamps)
          for (const char* key : {"watt_per_sr", "watt_per_m2"}) {
            manifest::Light& light = d.lights.at(lamp);
            const auto found = light.parameters.find(key);
            if (found == light.parameters.end()) continue;
            light.sigma[key].clear();
            for (double& x : found->second.value) light.sigma[key].push_back(std::abs(x) * sigma[0]), x *= v[0];
          }
      };
    }
    for (std::size_t g = 0; g < recordings_.images.size(); ++g) {
      const relighting::Recording& image = recordings_.images[g];
      if (!image.gain.free) continue;
      const std::size_t k = knob(plain("images/" + image.id + "/gain", "1", 1, 0.01, 100, 0.05), Acts::brightness, 0);
      all_.knobs[k].images = {g};
      ask(nullptr, {}, {k}).write = [entry = image.entry](Document& d, Values v, Values) {
        for (double& x : d.images[entry].gain->value) x *= v[0];
      };
    }
  }

  // Nodes about a free number: as far as it may go, at most a fifth of that or of itself.
  static std::vector<double> nodes_about(double value, double lower, double upper) {
    const double reach = std::isfinite(upper - lower) && upper - lower <= 10 ? 0.2 * (upper - lower)
                                                                             : 0.4 * std::max(1e-6, std::abs(value));
    std::vector<double> nodes{value};
    for (const double node : {value - reach, value - 0.4 * reach, value + 0.4 * reach, value + reach})
      if (node > lower && node < upper) nodes.push_back(node);
    if (value - reach <= lower && value > lower) nodes.push_back(lower);
    if (value + reach >= upper && value < upper) nodes.push_back(upper);
    std::ranges::sort(nodes);
    return nodes;
  }

  void free_surfaces() {
    for (const scene::Surface& surface : scene_.appearance.surfaces)
      for (const auto& [key, stated] : document_.surfaces.at(surface.id).parameters) {
        if (!stated.free) continue;
        free_number(surface, key, stated);
      }
  }
  void free_number(const scene::Surface& surface, const std::string& key, const manifest::Parameter& stated) {
    const std::string name = "surfaces/" + surface.id + "/" + key;
    const auto asked = std::ranges::find(all_.surfaces, surface.id, &Asked::name);
    const auto* info = scene::find_parameter(surface.model->info(), key);
    const double lower = stated.min.value_or(info ? info->lower : 0),
                 upper = stated.max.value_or(info ? info->upper : 1);
    if (key == "alpha" && asked != all_.surfaces.end() && asked->rough) {
      const auto a = static_cast<std::size_t>(asked - all_.surfaces.begin());
      const std::size_t k = knob(plain(name, "1", asked->stated.alpha, std::max(lower, asked->stated.lower),
                                       std::min(upper, asked->stated.upper), 0.02),
                                 Acts::alpha, 0, -1, a);
      ask(nullptr, {}, {k});
      return;
    }
    std::vector<std::size_t> knobs;
    const std::size_t count = stated.value.size();
    const bool alike = std::ranges::all_of(stated.value, [&](double v) { return v == stated.value[0]; });
    if (count > 1 && !alike) return free_colour(surface.id, key, stated, lower, upper);
    const double value = stated.value[0];
    const std::size_t response =
        respond(nodes_about(value, lower, upper), value, [id = surface.id, key](Document& d, double x) {
          for (double& v : d.surfaces.at(id).parameters.at(key).value) v = x;
        });
    for (std::size_t c = 0; c < count; ++c) {  // colours do not mix: one series of pictures serves all three
      Parameter p = plain(name + (count > 1 ? std::string("/") + "rgb"[c] : ""), info ? info->unit : "1", value, lower,
                          upper, 0.02 * std::max(0.05, std::abs(value)));
      within_nodes(p, all_.responses[response].nodes);
      knobs.push_back(knob(std::move(p), Acts::adds, response, count > 1 ? static_cast<int>(c) : -1));
    }
    ask(nullptr, {}, knobs).write = [id = surface.id, key](Document& d, Values v, Values sigma) {
      d.surfaces.at(id).parameters.at(key).value.assign(v.begin(), v.end());
      d.surfaces.at(id).sigma[key].assign(sigma.begin(), sigma.end());
    };
  }
  // Three numbers that begin apart: a factor on each, in one series of pictures, as far as none leaves its bounds.
  void free_colour(const std::string& id, const std::string& key, const manifest::Parameter& stated, double lower,
                   double upper) {
    const auto [smallest, largest] = std::ranges::minmax(stated.value);
    const double least = smallest > 0 ? lower / smallest : 0, most = largest > 0 ? std::max(1.0, upper / largest) : 1;
    std::vector<double> nodes{0.4, 0.7, 1, 1.4, 2.2};
    std::erase_if(nodes, [&](double x) { return x != 1 && (x < least || x > most); });
    if (nodes.back() == 1 && most > 1) nodes.push_back(most);
    if (nodes.front() == 1 && least < 1) nodes.insert(nodes.begin(), least);
    const std::size_t response = respond(nodes, 1, [id, key](Document& d, double x) {
      for (double& v : d.surfaces.at(id).parameters.at(key).value) v *= x;
    });
    std::vector<std::size_t> knobs;
    for (std::size_t c = 0; c < stated.value.size(); ++c)
      knobs.push_back(knob(
          plain("surfaces/" + id + "/" + key + "/" + "rgb"[c] + "/factor", "1", 1, nodes.front(), nodes.back(), 0.02),
          Acts::adds, response, static_cast<int>(c)));
    ask(nullptr, {}, knobs).write = [id, key](Document& d, Values v, Values sigma) {
      manifest::Surface& surface = d.surfaces.at(id);
      std::vector<double>& value = surface.parameters.at(key).value;
      surface.sigma[key].clear();
      for (std::size_t c = 0; c < value.size(); ++c)
        surface.sigma[key].push_back(std::abs(value[c]) * sigma[c]), value[c] *= v[c];
    };
  }

  void free_mechanisms() {
    for (const auto& [id, use] : document_.mechanisms)
      for (const auto& [key, stated] : use.parameters) {
        if (!stated.free || stated.value.size() != 1) continue;
        const double value = stated.scalar(), lower = stated.min.value_or(-1e9), upper = stated.max.value_or(1e9);
        const std::size_t response = respond(
            nodes_about(value, std::max(lower, 0.1 * value), std::min(upper, 3 * value)), value,
            [id = id, key = key](Document& d, double x) { d.mechanisms.at(id).parameters.at(key).value = {x}; });
        Parameter p =
            plain("mechanisms/" + id + "/" + key, "", value, lower, upper, 0.05 * std::max(1e-6, std::abs(value)));
        within_nodes(p, all_.responses[response].nodes);
        const std::size_t k = knob(std::move(p), Acts::adds, response);
        ask(nullptr, {}, {k}).write = [id = id, key = key](Document& d, Values v, Values sigma) {
          d.mechanisms.at(id).parameters.at(key).value = {v[0]};
          d.mechanisms.at(id).sigma[key] = {sigma[0]};
        };
      }
  }

  // What the manifest knows to a sigma is free within it; what it states without one is asked.
  void moved(const mechanism::Mechanism& m, const std::vector<std::string>& on, const std::vector<double>& known,
             const std::vector<std::size_t>& responses, const std::vector<std::size_t>& images,
             std::vector<std::size_t>& knobs) {
    for (std::size_t i = 0; i < m.parameters.size(); ++i) {
      Parameter p = of(m.parameters[i], on.size() == 1 ? on[0] + "/" : m.id + ".");
      const std::vector<double>& nodes = all_.responses[responses[i]].nodes;
      if (known.empty()) {
        within_nodes(p, nodes);
      } else {  // the prior holds it, no bound
        p.start = 0, p.prior_sigma = known[i], p.size = known[i];
        p.lower = -std::numeric_limits<double>::infinity(), p.upper = -p.lower;
      }
      knobs.push_back(knob(std::move(p), Acts::adds, responses[i]));
      all_.knobs.back().images = images;
    }
  }
  // Three or six numbers of a mechanism that moves `on`, each in a series of its own.
  std::vector<std::size_t> series(const mechanism::Mechanism& m, const std::vector<std::string>& on,
                                  const std::vector<double>& known) {
    std::vector<std::size_t> responses;
    for (std::size_t i = 0; i < m.parameters.size(); ++i) {
      const double reach = known.empty() ? 2 * m.parameters[i].typical : std::max(sigmas * known[i], 1e-5);
      responses.push_back(
          respond({-reach, 0, reach}, 0, [id = m.id, on, name = m.parameters[i].name](Document& d, double x) {
            use_mechanism(d, id, on, name, {x}, {});
          }));
    }
    return responses;
  }

  void poses() {
    const mechanism::Mechanism& m = mechanism::geometry_pose();
    if (document_.mechanisms.contains(m.id)) return;
    for (const manifest::Object& object : document_.objects) {
      if (std::ranges::find(all_.surfaces, object.surface, &Asked::name) == all_.surfaces.end()) continue;
      std::vector<double> known;
      if (object.world_from_object && object.world_from_object->sigma) {
        const auto& sigma = *object.world_from_object->sigma;
        for (std::size_t i = 0; i < 3; ++i)
          known.push_back(sigma.translation_m[sigma.translation_m.size() == 3 ? i : 0]);
        for (std::size_t i = 0; i < 3; ++i) known.push_back(sigma.rotation_rad[sigma.rotation_rad.size() == 3 ? i : 0]);
        if (std::ranges::any_of(known, [](double s) { return !(s > 0); })) known.clear();
      }
      std::vector<std::size_t> knobs;
      moved(m, {object.id}, known, series(m, {object.id}, known), {}, knobs);
      mechanism_question(m, {object.id}, knobs, !known.empty());
    }
  }

  void lamps() {
    const mechanism::Mechanism& m = mechanism::light_position();
    if (document_.mechanisms.contains(m.id)) return;
    const bool one_each = std::ranges::all_of(recordings_.images, [](const auto& i) { return i.lights.size() == 1; });
    std::vector<std::string> movable;
    std::vector<double> least(3, 1.0);
    bool all_known = true;
    for (const std::string& name : recordings_.lights) {
      const manifest::Light& light = document_.lights.at(name);
      if (!light.parameters.contains("position_m")) continue;
      movable.push_back(name);
      const auto sigma = light.sigma.find("position_m");
      all_known = all_known && sigma != light.sigma.end() && sigma->second.size() == 3 &&
                  std::ranges::all_of(sigma->second, [](double s) { return s > 0; });
    }
    if (movable.empty()) return;
    if (all_known)
      for (std::size_t i = 0; i < 3; ++i) {
        least[i] = 0;
        for (const std::string& name : movable)
          least[i] = std::max(least[i], document_.lights.at(name).sigma.at("position_m")[i]);
      }
    const std::vector<double> known = all_known ? least : std::vector<double>{};
    std::vector<std::size_t> together;
    if (one_each) together = series(m, movable, known);
    std::vector<std::size_t> knobs;
    for (const std::string& name : movable) {
      std::vector<std::size_t> images;
      for (std::size_t g = 0; g < recordings_.images.size(); ++g)
        if (std::ranges::any_of(recordings_.images[g].lights,
                                [&](std::size_t l) { return recordings_.lights[l] == name; }))
          images.push_back(g);
      moved(m, {name}, all_known ? document_.lights.at(name).sigma.at("position_m") : known,
            one_each ? together : series(m, {name}, known), images, knobs);
    }
    mechanism_question(m, movable, knobs, all_known);
  }

  // Numbers of each name of `on`, one set after the other.
  void mechanism_question(const mechanism::Mechanism& m, const std::vector<std::string>& on,
                          const std::vector<std::size_t>& knobs, bool in_base) {
    Question& q = ask(in_base ? nullptr : &m, on, knobs);
    q.write = [&m, on](Document& d, Values v, Values sigma) {
      const std::size_t n = m.parameters.size();
      for (std::size_t i = 0; i < n; ++i) {
        std::vector<double> value, own;
        for (std::size_t k = i; k < v.size(); k += n) value.push_back(v[k]), own.push_back(sigma[k]);
        use_mechanism(d, m.id, on, m.parameters[i].name, value, own);
      }
    };
  }

  void ambient() {
    const mechanism::Mechanism& m = mechanism::light_ambient();
    if (document_.mechanisms.contains(m.id)) return;
    double brightest = 0;
    for (const relighting::Recording& image : recordings_.images)
      brightest = std::max(brightest, max_component(image.mean));
    const double much = 0.2 * brightest / pi;
    if (!(much > 0)) return;
    const std::size_t response = respond({0, much}, 0, [&m](Document& d, double x) {
      for (const mechanism::Parameter& p : m.parameters) use_mechanism(d, m.id, {}, p.name, {x}, {});
    });
    std::vector<std::size_t> knobs;
    for (std::size_t c = 0; c < 3; ++c) {
      Parameter p = of(m.parameters[c], m.id + ".");
      p.lower = 0, p.upper = 5 * much, p.start = 0.05 * much, p.size = 0.05 * much;
      knobs.push_back(knob(std::move(p), Acts::adds, response, static_cast<int>(c)));
    }
    mechanism_question(m, {}, knobs, false);
  }
};

}  // namespace

Knobs knobs_of(const Document& document, const relighting::Recordings& recordings, const scene::Scene& scene,
               std::span<const std::size_t> surfaces) {
  return Declaration(document, recordings, scene).run(surfaces);
}

}  // namespace gonio::explain::traced
