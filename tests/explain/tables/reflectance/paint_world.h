// Reflectance tables made in memory: five series of incidence over a hemisphere of exitances, finer about the mirror
// direction, with noise that is even on the scale of comparison.
#pragma once
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "explain/tables/reflectance_rows.h"
#include "explain/tables/table_world.h"
#include "geom/angle.h"
#include "surface/surface.h"

namespace gonio::explain::tables::tests {

struct Paint {
  std::string base = R"({"model": "diffuse", "albedo": {"value": 0.3, "free": true}})";
  std::vector<double> wavelengths_m;  // empty: one band
  bool excited = false;               // every geometry without and with light that excites
  double noise = 0.01;
  std::vector<double> turns = {0};  // azimuths of the light, degrees: the sample is rotated
};

// f of directions, wavelength and excitation.
using Reflectance = std::function<double(Vec3 wo, Vec3 wi, double wavelength_m, double excitation)>;

inline World paint_world(const Paint& paint, const Reflectance& reflectance, std::uint64_t seed) {
  World w;
  w.columns = {{"theta_i", "rad"}, {"phi_i", "rad"}, {"theta_o", "rad"}, {"phi_o", "rad"}, {"f", "1/sr"}};
  if (!paint.wavelengths_m.empty()) w.columns.emplace_back("wavelength_m", "m");
  if (paint.excited) w.columns.emplace_back("excitation", "1");
  w.sections = "\"surfaces\": {\"s\": " + paint.base + "},";
  w.rest = R"("model": "surface", "surface": "s", "observed": ["f"])";
  Random random(seed, 5);
  const auto direction = [](double theta, double phi) {
    return Vec3{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
  };
  const auto add_turned = [&](double turn, double ti, double to, double po) {
    const Vec3 wi = direction(ti, turn), wo = direction(to, po + turn);
    if (wo.z < 0.05) return;
    const std::vector<double> bands = paint.wavelengths_m.empty() ? std::vector<double>{0} : paint.wavelengths_m;
    for (const double band : bands)
      for (const double excitation : paint.excited ? std::vector<double>{0, 1} : std::vector<double>{0}) {
        const double weight = 100 * wi.z * wo.z;
        const double z =
            scaled_reflectance(reflectance(wo, wi, band, excitation), weight) + paint.noise * random.normal();
        std::vector<double> row = {ti, turn, to, po + turn, std::expm1(z) / weight};
        if (!paint.wavelengths_m.empty()) row.push_back(band);
        if (paint.excited) row.push_back(excitation);
        w.rows.push_back(row);
      }
  };
  const auto add = [&](double ti, double to, double po) {
    for (const double turn : paint.turns) add_turned(turn * degree, ti, to, po);
  };
  for (const double incidence : {10.0, 25.0, 40.0, 55.0, 70.0}) {
    for (int t = 5; t <= 80; t += 15)
      for (int p = 15; p < 360; p += 30) add(incidence * degree, t * degree, p * degree);
    for (const double off : {-24.0, -12.0, -5.0, 0.0, 5.0, 12.0, 24.0})
      for (const double turn : {-20.0, 0.0, 20.0})
        add(incidence * degree, (incidence + off) * degree, (180 + turn) * degree);
  }
  return w;
}

// A registered model in one band, its parameters by name; others at their presets.
inline Reflectance registered(const std::string& id, const std::vector<std::pair<std::string, double>>& parameters) {
  const surface::Model* model = surface::find(id);
  manifest::Parameters given;
  for (const auto& [name, value] : parameters) given[name] = manifest::Parameter(value);
  const surface::Values values = surface::values_of(*model, given, "test");
  return [model, values](Vec3 wo, Vec3 wi, double, double) { return model->evaluate(values, wo, wi).x; };
}

}  // namespace gonio::explain::tables::tests
