// See traced_model.h.
#include "explain/traced/traced_model.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "explain/images/traced.h"
#include "explain/traced/nodes.h"
#include "explain/traced/takes.h"
#include "manifest/document.h"
#include "manifest/sections/surface.h"
#include "relighting/repeats.h"

namespace gonio::explain::traced {
namespace {

constexpr std::uint64_t seed = 83;
constexpr double of_nodes = 0.1, of_fine_nodes = 0.25;  // of the paths of the scene as it was given
constexpr double dark = 2e-3;                           // of the brightest
constexpr std::size_t places_of_mean = 48;              // that stand for a surface

}  // namespace

TracedModel::TracedModel(const manifest::Document& document, const std::vector<std::filesystem::path>& repeats,
                         std::size_t pixels, double paths)
    : document_(std::make_unique<manifest::Document>(document)),
      paths_(paths),
      recordings_(relighting::read_recordings(document)) {
  relighting::measure_noise(repeats, document, recordings_);
  const scene::Scene scene = scene::build_scene(document);
  const render::RayCaster caster(scene.instances);
  const std::vector<std::size_t> surfaces = surfaces_in_question(document, scene);
  sampled_ = traced::sampled(recordings_, scene, caster, surfaces, pixels);
  knobs_ = knobs_of(document, recordings_, scene, surfaces);
  places_.resize(surfaces.size());
  for (std::size_t p = 0; p < sampled_.pixels.size(); ++p)
    if (const auto s = sampled_.pixels[p].surface) places_[*s].push_back(p);
  for (auto& places : places_) {
    const std::size_t step = std::max<std::size_t>(1, places.size() / places_of_mean);
    std::vector<std::size_t> some;
    for (std::size_t k = 0; k < places.size(); k += step) some.push_back(places[k]);
    places = some;
  }
  stated_ = trace(document, paths);
  for (const double v : stated_.radiance) floor_ = std::max(floor_, dark * v);
  std::map<double, std::vector<double>> stated;  // with as many samples and the same random numbers as at a node
  for (Response& response : knobs_.responses) {
    const double own = paths * (response.fine ? of_fine_nodes : of_nodes);
    if (stated[own].empty()) stated[own] = trace(document, own).radiance;
    for (const double node : response.nodes) {
      manifest::Document changed = document;
      if (node != response.stated) response.set(changed, node);
      response.radiance.push_back(node != response.stated ? trace(changed, own).radiance : stated[own]);
    }
  }
}

TracedModel::~TracedModel() = default;

TracedModel::Traced TracedModel::trace(const manifest::Document& document, double paths) const {
  std::vector<images::TracedPixels> pictures(recordings_.images.size());
  for (std::size_t g = 0; g < pictures.size(); ++g) pictures[g].entry = recordings_.images[g].entry;
  for (const SampledPixel& pixel : sampled_.pixels) pictures[pixel.image].at.push_back({pixel.x, pixel.y});
  images::trace_pixels(document, pictures, paths, seed, images::Caustics::traced);
  Traced all;
  for (const images::TracedPixels& picture : pictures) {  // those of one picture follow each other
    all.radiance.insert(all.radiance.end(), picture.radiance.begin(), picture.radiance.end());
    all.variance.insert(all.variance.end(), picture.variance.begin(), picture.variance.end());
  }
  return all;
}

Roughness TracedModel::roughness_of(std::span<const double> values, std::size_t surface) const {
  Roughness r = knobs_.surfaces[surface].stated;
  for (std::size_t k = 0; k < knobs_.knobs.size(); ++k) {
    if (knobs_.knobs[k].acts < Acts::alpha || knobs_.knobs[k].surface != surface) continue;
    switch (knobs_.knobs[k].acts) {
      case Acts::alpha: r.alpha = values[k]; break;
      case Acts::more: r.more = values[k]; break;
      case Acts::slopes: r.slopes = values[k]; break;
      case Acts::layers: r.layers = values[k]; break;
      case Acts::layer_m: r.layer_m = values[k]; break;
      case Acts::layer_offset_m: r.layer_offset_m = values[k]; break;
      case Acts::reach_m: r.reach_m = values[k]; break;
      default: r.polish = values[k];
    }
  }
  return r;
}

double TracedModel::mean_roughness(const Roughness& roughness, std::size_t surface) const {
  double sum = 0;
  for (const std::size_t p : places_[surface]) sum += roughness.at(sampled_.pixels[p].here);
  return places_[surface].empty() ? roughness.even() : sum / static_cast<double>(places_[surface].size());
}

void TracedModel::predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const {
  std::vector<Roughness> rough;
  std::vector<double> mean;
  for (std::size_t s = 0; s < knobs_.surfaces.size(); ++s) {
    rough.push_back(roughness_of(values, s));
    mean.push_back(mean_roughness(rough.back(), s));
  }
  std::vector<std::size_t> moved;  // knobs that are not where they were stated
  for (std::size_t k = 0; k < knobs_.knobs.size(); ++k) {
    const Knob& knob = knobs_.knobs[k];
    const double stated = knob.acts == Acts::brightness ? 1
                          : knob.acts < Acts::alpha     ? knobs_.responses[knob.response].stated
                                                        : values[k];
    if (values[k] != stated) moved.push_back(k);
  }
  std::vector<double> y;
  const auto change = [&](const Response& response, double x, std::size_t row, bool as_factor) {
    y.clear();
    const auto view = [&](double v) { return as_factor ? std::log(std::max(0.0, v) + floor_) : v; };
    for (const auto& radiance : response.radiance) y.push_back(view(radiance[row]));
    return between(response.nodes, y, x) - between(response.nodes, y, response.stated);
  };
  const std::size_t first = sampled_.first[group];
  for (std::size_t p = first; p < sampled_.first[group + 1]; ++p) {
    const SampledPixel& pixel = sampled_.pixels[p];
    std::vector<double> alpha = mean;
    if (pixel.surface) alpha[*pixel.surface] = rough[*pixel.surface].at(pixel.here);
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t row = 3 * p + c;
      double value = stated_.radiance[row], factor = 1;
      for (std::size_t s = 0; s < rough.size(); ++s)
        if (knobs_.surfaces[s].rough && alpha[s] != knobs_.surfaces[s].stated.alpha)
          value += change(knobs_.responses[knobs_.surfaces[s].response], alpha[s], row, false);
      for (const std::size_t k : moved) {
        const Knob& knob = knobs_.knobs[k];
        if (knob.channel >= 0 && static_cast<std::size_t>(knob.channel) != c) continue;
        if (!knob.images.empty() && !std::ranges::binary_search(knob.images, pixel.image)) continue;
        if (knob.acts == Acts::brightness)
          factor *= values[k];
        else if (knob.acts == Acts::multiplies)
          factor *= std::exp(change(knobs_.responses[knob.response], values[k], row, true));
        else
          value += change(knobs_.responses[knob.response], values[k], row, false);
      }
      prediction[3 * (p - first) + c] = factor * value;
    }
  }
}

