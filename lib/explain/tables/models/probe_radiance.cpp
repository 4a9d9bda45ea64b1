// Model "probe-radiance": what mirror balls show of one direction of the surroundings, read in several views. The base
// model is
//   value = radiance R(theta_i),
// the radiance of each direction (and channel) one free number, R the Fresnel reflectance (surface/fresnel.h) of the
// metal whose complex index stands in metal_n and metal_k; without these columns a mirror that reflects all light. Only
// how R changes with the incidence can be seen, since radiances are free: what may be left out is probe.reflectance,
// with Schlick's rise alone, or with Lazanyi's dip besides.
#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/text.h"
#include "explain/tables/image_views.h"
#include "explain/tables/table_conditions.h"
#include "explain/tables/table_model.h"
#include "manifest/document.h"
#include "manifest/sections/table.h"
#include "probe/mechanisms/probe_reflectance.h"
#include "stats/intervals.h"
#include "surface/fresnel.h"

namespace gonio::explain::tables {
namespace {

class ProbeRadiance final : public BoundModel {
 public:
  ProbeRadiance(const manifest::Document&, const std::string& name, const Table& table) : name_(name) {
    if (table.observed.size() != 1)
      throw Error(Exit::data, table.place + "/observed", "names " + std::to_string(table.observed.size()) + " columns",
                  "model probe-radiance predicts one: the radiance that was read");
    read_balls(table);
    bind_radiances(table);
    bind_metal();
    for (const char* column : {"theta_i", "channel"})
      if (std::optional<Condition> c = condition_of(table, column)) conditions_.push_back(std::move(*c));
  }

  void predict(std::span<const double> values, std::size_t first, std::size_t last,
               std::span<double> prediction) const override {
    for (std::size_t r = first; r < last; ++r)
      prediction[r - first] = values[radiance_of_row_[r]] * reflectance(values, r);
  }
  void apply(std::span<const double> values, std::span<const double> sigma,
             manifest::Document& document) const override {
    manifest::Table& section = document.tables.at(name_);
    manifest::Parameter radiances;
    std::vector<double> deviations;
    for (const std::size_t p : base_) radiances.value.push_back(values[p]), deviations.push_back(sigma[p]);
    section.parameters["radiance"] = radiances;
    section.sigmas["radiance"] = deviations;
  }

 private:
  double reflectance(std::span<const double> values, std::size_t row) const {
    return equation::probe_reflectance(stated_[row], cosine_[row], values[normal_], values[dip_]);
  }

  void read_balls(const Table& table) {
    for (const double t : table.needed("theta_i", "rad")) {
      if (!(t >= 0) || !(t < pi / 2))
        throw Error(Exit::data, table.place, "has a row with theta_i " + shortest_text(t) + " rad",
                    "angles of incidence lie between 0 and 90 degrees");
      cosine_.push_back(std::cos(t));
    }
    const bool metal = table.find("metal_n") != nullptr || table.find("metal_k") != nullptr;
    for (std::size_t r = 0; r < table.rows(); ++r) {
      if (!metal) {
        stated_.push_back(1);
        continue;
      }
      const double n = table.needed("metal_n", "1")[r], k = table.needed("metal_k", "1")[r];
      if (!(n > 0) || !(k >= 0))
        throw Error(Exit::data, table.place,
                    "has a row with metal_n " + shortest_text(n) + " and metal_k " + shortest_text(k),
                    "state the metal's index n + i k, n above 0 and k not below");
      stated_.push_back(surface::fresnel_metal(cosine_[r], n, k));
    }
  }

  void bind_radiances(const Table& table) {
    const std::vector<double>& direction = table.needed("direction", "");
    const std::vector<double>* channel = table.find("channel");
    std::map<std::pair<double, double>, std::vector<std::size_t>> rows;
    for (std::size_t r = 0; r < table.rows(); ++r)
      rows[{direction[r], channel == nullptr ? 0 : (*channel)[r]}].push_back(r);
    radiance_of_row_.resize(table.rows());
    for (const auto& [key, own] : rows) {
      std::vector<double> seen;
      for (const std::size_t r : own) {
        seen.push_back(table.values[table.observed[0]][r] / stated_[r]);
        radiance_of_row_[r] = parameters_.size();
      }
      Parameter p;
      p.name = "tables/" + name_ + "/radiance/" + std::to_string(parameters_.size());
      p.unit = "W/(m^2 sr)";
      p.start = p.neutral = stats::median(seen);
      p.size = p.start != 0 ? std::abs(p.start) : 1;
      p.groups = groups_reached(table, [&](std::size_t r) { return std::ranges::find(own, r) != own.end(); });
      base_.push_back(parameters_.size());
      parameters_.push_back(std::move(p));
    }
  }

  void bind_metal() {
    const mechanism::Mechanism& m = mechanism::probe_reflectance();
    normal_ = parameters_.size(), dip_ = normal_ + 1;
    for (const mechanism::Parameter& d : m.parameters)
      parameters_.push_back({m.id + "." + d.name, d.unit, d.start, d.neutral, d.lower, d.upper, 0.1, {}, {}});
    candidates_.push_back({&m, {}, {normal_}, m.id});
    candidates_.push_back({&m, {}, {normal_, dip_}, m.id, true});
  }

  std::string name_;
  std::vector<double> cosine_, stated_;
  std::vector<std::size_t> radiance_of_row_;
  std::size_t normal_ = 0, dip_ = 0;
};

}  // namespace

const Model& probe_radiance() {
  static const Model model{
      .name = "probe-radiance",
      .sentence =
          "What mirror balls show of one direction in several views: its radiance times the metal's reflectance.",
      .columns = {{"theta_i", "rad", "angle of incidence on the ball"},
                  {"direction", "", "of the surroundings, whose radiance is one unknown number"},
                  {"channel", "", "each has radiances of its own", false},
                  {"metal_n", "1", "real part of the metal's index in the row's band", false},
                  {"metal_k", "1", "imaginary part; without both: all light is reflected", false}},
      .group_noun = "view",
      .group = "view",
      .bind = bind_as<ProbeRadiance>};
  return model;
}

}  // namespace gonio::explain::tables
