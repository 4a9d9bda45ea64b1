// Model "ellipsometer": Psi and Delta of light that a flat substrate reflects, tan(Psi) exp(i Delta) = r_p / r_s, by
// surface/thin_film.h. The base model is the bare substrate, whose index n - i k the table states row by row.
//   surface.thin-film  a transparent film lies on it: thickness and index. A range of thickness holds one minimum, and
//                      the candidates of all ranges are alternatives of one family.
//   volume.index       n of the substrate is another one, the same at all wavelengths
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "base/error.h"
#include "explain/tables/model_parameters.h"
#include "explain/tables/table_conditions.h"
#include "explain/tables/table_model.h"
#include "geom/vector.h"
#include "inference/wording.h"
#include "manifest/document.h"
#include "manifest/sections/table.h"
#include "mechanism/mechanism.h"
#include "surface/thin_film.h"

namespace gonio::mechanism {
const Mechanism& surface_thin_film();
const Mechanism& volume_index();
}  // namespace gonio::mechanism

namespace gonio::explain::tables {
namespace {

constexpr double range_m = 0.06e-6, thickest_m = 0.66e-6;

class Ellipsometer final : public BoundModel {
 public:
  Ellipsometer(const manifest::Document& document, const std::string& name, const Table& table) : name_(name) {
    for (const std::size_t c : table.observed) observe(table, c);
    theta_ = table.needed("theta_i", "rad");
    wavelength_ = table.needed("wavelength_m", "m");
    n_ = table.needed("substrate_n", "1");
    if (table.find("substrate_k") != nullptr) k_ = table.needed("substrate_k", "1");
    for (std::size_t r = 0; r < n_.size(); ++r)
      if (!(n_[r] > 0) || !(wavelength_[r] > 0))
        throw Error(Exit::data, table.place,
                    "has a row with substrate_n " + inference::printed(n_[r]) + " and wavelength_m " +
                        inference::printed(wavelength_[r]) + " (both above 0)",
                    "state the substrate's index n - i k at each row's wavelength");
    ModelParameter tilt = model_parameter(document.tables.at(name), name, "theta_shift", "rad", 0, false);
    tilt.parameter.size = 1e-3;
    if (tilt.free) base_.push_back(0);
    parameters_.push_back(std::move(tilt.parameter));
    declare_index();
    declare_films();
    for (const char* column : {"theta_i", "wavelength_m"})
      if (std::optional<Condition> c = condition_of(table, column)) conditions_.push_back(std::move(*c));
  }

  void predict(std::span<const double> values, std::size_t first, std::size_t last,
               std::span<double> prediction) const override {
    const Film film = film_of(values);
    std::size_t place = 0;
    for (std::size_t r = first; r < last; ++r) {
      const Pair seen = at(r, values[0], values[1], film);
      for (const bool is_delta : is_delta_) prediction[place++] = is_delta ? seen.delta : seen.psi;
    }
  }

  // Thickness and index go together: what films of neighbouring indices would have to be, and how little it shows.
  std::string remarks(std::span<const std::string> named, std::span<const double> values,
                      std::span<const double>) const override {
    const Film film = film_of(values);
    if (std::ranges::find(named, mechanism::surface_thin_film().id) == named.end() || !(film.thickness_m > 0))
      return {};
    std::string text;
    for (const double eta : {film.eta - 0.03, film.eta + 0.03}) {
      const auto [thickness, rms] = stand_in(values, film, eta);
      text += (text.empty() ? "A film of index " : ", one of ") + inference::printed(eta, 3) + " and " +
              inference::quantity(thickness, "m", 3) + " would differ by " + inference::quantity(rms, "rad", 2);
    }
    return text + " (rms): thickness and index are nearly tied.";
  }

  void apply(std::span<const double> values, std::span<const double> sigma,
             manifest::Document& document) const override {
    if (sigma[0] > 0) store_parameter(document.tables.at(name_), "theta_shift", values[0], sigma[0]);
  }

 private:
  struct Film {
    double thickness_m = 0, eta = 1.4;
  };
  struct Pair {
    double psi = 0, delta = 0;
  };

