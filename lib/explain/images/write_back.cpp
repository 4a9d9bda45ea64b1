// The upgraded manifest: fitted values and their sigmas in the sections where the parameters came from, and the named
// mechanisms switched on, one list per parameter in the order of `on`.
#include <algorithm>
#include <map>

#include "explain/images/bindings.h"
#include "inference/explanation.h"
#include "manifest/document.h"
#include "manifest/sections/image.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/surface.h"

namespace gonio::explain::images {
namespace {

void enter(manifest::Parameter& parameter, manifest::Sigmas& sigmas, const Origin& origin, double value, double sigma) {
  parameter.value.at(origin.component) = value;
  std::vector<double>& all = sigmas[origin.key];
  all.resize(parameter.value.size(), 0.0);
  all[origin.component] = sigma;
}

void write_base(const Origin& origin, double value, double sigma, manifest::Document& document) {
  switch (origin.section) {
    case Origin::Section::surfaces: {
      manifest::Surface& surface = document.surfaces.at(origin.name);
      return enter(surface.parameters.at(origin.key), surface.sigma, origin, value, sigma);
    }
    case Origin::Section::lights: {
      manifest::Light& light = document.lights.at(origin.name);
      return enter(light.parameters.at(origin.key), light.sigma, origin, value, sigma);
    }
    case Origin::Section::images: {
      manifest::ImageEntry& image = document.images.at(origin.entry);
      if (!image.gain) image.gain = manifest::Parameter(1.0);
      image.gain->value.at(origin.component) = value;
      return;
    }
    case Origin::Section::mechanisms: {
      manifest::MechanismUse& use = document.mechanisms.at(origin.name);
      return enter(use.parameters.at(origin.key), use.sigma, origin, value, sigma);
    }
  }
}

// Values of one mechanism, target by target.
struct Entry {
  std::vector<std::string> on;
  std::map<std::string, std::vector<double>> value, sigma;
};

void add_candidate(const Bindings& bindings, std::size_t candidate, const Use& use, const Explanation& explanation,
                   bool alone, Entry& entry) {
  const std::vector<mechanism::Parameter>& infos = use.mechanism->parameters;
  entry.on.insert(entry.on.end(), use.on.begin(), use.on.end());
  // One set for several targets is one number, unless other sets stand beside it.
  const std::size_t copies = use.sets == 1 && !alone ? std::max<std::size_t>(1, use.on.size()) : 1;
  std::map<std::size_t, std::size_t> parameter_of;
  std::size_t next = 0;
  for (std::size_t i = 0; i < use.numbers.size(); ++i) {
    const std::string& name = infos[i % infos.size()].name;
    const std::optional<std::size_t> same = use.numbers[i].same_as;
    const bool free = use.numbers[i].free || same;
    if (use.numbers[i].free && !same) parameter_of[i] = bindings.candidates[candidate].parameters[next++];
    const std::size_t p = free ? parameter_of.at(same.value_or(i)) : 0;
    for (std::size_t k = 0; k < copies; ++k) {
      entry.value[name].push_back(free ? explanation.values[p] : use.numbers[i].start);
      entry.sigma[name].push_back(free ? explanation.sigma[p] : 0);
    }
  }
}

// Numbers of forms that are not in use: what is left out is neutral.
void leave_out_neutral(const mechanism::Mechanism& mechanism, Entry& entry) {
  for (const mechanism::Parameter& p : mechanism.parameters) {
    const auto found = entry.value.find(p.name);
    if (found == entry.value.end() || entry.value.size() == 1) continue;
    const bool idle = std::ranges::all_of(found->second, [&](double v) { return v == p.neutral; }) &&
                      std::ranges::all_of(entry.sigma[p.name], [](double s) { return s == 0; });
    if (idle) entry.value.erase(found), entry.sigma.erase(p.name);
  }
}

}  // namespace

void write_back(const Bindings& bindings, std::span<const Use> uses, const Explanation& explanation,
                manifest::Document& document) {
  for (std::size_t p = 0; p < bindings.origins.size(); ++p)
    for (const Origin& origin : bindings.origins[p])
      write_base(origin, explanation.values[p], explanation.sigma.empty() ? 0 : explanation.sigma[p], document);
  std::map<std::string, Entry> entries;
  const auto named_with = [&](const std::string& id) {
    return std::ranges::count_if(explanation.named, [&](std::size_t c) { return bindings.candidates[c].id() == id; });
  };
  for (const std::size_t c : explanation.named) {
    const std::string& id = bindings.candidates[c].id();
    add_candidate(bindings, c, uses[bindings.use_of[c]], explanation, named_with(id) == 1, entries[id]);
  }
  for (auto& [id, entry] : entries) {
    manifest::MechanismUse& use = document.mechanisms[id];
    use.on = std::move(entry.on);
    leave_out_neutral(*mechanism::find_mechanism(id), entry);
    for (auto& [name, values] : entry.value) use.parameters[name] = manifest::Parameter(std::move(values));
    for (auto& [name, sigmas] : entry.sigma) use.sigma[name] = std::move(sigmas);
  }
}

}  // namespace gonio::explain::images
