// Parameter values, surroundings and directions for tests that walk the registry of surfaces: nothing here names a
// model.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/random.h"
#include "surface/surface.h"

namespace gonio::tests {

// A small file for models whose info().attachment says that they read one, written once into a temporary folder; see
// tables.cpp, where a model that needs one says how it is made.
std::filesystem::path file_for(const manifest::ModelInfo& info);

// Of a parameterized test over the registry: the model's id with underscores.
inline std::string test_name(const testing::TestParamInfo<const surface::Model*>& info) {
  std::string name = info.param->info().id;
  std::ranges::replace_if(
      name, [](unsigned char c) { return !std::isalnum(c); }, '_');
  return name;
}

struct SurfaceCase {
  const surface::Model* model;
  surface::Values values;
  std::string name;
  std::shared_ptr<const surface::Prepared> prepared{};  // what `values` points to
  std::shared_ptr<const surface::Layer> base{};
  std::shared_ptr<const SurfaceCase> beneath{};
};

// A value inside the bounds, denser towards the lower one, where lobes are narrow.
inline double draw_value(const manifest::ParameterInfo& info, Random& random) {
  const double lower = std::isfinite(info.lower) ? info.lower : -1, upper = std::isfinite(info.upper) ? info.upper : 1;
  const double u = random.uniform();
  return lower + (upper - lower) * u * u;
}

inline surface::Values draw_values(const surface::Model& model, Random& random) {
  surface::Values values;
  std::size_t i = 0;
  for (const auto& info : model.info().parameters) {
    const double x = draw_value(info, random);
    values.v[i++] = info.components == 3 ? Rgb{x, draw_value(info, random), draw_value(info, random)} : Rgb{x, x, x};
  }
  return values;
}

inline surface::Values at_bound(const surface::Model& model, bool upper) {
  surface::Values values;
  std::size_t i = 0;
  for (const auto& info : model.info().parameters) {
    const double x = upper ? info.upper : info.lower;
    values.v[i++] = {x, x, x};
  }
  return values;
}

// What the path tracer and the scene add to the values: the relative index of the media that meet, prepared tables, and
// the surface beneath, which is one of the models that lie on none and let nothing through, taken in turn.
inline SurfaceCase completed(SurfaceCase c, Random& random) {
  if (c.model->transmits()) {
    const double indices[] = {1.5, 1 / 1.5, 1.33, 1 / 2.4, 1.1, 2.4, 1 / 1.05};
    const double eta = indices[random.below(7)];
    c.values.eta = {eta, eta, eta};
    c.values.inside = eta < 1;
  }
  if (c.model->info().takes_base) {
    std::vector<std::shared_ptr<const SurfaceCase>> bases;
    for (const surface::Model* model : surface::all_models()) {
      if (model->info().takes_base || model->transmits() || model->thin() ||
          model->info().attachment != manifest::Attachment::none)
        continue;
      const auto base = std::make_shared<const SurfaceCase>(
          completed({model, draw_values(*model, random), model->info().id}, random));
      if (!model->subsurface(base->values)) bases.push_back(base);
    }
    c.beneath = bases.at(random.below(static_cast<std::uint32_t>(bases.size())));
    c.name += " on " + c.beneath->name;
    c.base = std::make_shared<surface::Layer>(surface::Layer{c.beneath->model, c.beneath->values});
    c.values.base = c.base.get();
  }
  const bool reads = c.model->info().attachment != manifest::Attachment::none;
  c.prepared = c.model->prepare(c.values, reads ? file_for(c.model->info()) : std::filesystem::path{}, c.name);
  c.values.prepared = c.prepared.get();
  return c;
}

// All parameters at their lower bounds, all at their upper ones, and four cases through which every parameter passes
// its lower and its upper bound while most others are drawn inside; then `random_cases` drawn.
inline std::vector<SurfaceCase> cases_of(const surface::Model& model, int random_cases, std::uint64_t seed) {
  constexpr std::size_t mixed_cases = 4;
  std::vector<SurfaceCase> cases;
  Random random(seed);
  const std::string id = model.info().id;
  const auto add = [&](const surface::Values& values, const std::string& name) {
    cases.push_back(completed({&model, values, id + " " + name}, random));
  };
  add(at_bound(model, false), "at lower bounds");
  add(at_bound(model, true), "at upper bounds");
  for (int k = 0; k < random_cases; ++k) add(draw_values(model, random), "drawn " + std::to_string(k));
  for (std::size_t k = 0; k < std::min(mixed_cases, model.info().parameters.size() + 1); ++k) {
    surface::Values mixed = draw_values(model, random);
    std::string name = "mixed";
    for (std::size_t i = 0; i < model.info().parameters.size(); ++i) {
      const auto& info = model.info().parameters[i];
      const std::size_t turn = (i + k) % mixed_cases;
      if (turn > 1) continue;
      const double bound = turn == 0 ? info.lower : info.upper;
      mixed.v[i] = {bound, bound, bound};
      name += (turn == 0 ? " low " : " high ") + info.name;
    }
    add(mixed, name);
  }
  return cases;
}

// The same for all registered models.
inline std::vector<SurfaceCase> surface_cases(int random_cases, std::uint64_t seed) {
  std::vector<SurfaceCase> cases;
  for (const surface::Model* model : surface::all_models())
    for (SurfaceCase& c : cases_of(*model, random_cases, seed)) cases.push_back(std::move(c));
  return cases;
}

inline Vec3 at_zenith(double degrees, double azimuth_rad = 0.7) {
  const double theta = degrees * pi / 180;
  return {std::sin(theta) * std::cos(azimuth_rad), std::sin(theta) * std::sin(azimuth_rad), std::cos(theta)};
}

// Above the horizon; every fourth one grazes it, down to 1e-300.
inline Vec3 draw_direction(Random& random) {
  const double z = random.below(4) == 0 ? std::pow(10.0, -300 * random.uniform() * random.uniform()) : random.uniform();
  const double r = std::sqrt(std::max(0.0, 1 - z * z)), phi = 2 * pi * random.uniform();
  return {r * std::cos(phi), r * std::sin(phi), z};
}
// Either side where light passes through.
inline Vec3 draw_incidence(const surface::Model& model, Random& random) {
  const Vec3 w = draw_direction(random);
  return model.transmits() && random.below(2) == 0 ? Vec3{w.x, w.y, -w.z} : w;
}

// The same surface seen from the other side: frames there have the same +x and opposite y and z.
inline surface::Values from_beyond(surface::Values values) {
  values.eta = {1 / values.eta.x, 1 / values.eta.y, 1 / values.eta.z};
  values.inside = !values.inside;
  return values;
}
inline Vec3 beyond_frame(Vec3 w) {
  return {w.x, -w.y, -w.z};
}

struct Reflectance {
  Rgb mean, standard_error;
};

// Reflectance by the model's own sampler, with the transmittance of models that transmit (radiance over eta^2, which is
// power): the additive recurrence of Roberts 2018 (R3), eight times from random starts.
inline Reflectance reflectance_by_sampling(const surface::Model& model, const surface::Values& values, Vec3 wo,
                                           int count = 2500) {
  constexpr int repeats = 8;
  const auto part = [](double x) { return x - std::floor(x); };
  Random random(99);
  Rgb sum, squares;
  for (int r = 0; r < repeats; ++r) {
    const double a = random.uniform(), b = random.uniform(), c = random.uniform();
    Rgb one;
    for (int i = 0; i < count; ++i) {
      const Vec2 u{part(a + i * 0.8191725133961645), part(b + i * 0.6710436067037893)};
      const auto s = model.sample(values, wo, u, part(c + i * 0.5497004779019703));
      if (s.pdf > 0) one += s.wi.z < 0 && !s.below ? s.weight * values.eta * values.eta : s.weight;
    }
    one = one / count;
    sum += one;
    squares += one * one;
  }
  const Rgb mean = sum / repeats, variance = (squares / repeats - mean * mean) / (repeats - 1);
  const auto root = [](double v) { return std::sqrt(std::max(0.0, v)); };
  return {mean, {root(variance.x), root(variance.y), root(variance.z)}};
}

}  // namespace gonio::tests
