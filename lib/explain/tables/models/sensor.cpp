// Model "sensor": the reading of an ideal sensor is proportional to light and time,
//   value = gain radiance exposure,
// (EMVA Standard 1288, release 4.0, section 2.1). The radiance of each row is a known column, or that of a patch, one
// unknown number for each patch (and channel), the gain then standing still.
#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "explain/tables/model_parameters.h"
#include "explain/tables/table_conditions.h"
#include "explain/tables/table_model.h"
#include "manifest/document.h"
#include "manifest/sections/table.h"
#include "stats/intervals.h"

namespace gonio::explain::tables {
namespace {

constexpr std::size_t none = Table::none;

class Sensor final : public BoundModel {
 public:
  Sensor(const manifest::Document& document, const std::string& name, const Table& table) : name_(name) {
    if (table.observed.size() != 1)
      throw Error(Exit::data, table.place + "/observed", "names " + std::to_string(table.observed.size()) + " columns",
                  "model sensor predicts one: the reading");
    exposure_ = table.needed("exposure_s", "s");
    for (const double t : exposure_)
      if (!(t > 0)) throw Error(Exit::data, table.place, "exposure_s is not above 0 in some row");
    const manifest::Table& section = document.tables.at(name);
    gain_of_row_.assign(table.rows(), 0);
    radiance_of_row_.assign(table.rows(), none);
    if (const std::vector<double>* radiance = table.find("radiance"))
      bind_known(section, table, *radiance);
    else
      bind_patches(section, table);
    for (const char* column : {"exposure_s", "radiance", "channel"})
      if (std::optional<Condition> c = condition_of(table, column)) conditions_.push_back(std::move(*c));
  }

  void predict(std::span<const double> values, std::size_t first, std::size_t last,
               std::span<double> prediction) const override {
    for (std::size_t r = first; r < last; ++r)
      prediction[r - first] = values[gain_of_row_[r]] * radiance(values, r) * exposure_[r];
  }
  void jacobian(std::span<const double> values, std::size_t first, std::size_t last,
                std::span<const std::size_t> columns, std::span<double> derivatives) const override {
    for (std::size_t k = 0; k < columns.size(); ++k)
      for (std::size_t r = first; r < last; ++r) {
        double& d = derivatives[k * (last - first) + r - first];
        d = columns[k] == gain_of_row_[r]       ? radiance(values, r) * exposure_[r]
            : columns[k] == radiance_of_row_[r] ? values[gain_of_row_[r]] * exposure_[r]
                                                : 0;
      }
  }
  void apply(std::span<const double> values, std::span<const double> sigma,
             manifest::Document& document) const override {
    manifest::Table& section = document.tables.at(name_);
    manifest::Parameter patches;
    std::vector<double> patch_sigma;
    for (std::size_t p = 0; p < parameters_.size(); ++p) {
      const std::string& full = parameters_[p].name;
      const std::string name = full.substr(std::string("tables/" + name_ + "/").size());
      if (!name.starts_with("radiance/")) {
        store_parameter(section, name, values[p], sigma[p]);
        continue;
      }
      patches.value.push_back(values[p]);
      patch_sigma.push_back(sigma[p]);
    }
    if (patches.value.empty()) return;
    section.parameters["radiance"] = patches;
    section.sigmas["radiance"] = patch_sigma;
  }

 private:
  double radiance(std::span<const double> values, std::size_t row) const {
    return radiance_of_row_[row] == none ? known_[row] : values[radiance_of_row_[row]];
  }
  void add(ModelParameter p) {
    if (p.free) base_.push_back(parameters_.size());
    parameters_.push_back(std::move(p.parameter));
  }

  // One gain, or one for each channel.
  void bind_known(const manifest::Table& section, const Table& table, const std::vector<double>& radiance) {
    known_ = radiance;
    const std::vector<double>* channel = table.find("channel");
    std::map<double, std::size_t> gains;
    for (std::size_t r = 0; r < table.rows(); ++r) {
      const double of_row = channel == nullptr ? 0 : (*channel)[r];
      const auto [entry, fresh] = gains.try_emplace(of_row, parameters_.size());
      gain_of_row_[r] = entry->second;
      if (!fresh) continue;
      std::vector<double> ratio;
      const std::vector<double>& y = table.values[table.observed[0]];
      for (std::size_t i = 0; i < table.rows(); ++i)
        if ((channel == nullptr || (*channel)[i] == of_row) && known_[i] != 0)
          ratio.push_back(y[i] / (known_[i] * exposure_[i]));
      const std::string name = channel == nullptr ? "gain" : "gain_" + std::to_string(gains.size() - 1);
      add(model_parameter(section, name_, name, "1", ratio.empty() ? 1 : stats::median(ratio), true));
    }
  }

  void bind_patches(const manifest::Table& section, const Table& table) {
    ModelParameter gain = model_parameter(section, name_, "gain", "1", 1, false);
    gain.free = false;  // its product with the radiances is what is seen
    add(std::move(gain));
    const std::size_t patch = table.place_of("patch");
    const std::vector<double>* channel = table.find("channel");
    std::map<std::pair<double, double>, std::vector<std::size_t>> rows;
    for (std::size_t r = 0; r < table.rows(); ++r)
      rows[{patch == none ? 0 : table.values[patch][r], channel == nullptr ? 0 : (*channel)[r]}].push_back(r);
    for (const auto& [key, own] : rows) {
      std::vector<double> ratio;
      for (const std::size_t r : own) {
        ratio.push_back(table.values[table.observed[0]][r] / (parameters_[0].start * exposure_[r]));
        radiance_of_row_[r] = parameters_.size();
      }
      Parameter p;
      p.name = "tables/" + name_ + "/radiance/" + std::to_string(parameters_.size() - 1);
      p.unit = "W/(m^2 sr)";
      p.start = p.neutral = stats::median(ratio);
      p.size = p.start != 0 ? std::abs(p.start) : 1;
      for (std::size_t g = 0; g < table.group.size(); ++g) {
        const auto inside = [&](std::size_t r) { return r >= table.first[g] && r < table.first[g + 1]; };
        if (std::any_of(own.begin(), own.end(), inside)) p.groups.push_back(g);
      }
      if (p.groups.size() == table.group.size()) p.groups.clear();
      add({std::move(p), true});
    }
  }

  std::string name_;
  std::vector<double> exposure_, known_;
  std::vector<std::size_t> gain_of_row_, radiance_of_row_;
};

}  // namespace

const Model& sensor() {
  static const Model model{.name = "sensor",
                           .sentence = "Grey level against exposure: gain * radiance * exposure.",
                           .columns = {{"exposure_s", "s", "how long light was collected"},
                                       {"radiance", "", "known radiance, in any unit; or", false},
                                       {"patch", "", "whose radiance is one unknown number", false},
                                       {"channel", "", "each has a gain, or radiances, of its own", false}},
                           .bind = bind_as<Sensor>};
  return model;
}

}  // namespace gonio::explain::tables
