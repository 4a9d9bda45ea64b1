// The built-in basis: gonio's own models over a seeded spread of plausible parameters.
//
// The three channels of a material share their lobes and differ in their colours, drawn one by one, so that a table of
// three channels is three samples. Albedos and roughnesses are uniform in their logarithms. Families and their shares:
// matte (Oren & Nayar), varnish and plastic, clear polished coats, gloss with haze, metals, metallic paint, fabrics.
#include <cmath>

#include "base/random.h"
#include "goniometry/basis.h"
#include "surface/surface.h"

namespace gonio::goniometry {
namespace {

class Draw {
 public:
  Draw(std::uint64_t seed, std::uint64_t material) : random_(seed, material) {}
  double uniform(double lower, double upper) { return random_.uniform(lower, upper); }
  double scale(double lower, double upper) { return lower * std::pow(upper / lower, random_.uniform()); }
  std::vector<double> colour(double lower, double upper) {
    return {scale(lower, upper), scale(lower, upper), scale(lower, upper)};
  }

 private:
  Random random_;
};

struct Family {
  const char *name, *model;
  manifest::Parameters (*parameters)(Draw&);
};

manifest::Parameters matte(Draw& d) {
  return {{"albedo", d.colour(0.02, 0.95)}, {"sigma_rad", d.uniform(0, 0.6)}};
}
manifest::Parameters varnish(Draw& d) {
  return {{"albedo", d.colour(0.004, 0.9)},
          {"sigma_rad", d.uniform(0, 0.4)},
          {"f0", d.uniform(0.02, 0.08)},
          {"alpha", d.scale(0.02, 0.6)}};
}
manifest::Parameters polish(Draw& d) {
  return {{"albedo", d.colour(0.002, 0.9)}, {"eta", d.uniform(1.3, 1.9)}, {"alpha", d.scale(0.003, 0.1)}};
}
manifest::Parameters haze(Draw& d) {
  return {{"albedo", d.colour(0.004, 0.8)},
          {"f0", d.uniform(0.02, 0.1)},
          {"alpha", d.scale(0.02, 0.15)},
          {"second_share", d.uniform(0.05, 0.6)},
          {"second_alpha", d.uniform(0.15, 0.8)}};
}
manifest::Parameters metal(Draw& d) {
  return {{"f0", d.colour(0.25, 0.98)},
          {"alpha", d.scale(0.003, 0.5)},
          {"second_share", d.uniform(0, 0.4)},
          {"second_alpha", d.scale(0.05, 0.7)}};
}
manifest::Parameters metallic_paint(Draw& d) {
  return {{"f0", d.colour(0.02, 0.5)},
          {"alpha", d.scale(0.05, 0.5)},
          {"second_share", d.uniform(0.1, 0.9)},
          {"second_alpha", d.scale(0.2, 0.9)}};
}
manifest::Parameters fabric(Draw& d) {
  return {{"albedo", d.colour(0.01, 0.6)}, {"sigma_rad", d.uniform(0.2, 1.0)}, {"f0", d.uniform(0.01, 0.06)},
          {"alpha", d.uniform(0.4, 0.9)},  {"retro", d.scale(0.005, 0.2)},     {"retro_alpha", d.uniform(0.1, 0.6)}};
}

constexpr Family families[] = {{"matte", "diffuse", matte},
                               {"varnish", "coated-diffuse", varnish},
                               {"polish", "interfaced-diffuse", polish},
                               {"haze", "glossy", haze},
                               {"varnish", "coated-diffuse", varnish},
                               {"metal", "glossy-metal", metal},
                               {"polish", "interfaced-diffuse", polish},
                               {"metallic paint", "glossy-metal", metallic_paint},
                               {"fabric", "glossy", fabric},
                               {"varnish", "coated-diffuse", varnish}};

Material material(std::uint64_t seed, std::size_t number) {
  const Family& family = families[number % std::size(families)];
  const surface::Model& model = *surface::find(family.model);
  Draw draw(seed, number);
  const std::string name = std::string(family.name) + " " + std::to_string(number);
  surface::Values values = surface::values_of(model, family.parameters(draw), name);
  const auto prepared = model.prepare(values, {}, name);
  values.prepared = prepared.get();
  return {name, [&model, values, prepared](Vec3 wo, Vec3 wi) { return model.evaluate(values, wo, wi); }};
}

}  // namespace

std::vector<Material> builtin_materials(const BuiltinOptions& options) {
  std::vector<Material> materials;
  for (std::size_t i = 0; i < options.materials; ++i) materials.push_back(material(options.seed, i));
  return materials;
}

Basis builtin_basis(const BuiltinOptions& builtin, const BasisOptions& options) {
  const std::vector<Material> materials = builtin_materials(builtin);
  return {
      *tables_of(materials, builtin.bins),
      std::to_string(materials.size()) + " materials drawn from gonio's own surface models (built in, no measurements)",
      options};
}

}  // namespace gonio::goniometry