// With its sigma where it is one number: of what is `more` by its slope.
void TracedModel::write_roughness(std::span<const double> values, std::span<const double> sigmas, std::size_t surface,
                                  manifest::Document& document) const {
  const Roughness r = roughness_of(values, surface);
  r.write(document, knobs_.surfaces[surface].name);
  manifest::Surface& entry = document.surfaces.at(knobs_.surfaces[surface].name);
  if (sigmas.empty() || entry.laws.contains("alpha")) return;
  double variance = 0;
  for (std::size_t k = 0; k < knobs_.knobs.size(); ++k) {
    if (knobs_.knobs[k].surface != surface) continue;
    const double of = knobs_.knobs[k].acts == Acts::alpha ? r.alpha : knobs_.knobs[k].acts == Acts::more ? r.more : 0;
    if (r.even() > 0) variance += std::pow(of / r.even() * sigmas[k], 2);
  }
  entry.sigma["alpha"] = {std::sqrt(variance)};
}

void TracedModel::write(std::span<const double> values, std::span<const double> sigmas,
                        std::span<const std::size_t> named, bool all, manifest::Document& document) const {
  std::vector<double> v, s;
  std::vector<std::uint8_t> in_play(knobs_.knobs.size());
  for (std::size_t q = 0; q < knobs_.questions.size(); ++q) {
    const Question& question = knobs_.questions[q];
    const bool base = question.mechanism == nullptr;
    if (!base && std::ranges::find(named, q) == named.end()) continue;
    v.clear(), s.clear();
    for (const std::size_t k : question.knobs) {
      v.push_back(values[k]), s.push_back(sigmas.empty() ? 0 : sigmas[k]);
      in_play[k] = true;
    }
    const bool known = base && knobs_.knobs[question.knobs[0]].parameter.prior_sigma.has_value();
    if (question.write && (all || !known)) question.write(document, v, s);
  }
  for (std::size_t a = 0; a < knobs_.surfaces.size(); ++a) {
    if (!knobs_.surfaces[a].rough) continue;
    bool any = false;
    for (std::size_t k = 0; k < knobs_.knobs.size(); ++k)
      any = any || (in_play[k] && knobs_.knobs[k].acts >= Acts::alpha && knobs_.knobs[k].surface == a);
    if (any) write_roughness(values, sigmas, a, document);
  }
}

manifest::Document TracedModel::scene_with(std::span<const double> values, std::span<const double> sigmas,
                                           std::span<const std::size_t> named, bool all) const {
  manifest::Document document = *document_;
  write(values, sigmas, named, all, document);
  return document;
}

double TracedModel::slope_of_roughness(std::size_t surface, std::size_t row) const {
  const Asked& asked = knobs_.surfaces[surface];
  const Response& response = knobs_.responses[asked.response];
  const auto at =
      static_cast<std::size_t>(std::ranges::find(response.nodes, asked.stated.alpha) - response.nodes.begin());
  const std::size_t from = at + 1 < response.nodes.size() ? at : at - 1;
  return (response.radiance[from + 1][row] - response.radiance[from][row]) /
         (response.nodes[from + 1] - response.nodes[from]);
}

void TracedModel::begin_layers(std::size_t surface, double layer_m, double offset_m) {
  knobs_.surfaces[surface].stated.layer_m = layer_m;
  knobs_.surfaces[surface].stated.layer_offset_m = offset_m;
  for (Knob& knob : knobs_.knobs) {
    if (knob.surface != surface || (knob.acts != Acts::layer_m && knob.acts != Acts::layer_offset_m)) continue;
    const double value = knob.acts == Acts::layer_m ? layer_m : offset_m, reach = 0.1 * layer_m;
    Parameter& p = knob.parameter;
    p.start = p.neutral = value, p.lower = value - reach, p.upper = value + reach, p.size = 0.02 * layer_m;
  }
}

}  // namespace gonio::explain::traced
