// Model "volume": a clear plate.
//   transmittance, theta the angle of incidence (0 where the table has none), R Fresnel's unpolarized reflectance:
//     T = gain (1 - R) / (1 + R)       all reflections between the two faces (Born & Wolf 1999, section 1.6.4)
//   angle of refraction, where the observed column is an angle: sin(theta_t) = sin(theta_i) / eta.
// The index is eta + shift + cauchy_m2 (1 / lambda^2 - 1 / lambda_D^2).
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "explain/tables/model_parameters.h"
#include "explain/tables/table_conditions.h"
#include "explain/tables/table_model.h"
#include "manifest/document.h"
#include "manifest/sections/table.h"
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& volume_dispersion();
const Mechanism& volume_index();
}  // namespace gonio::mechanism

namespace gonio::explain::tables {
namespace {

constexpr double sodium_m = 589.3e-9;

double fresnel(double cosine, double eta) {
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine)) / eta;
  if (sine >= 1) return 1;
  const double inner = std::sqrt(1 - sine * sine);
  const double s = (cosine - eta * inner) / (cosine + eta * inner), p = (eta * cosine - inner) / (eta * cosine + inner);
  return 0.5 * (s * s + p * p);
}

class Plate final : public BoundModel {
 public:
  Plate(const manifest::Document& document, const std::string& name, const Table& table) : name_(name) {
    if (table.observed.size() != 1)
      throw Error(Exit::data, table.place + "/observed", "names " + std::to_string(table.observed.size()) + " columns",
                  "model volume predicts one: a transmittance, or an angle of refraction");
    refraction_ = table.units[table.observed[0]] == "rad";
    const auto optional = [&](const char* column, const char* unit) {
      return table.find(column) == nullptr ? std::vector<double>{} : table.needed(column, unit);
    };
    theta_ = refraction_ ? table.needed("theta_i", "rad") : optional("theta_i", "rad");
    wavelength_ = optional("wavelength_m", "m");
    if (!refraction_) table.needed("path_m", "m");
    const manifest::Table& section = document.tables.at(name);
    add(model_parameter(section, name, "gain", "1", 1, false));
    ModelParameter eta = model_parameter(section, name, "eta", "1", 1.5, false);
    eta.parameter.lower = std::max(eta.parameter.lower, 1.0);
    const bool index_is_free = eta.free;
    add(std::move(eta));
    add_mechanism(mechanism::volume_index(), !index_is_free && !theta_.empty());
    add_mechanism(mechanism::volume_dispersion(), !wavelength_.empty() && table.varies("wavelength_m"));
    for (const char* column : {"path_m", "theta_i", "wavelength_m"})
      if (std::optional<Condition> c = condition_of(table, column)) conditions_.push_back(std::move(*c));
  }

  void predict(std::span<const double> values, std::size_t first, std::size_t last,
               std::span<double> prediction) const override {
    for (std::size_t r = first; r < last; ++r) {
      const double eta = index(values, r), theta = theta_.empty() ? 0 : theta_[r];
      if (refraction_) {
        prediction[r - first] = values[0] * std::asin(std::clamp(std::sin(theta) / eta, -1.0, 1.0));
        continue;
      }
      const double reflected = fresnel(std::cos(theta), eta);
      prediction[r - first] = values[0] * (1 - reflected) / (1 + reflected);
    }
  }
  void apply(std::span<const double> values, std::span<const double> sigma,
             manifest::Document& document) const override {
    for (std::size_t k = 0; k < 2; ++k)
      if (sigma[k] > 0) store_parameter(document.tables.at(name_), k == 0 ? "gain" : "eta", values[k], sigma[k]);
  }

 private:
  void add(ModelParameter p) {
    if (p.free) base_.push_back(parameters_.size());
    parameters_.push_back(std::move(p.parameter));
  }
  void add_mechanism(const mechanism::Mechanism& m, bool offered) {
    const mechanism::Parameter& p = m.parameters.at(0);
    if (offered) candidates_.push_back({&m, {}, {parameters_.size()}, {}});
    parameters_.push_back(
        {m.id + "." + p.name, p.unit, p.start, p.neutral, p.lower, p.upper, std::abs(p.start), {}, {}});
  }
  double index(std::span<const double> values, std::size_t row) const {
    double eta = values[1] + values[2];
    if (values[3] != 0) eta += values[3] * (1 / (wavelength_[row] * wavelength_[row]) - 1 / (sodium_m * sodium_m));
    return std::max(1.0, eta);
  }

  std::string name_;
  bool refraction_ = false;
  std::vector<double> theta_, wavelength_;
};

}  // namespace

const Model& volume() {
  static const Model model{.name = "volume",
                           .sentence = "Transmittance of a clear plate, or the angle of refraction into it.",
                           .columns = {{"path_m", "m", "length through the material (transmittance)"},
                                       {"theta_i", "rad", "angle of incidence", false},
                                       {"wavelength_m", "m", "in vacuum", false}},
                           .bind = bind_as<Plate>};
  return model;
}

}  // namespace gonio::explain::tables
