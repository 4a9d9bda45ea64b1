// Model "surface" of tables: samples of a BRDF, f in 1/sr, against the directions of light and eye. Forward model,
// terms and scale: explain/tables/reflectance_{surface,parameters,rows}.h.
#include "manifest/sections/surface.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "explain/tables/model_parameters.h"
#include "explain/tables/reflectance_parameters.h"
#include "geom/angle.h"
#include "manifest/document.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/table.h"

namespace gonio::explain::tables {
namespace {

using Kind = ReflectanceSlot::Kind;
constexpr double step_share = 1e-4;  // of a parameter's size

class BoundSurface final : public BoundModel {
 public:
  BoundSurface(const manifest::Document& document, const std::string& name, const Table& table)
      : name_(name), rows_(reflectance_rows(table)), p_(reflectance_parameters(document, name, table, rows_)) {
    parameters_ = p_.parameters;
    base_ = p_.base;
    candidates_ = p_.candidates;
    conditions_ = reflectance_conditions(rows_);
    std::vector<double> f;
    for (std::size_t r = 0; r < table.rows(); ++r)
      for (const std::size_t column : table.observed) f.push_back(table.values[column][r]);
    noise_ = reflectance_noise(rows_, f);
  }

  void predict(std::span<const double> values, std::size_t first, std::size_t last,
               std::span<double> prediction) const override {
    const ReflectanceState state = p_.state(values);
    ReflectanceEvaluation f(state, rows_);
    for (std::size_t r = first, i = 0; r < last; ++r)
      for (std::size_t k = 0; k < rows_.observed; ++k, ++i) prediction[i] = f(r, rows_.band[r * rows_.observed + k]);
  }

  // One-sided differences, into the bounds. The numbers of one colour move each its own band, and are moved together;
  // what moves a term alone keeps the model's part.
  void jacobian(std::span<const double> values, std::size_t first, std::size_t last,
                std::span<const std::size_t> columns, std::span<double> derivatives) const override {
    const std::size_t n = rows_.observed, count = (last - first) * n;
    const ReflectanceState here = p_.state(values);
    ReflectanceEvaluation f_here(here, rows_);
    std::vector<ReflectanceEvaluation::Shared> shared(count);
    std::vector<double> f(count);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t band = rows_.band[first * n + i], row = first + i / n;
      shared[i] = f_here.look(row, band / 3);
      f[i] = f_here.value(row, band, shared[i]);
    }
    std::vector<char> done(columns.size(), 0);
    for (std::size_t c = 0; c < columns.size(); ++c) {
      if (done[c]) continue;
      std::vector<double> moved(values.begin(), values.end());
      const std::vector<std::pair<std::size_t, std::size_t>> together = move(columns, c, moved);
      const ReflectanceState state = p_.state(moved);
      ReflectanceEvaluation f_moved(state, rows_);
      const Kind kind = p_.slots[columns[c]].kind;
      // A term that is off has left nothing to keep.
      const bool keeps = (kind == Kind::film && here.film.film_m > 0) || kind == Kind::fluorescence ||
                         (kind == Kind::ridges && here.ridges.share > 0);
      for (const auto& [column, band] : together) {
        done[column] = 1;
        const std::size_t p = columns[column];
        const double step = moved[p] - values[p];
        for (std::size_t i = 0; i < count; ++i) {
          const std::size_t own = rows_.band[first * n + i], row = first + i / n;
          double& slope = derivatives[column * count + i];
          slope = 0;
          if (band != ReflectanceSlot::all && band != own) continue;
          slope = ((keeps ? f_moved.value(row, own, shared[i]) : f_moved(row, own)) - f[i]) / step;
        }
      }
    }
  }

  double scaled(double value, std::size_t row) const override { return scaled_reflectance(value, rows_.weight[row]); }
  std::vector<double> norm() const override { return std::vector<double>(rows_.band.size(), 1.0); }
  std::vector<double> sigma() const override { return std::vector<double>(rows_.band.size(), noise_); }

  void apply(std::span<const double> values, std::span<const double> sigma,
             manifest::Document& document) const override {
    manifest::Surface& surface = document.surfaces.at(p_.surface);
    manifest::Table& table = document.tables.at(name_);
    for (std::size_t p = 0; p < p_.slots.size(); ++p) {
      const ReflectanceSlot& slot = p_.slots[p];
      if (slot.kind == Kind::gain)
        store_parameter(table, slot.name, values[p], sigma[p]);
      else if (slot.kind != Kind::base)
        apply_mechanism(p, values, sigma, document);
      else if (slot.band == ReflectanceSlot::all)
        surface.parameters[slot.name].value = {values[p]}, surface.sigma[slot.name] = {sigma[p]};
      else
        apply_colour(p, values, sigma, surface, table);
    }
  }

