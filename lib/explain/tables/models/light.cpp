// Model "light": irradiance on small planes, made by the lamps that the manifest describes. Base: the registered lights
// (lib/light) with their free parameters; candidates: what scene/mechanisms.h can do to a lamp, and
// light.inverse-square for lamps that the base believes infinitely far.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "explain/tables/lamp_state.h"
#include "explain/tables/model_parameters.h"
#include "explain/tables/table_conditions.h"
#include "manifest/document.h"
#include "manifest/sections/table.h"

namespace gonio::explain::tables {
namespace {

struct Spot {
  Vec3 point_m, normal;
  std::size_t lamp = 0;
  int channel = -1;     // -1: the mean of the three bands
  double exposure = 1;  // factor
};

std::vector<Vec3> points_of(const Table& table) {
  const std::vector<double>&x = table.needed("x_m", "m"), &y = table.needed("y_m", "m"), &z = table.needed("z_m", "m");
  std::vector<Vec3> points;
  for (std::size_t r = 0; r < table.rows(); ++r) points.push_back({x[r], y[r], z[r]});
  return points;
}
Vec3 centre_of(const Table& table) {
  Vec3 sum;
  for (const Vec3& p : points_of(table)) sum = sum + p;
  return sum * (1 / static_cast<double>(table.rows()));
}

std::vector<std::string> lamps_of(const manifest::Table& section, const Table& table) {
  const std::size_t lamp = table.place_of("lamp");
  if (lamp != Table::none && !table.labels[lamp].empty()) return table.labels[lamp];
  if (section.light.empty())
    throw Error(Exit::data, table.place, "does not say which light it measures",
                "name one of `lights` as \"light\", or in a column lamp");
  return {section.light};
}

int channel_of(const Table& table, std::size_t column, std::size_t row) {
  const double value = table.values[column][row];
  const int channel = static_cast<int>(value);
  if (table.labels[column].empty()) {
    if (channel == value && channel >= 0 && channel < 3) return channel;
  } else {
    const std::string& label = table.labels[column][static_cast<std::size_t>(value)];
    for (int c = 0; c < 3; ++c)
      if (!label.empty() && (label[0] == "RGB"[c] || label[0] == "rgb"[c])) return c;
  }
  throw Error(Exit::data, table.place, "has a channel that is none of 0, 1, 2 (red, green, blue)");
}

class Illumination final : public BoundModel {
 public:
  Illumination(const manifest::Document& document, const std::string& name, const Table& table)
      : name_(name),
        centre_m_(centre_of(table)),
        lamps_(document, lamps_of(document.tables.at(name), table), centre_m_, points_of(table),
               table.place + "/light") {
    if (table.observed.size() != 1)
      throw Error(Exit::data, table.place + "/observed", "names " + std::to_string(table.observed.size()) + " columns",
                  "model light predicts one: the irradiance");
    read_spots(table);
    parameters_ = lamps_.parameters();
    base_ = lamps_.base();
    candidates_ = lamps_.candidates();
    ModelParameter gain = model_parameter(document.tables.at(name), name, "gain", "1", 1, false);
    gain_ = parameters_.size();
    if (gain.free) base_.push_back(gain_);
    parameters_.push_back(std::move(gain.parameter));
    add_conditions(table);
  }

  void predict(std::span<const double> values, std::size_t first, std::size_t last,
               std::span<double> prediction) const override {
    const std::vector<scene::Light> lamps = lamps_.at(values);
    const std::vector<LampLight> light(lamps.begin(), lamps.end());
    for (std::size_t r = first; r < last; ++r) {
      const Spot& s = spots_[r];
      Rgb e = light[s.lamp].irradiance(s.point_m, s.normal);
      if (light.size() > lamps_.lamps().size()) e = e + light.back().irradiance(s.point_m, s.normal);
      const double band = s.channel < 0 ? (e.x + e.y + e.z) / 3 : e[s.channel];
      prediction[r - first] = values[gain_] * band * s.exposure;
    }
  }
  void apply(std::span<const double> values, std::span<const double> sigma,
             manifest::Document& document) const override {
    lamps_.apply(values, sigma, document);
    if (sigma[gain_] > 0) store_parameter(document.tables.at(name_), "gain", values[gain_], sigma[gain_]);
  }