  void observe(const Table& table, std::size_t column) {
    const std::string& heading = table.columns[column];
    const bool psi = heading.starts_with("psi"), delta = heading.starts_with("delta");
    if (!psi && !delta)
      throw Error(Exit::data, table.place + "/observed", "names the column " + heading,
                  "model ellipsometer predicts psi and delta: --observed psi --observed delta");
    if (table.units[column] != "rad")
      throw Error(Exit::data, table.place + "/columns/" + heading, "has the unit " + table.units[column] + ", no angle",
                  "state it: --units " + heading + "=deg");
    is_delta_.push_back(delta);
  }

  void declare_index() {
    const mechanism::Mechanism& m = mechanism::volume_index();
    const mechanism::Parameter& p = m.parameters.at(0);
    candidates_.push_back({&m, {}, {parameters_.size()}, {}});
    parameters_.push_back({m.id + "." + p.name, p.unit, p.start, p.neutral, p.lower, p.upper, 0.01, {}, {}});
  }

  void declare_films() {
    const mechanism::Mechanism& m = mechanism::surface_thin_film();
    const mechanism::Parameter &d = m.parameters.at(0), &eta = m.parameters.at(1);
    for (double lower = 0; lower < thickest_m - 1e-9; lower += range_m) {
      candidates_.push_back({&m, {}, {parameters_.size(), parameters_.size() + 1}, m.id});
      parameters_.push_back(
          {m.id + "." + d.name, d.unit, lower + range_m / 2, d.neutral, lower, lower + range_m, 1e-9, {}, {}});
      parameters_.push_back(
          {m.id + "." + eta.name, eta.unit, eta.start, eta.neutral, eta.lower, eta.upper, 0.01, {}, {}});
    }
  }

  // Of the candidates of one family at most one is in play; the others' thickness is neutral.
  Film film_of(std::span<const double> values) const {
    for (std::size_t p = 2; p + 1 < values.size(); p += 2)
      if (values[p] != 0) return {values[p], values[p + 1]};
    return {};
  }

  Pair at(std::size_t row, double shift_rad, double shift, Film film) const {
    const std::complex<double> substrate{n_[row] + shift, k_.empty() ? 0 : -k_[row]};
    const surface::FilmAmplitudes r = surface::film_amplitudes(std::cos(theta_[row] + shift_rad), substrate, film.eta,
                                                               film.thickness_m, wavelength_[row]);
    const std::complex<double> rho = r.p / r.s;
    const double delta = std::arg(rho);
    return {std::atan(std::abs(rho)), delta < 0 ? delta + 2 * pi : delta};
  }

  // The thickness at which a film of another index does most nearly the same, by golden sections, and what remains.
  std::pair<double, double> stand_in(std::span<const double> values, Film film, double eta) const {
    const auto differs = [&](double thickness) {
      double squares = 0;
      for (std::size_t r = 0; r < n_.size(); ++r) {
        const Pair a = at(r, values[0], values[1], film), b = at(r, values[0], values[1], {thickness, eta});
        squares += std::pow(a.psi - b.psi, 2) + std::pow(a.delta - b.delta, 2);
      }
      return std::sqrt(squares / static_cast<double>(2 * n_.size()));
    };
    constexpr double golden = 0.6180339887498949;
    double low = 0.7 * film.thickness_m, high = 1.4 * film.thickness_m;
    for (int i = 0; i < 60; ++i) {
      const double a = high - golden * (high - low), b = low + golden * (high - low);
      const bool left = differs(a) < differs(b);
      (left ? high : low) = left ? b : a;
    }
    return {(low + high) / 2, differs((low + high) / 2)};
  }

  std::string name_;
  std::vector<bool> is_delta_;
  std::vector<double> theta_, wavelength_, n_, k_;
};

}  // namespace

const Model& ellipsometer() {
  static const Model model{
      .name = "ellipsometer",
      .sentence = "Psi and Delta of light that a flat substrate reflects, tan(Psi) exp(i Delta) = r_p / r_s.",
      .columns = {{"theta_i", "rad", "angle of incidence"},
                  {"wavelength_m", "m", "in vacuum"},
                  {"substrate_n", "1", "n of the substrate's index n - i k at this wavelength"},
                  {"substrate_k", "1", "k of it; left out: 0", false}},
      .score_name = "RMS error of Psi and Delta",
      .unit = "rad",
      .group = "theta_i",
      .importance = Importance::share_of_residual,
      .reads_light = false,
      .bind = bind_as<Ellipsometer>};
  return model;
}

}  // namespace gonio::explain::tables