  std::vector<Proposal> proposals() const override {
    std::vector<Proposal> list;
    for (const double incidence : {10.0, 45.0, 70.0, 82.0})
      for (const double turn : {0.0, 90.0}) {
        const std::string sentence = "a scan from " + std::to_string(static_cast<int>(incidence)) +
                                     " degrees of incidence" + (turn > 0 ? ", the sample rotated by 90 degrees" : "");
        list.push_back({sentence, manifest::Value::object({{"theta_i_deg", incidence}, {"phi_i_deg", turn}})});
      }
    return list;
  }
  // In the plane of incidence and across it, all bands, on the scale of comparison.
  ProposedRows propose(std::span<const double> values, std::size_t proposal) const override {
    const manifest::Value setup = proposals().at(proposal).setup;
    const double theta_i = setup.find("theta_i_deg")->as_number() * degree,
                 phi_i = setup.find("phi_i_deg")->as_number() * degree;
    ReflectanceRows rows;
    rows.band_name = rows_.band_name, rows.band_m = rows_.band_m;
    const auto add = [&](double theta, double phi) {
      for (std::size_t b = 0; b < rows_.band_name.size(); ++b) {
        rows.wi.push_back(
            {std::sin(theta_i) * std::cos(phi_i), std::sin(theta_i) * std::sin(phi_i), std::cos(theta_i)});
        rows.wo.push_back({std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)});
        rows.weight.push_back(100 * std::cos(theta_i) * std::cos(theta));
        rows.band.push_back(b);
        if (!rows_.excitation.empty()) rows.excitation.push_back(rows_.excitation[0]);
      }
    };
    for (int t = -80; t <= 80; t += 4) add(t * degree, phi_i), add(t * degree, phi_i + pi / 2);
    const ReflectanceState state = p_.state(values);
    ReflectanceEvaluation f(state, rows);
    ProposedRows proposed;
    for (std::size_t r = 0; r < rows.rows(); ++r)
      proposed.prediction.push_back(scaled_reflectance(f(r, rows.band[r]), rows.weight[r]));
    proposed.sigma.assign(rows.rows(), noise_);
    return proposed;
  }

 private:
  // Moves column c, and with it the other bands' numbers of the same colour; returns columns and their bands.
  std::vector<std::pair<std::size_t, std::size_t>> move(std::span<const std::size_t> columns, std::size_t c,
                                                        std::vector<double>& values) const {
    std::vector<std::pair<std::size_t, std::size_t>> moved;
    const ReflectanceSlot& slot = p_.slots[columns[c]];
    for (std::size_t other = c; other < columns.size(); ++other) {
      const ReflectanceSlot& o = p_.slots[columns[other]];
      const bool colour = slot.band != ReflectanceSlot::all && o.kind == slot.kind && o.name == slot.name;
      if (other != c && !colour) continue;
      const Parameter& parameter = parameters_[columns[other]];
      double& v = values[columns[other]];
      const double step = step_share * parameter.size;
      v += v + step <= parameter.upper ? step : -step;
      moved.emplace_back(other, o.band);
    }
    return moved;
  }
  // A colour of three channels goes to the surface; of other bands, its numbers to the table and what stands for red,
  // green and blue to the surface.
  void apply_colour(std::size_t p, std::span<const double> values, std::span<const double> sigma,
                    manifest::Surface& surface, manifest::Table& table) const {
    const ReflectanceSlot& slot = p_.slots[p];
    const std::size_t bands = rows_.band_name.size();
    manifest::Parameter& colour = surface.parameters[slot.name];
    std::vector<double>& colour_sigma = surface.sigma[slot.name];
    if (bands == 1) {
      colour.value = {values[p]}, colour_sigma = {sigma[p]};
      return;
    }
    if (colour.value.size() != 3) colour.value.assign(3, colour.given() ? colour.value[0] : values[p]);
    colour_sigma.resize(3);
    const auto c = static_cast<std::size_t>(rows_.component(slot.band));
    colour.value[c] = values[p], colour_sigma[c] = sigma[p];
    if (rows_.band_m.empty() && bands <= 3) return;
    manifest::Parameter& all = table.parameters[slot.name];
    if (all.value.size() != bands) all.value.assign(bands, 0.0);
    table.sigmas[slot.name].resize(bands);
    all.value[slot.band] = values[p], table.sigmas[slot.name][slot.band] = sigma[p];
  }

  // Fitted numbers carry a sigma; those of mechanisms that are not in play have none and are not written.
  void apply_mechanism(std::size_t p, std::span<const double> values, std::span<const double> sigma,
                       manifest::Document& document) const {
    const ReflectanceSlot& slot = p_.slots[p];
    if (!(sigma[p] > 0)) return;
    manifest::MechanismUse& use = document.mechanisms[slot.mechanism];
    if (std::find(use.on.begin(), use.on.end(), p_.surface) == use.on.end()) use.on.push_back(p_.surface);
    double value = values[p];
    if (slot.kind == Kind::mechanism) {
      const auto& own = mechanism::find_mechanism(slot.mechanism)->parameters;
      value = std::min(value, std::ranges::find(own, slot.name, &mechanism::Parameter::name)->upper);
    }
    use.parameters[slot.name] = manifest::Parameter(value);
    if (slot.form != nullptr)
      for (const auto& [name, held] : slot.form->held) use.parameters[name] = manifest::Parameter(held);
    use.sigma[slot.name] = {sigma[p]};
  }

  std::string name_;
  ReflectanceRows rows_;
  ReflectanceParameters p_;
  double noise_ = 0;
};

std::unique_ptr<BoundModel> bind(const manifest::Document& document, const std::string& name, const Table& table) {
  return std::make_unique<BoundSurface>(document, name, table);
}

}  // namespace

const Model& surface() {
  static const Model model{
      .name = "surface",
      .sentence = "samples of a BRDF against the directions of light and eye",
      .columns = {{"theta_i", "rad", "angle of the light from the normal"},
                  {"phi_i", "rad", "azimuth of the light"},
                  {"theta_o", "rad", "angle of the eye from the normal"},
                  {"phi_o", "rad", "azimuth of the eye; the mirror direction is phi_i + 180 degrees"},
                  {"wavelength_m", "m", "centre of the band: colours have one number per band", false},
                  {"channel", "1", "0, 1, 2: red, green, blue", false},
                  {"excitation", "1", "power of the light in the band that excites fluorescence, over a reference",
                   false}},
      .score_name = "RMS of log(1 + 100 f cos cos)",
      .unit = "1",
      .group_noun = "incidence",
      .group = "theta_i",
      .importance = Importance::share_of_signal,
      .bind = bind,
  };
  return model;
}

}  // namespace gonio::explain::tables