 private:
  void read_spots(const Table& table) {
    const std::vector<double>&x = *table.find("x_m"), &y = *table.find("y_m"), &z = *table.find("z_m");
    const std::vector<double>*nx = table.find("nx"), *ny = table.find("ny"), *nz = table.find("nz");
    const std::vector<double>* exposure = table.find("exposure_s");
    const std::size_t lamp = table.place_of("lamp"), channel = table.place_of("channel");
    for (std::size_t r = 0; r < table.rows(); ++r) {
      Spot s{{x[r], y[r], z[r]}, {0, 0, 1}, 0, -1, exposure == nullptr ? 1 : (*exposure)[r]};
      if (nx != nullptr && ny != nullptr && nz != nullptr) s.normal = {(*nx)[r], (*ny)[r], (*nz)[r]};
      if (!(gonio::norm(s.normal) > 0)) throw Error(Exit::data, table.place, "has a normal without length");
      s.normal = normalized(s.normal);
      if (lamp != Table::none && !table.labels[lamp].empty()) s.lamp = static_cast<std::size_t>(table.values[lamp][r]);
      if (channel != Table::none) s.channel = channel_of(table, channel, r);
      spots_.push_back(s);
    }
  }

  void add_conditions(const Table& table) {
    const auto named = [](const char* name, const char* unit) { return Condition{name, unit, "light", {}, {}}; };
    Condition distance = named("light.distance", "m"), emission = named("light.emission-angle", "rad");
    Condition incidence = named("light.incidence-angle", "rad"), of_surface = named("surface.incidence-angle", "rad");
    Condition x = named("scene.x", "m"), y = named("scene.y", "m"), z = named("scene.z", "m");
    for (const Spot& s : spots_) {
      const Sight sight = sight_of(lamps_.lamps()[s.lamp], s.point_m, centre_m_);
      distance.values.push_back(sight.distance_m);
      incidence.values.push_back(std::acos(std::clamp(dot(sight.towards, s.normal), -1.0, 1.0)));
      of_surface.values.push_back(incidence.values.back());
      emission.values.push_back(sight.emission_rad);
      x.values.push_back(s.point_m.x);
      y.values.push_back(s.point_m.y);
      z.values.push_back(s.point_m.z);
    }
    for (Condition* c : {&distance, &emission, &incidence, &of_surface, &x, &y, &z}) {
      const auto [least, most] = std::minmax_element(c->values.begin(), c->values.end());
      if (*most - *least > 1e-9 * (std::abs(*least) + std::abs(*most))) conditions_.push_back(std::move(*c));
    }
    for (const char* column : {"exposure_s", "lamp", "channel"})
      if (std::optional<Condition> c = condition_of(table, column)) conditions_.push_back(std::move(*c));
  }

  std::string name_;
  Vec3 centre_m_;
  LampState lamps_;
  std::vector<Spot> spots_;
  std::size_t gain_ = 0;
};

}  // namespace

const Model& light() {
  static const Model model{.name = "light",
                           .sentence = "Irradiance on small planes, made by the manifest's lights.",
                           .columns = {{"x_m", "m", "where, in the world's frame"},
                                       {"y_m", "m", "where"},
                                       {"z_m", "m", "where"},
                                       {"nx", "1", "normal of the plane; left out: +z", false},
                                       {"ny", "1", "normal", false},
                                       {"nz", "1", "normal", false},
                                       {"lamp", "", "name of the light that is on", false},
                                       {"channel", "", "0, 1, 2: red, green, blue; left out: their mean", false},
                                       {"exposure_s", "s", "factor on the reading", false}},
                           .bind = bind_as<Illumination>};
  return model;
}

}  // namespace gonio::explain::tables
