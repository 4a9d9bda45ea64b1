// Model "polarimeter": light of a lamp that sends it in no direction more than in another passes a polarizer, a
// retarder, a mirror, a second retarder and an analyser, of which a table has those whose columns it has. It observes
// intensities,
//   I = gain [A(analyser) W(retarder_2) M(theta_i) W(retarder) P(polarizer)]_00,
// or elements m01 ... m33 of what stands between the two polarizers, over its m00. One gain for each wavelength.
//   polarizer.leak       both polarizers pass a share of what they should absorb
//   polarizer.angle      the analyser's zero
//   retarder.dispersion  the stated retardance holds at the column design_m (left out: the middle of the wavelengths)
//   surface.coating      a film on the mirror
// Frames: x along the mirror's s axis, angles from there towards y (optics/mueller.h); without a mirror any axis.
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "base/error.h"
#include "explain/tables/model_parameters.h"
#include "explain/tables/table_conditions.h"
#include "explain/tables/table_model.h"
#include "manifest/document.h"
#include "manifest/sections/table.h"
#include "optics/mueller_algebra.h"
#include "photograph/mechanisms/polarizer_angle.h"
#include "photograph/mechanisms/polarizer_leak.h"
#include "photograph/mechanisms/retarder_dispersion.h"
#include "photograph/polarizers.h"
#include "stats/intervals.h"
#include "surface/thin_film.h"

namespace gonio::mechanism {
const Mechanism& surface_coating();
}

namespace gonio::explain::tables {
namespace {

using optics::Mueller;

struct Element {
  int row = 0, column = 0;
};

class Polarimeter final : public BoundModel {
 public:
  Polarimeter(const manifest::Document& document, const std::string& name, const Table& table) : name_(name) {
    for (const std::size_t c : table.observed) observe(table, c);
    wavelength_ = table.needed("wavelength_m", "m");
    read(table, "polarizer", polarizer_), read(table, "analyser", analyser_);
    read(table, "retarder", retarder_[0]), read(table, "retarder_2", retarder_[1]);
    if (!retarder_[0].empty() || !retarder_[1].empty()) retardance_ = table.needed("retardance", "rad");
    read(table, "theta_i", theta_);
    if (!theta_.empty()) n_ = table.needed("mirror_n", "1");
    if (const std::vector<double>* k = table.find("mirror_k")) k_ = *k;
    design_m_ = stats::median(wavelength_);
    if (const std::vector<double>* design = table.find("design_m")) design_m_ = design->at(0);
    if (elements_.empty()) gains(document.tables.at(name), table);
    declare();
    for (const char* column : {"wavelength_m", "analyser", "retarder", "polarizer", "theta_i"})
      if (std::optional<Condition> c = condition_of(table, column)) conditions_.push_back(std::move(*c));
  }

  void predict(std::span<const double> values, std::size_t first, std::size_t last,
               std::span<double> prediction) const override {
    std::size_t place = 0;
    for (std::size_t r = first; r < last; ++r) {
      const Mueller between = between_polarizers(values, r);
      for (const Element& e : elements_) prediction[place++] = between(e.row, e.column) / between(0, 0);
      if (elements_.empty()) prediction[place++] = values[gain_of_row_[r]] * intensity(values, r, between);
    }
  }

  void apply(std::span<const double> values, std::span<const double> sigma,
             manifest::Document& document) const override {
    for (const std::size_t p : base_) {
      const std::string name = parameters_[p].name.substr(std::string("tables/" + name_ + "/").size());
      store_parameter(document.tables.at(name_), name, values[p], sigma[p]);
    }
  }

 private:
  static void read(const Table& table, const char* column, std::vector<double>& to) {
    if (table.find(column) != nullptr) to = table.needed(column, "rad");
  }
  void observe(const Table& table, std::size_t column) {
    const std::string& h = table.columns[column];
    const auto digit = [](char c) { return c >= '0' && c <= '3'; };
    if (h.size() >= 3 && h[0] == 'm' && digit(h[1]) && digit(h[2]))
      elements_.push_back({h[1] - '0', h[2] - '0'});
    else if (table.observed.size() > 1)
      throw Error(Exit::data, table.place + "/observed", "names the column " + h,
                  "model polarimeter predicts one column of intensities, or elements m01 to m33");
  }

  // Of one wavelength, to the nanometre: the lamp's light and the detector's sensitivity.
  void gains(const manifest::Table& section, const Table& table) {
    const std::vector<double>& y = table.values[table.observed.at(0)];
    std::map<long, std::vector<std::size_t>> rows;
    for (std::size_t r = 0; r < wavelength_.size(); ++r) rows[std::lround(1e9 * wavelength_[r])].push_back(r);
    gain_of_row_.assign(wavelength_.size(), 0);
    for (const auto& [nanometre, own] : rows) {
      double both = 0, squares = 0;
      for (const std::size_t r : own) {
        const double f = intensity(neutral(), r, between_polarizers(neutral(), r));
        both += f * y[r], squares += f * f;
        gain_of_row_[r] = parameters_.size();
      }
      const double usual = squares > 0 && both > 0 ? both / squares : 1;
      ModelParameter p = model_parameter(section, name_, "gain_" + std::to_string(nanometre) + "nm", "1", usual, true);
      for (std::size_t g = 0; g < table.group.size(); ++g)
        if (std::ranges::any_of(own, [&](std::size_t r) { return r >= table.first[g] && r < table.first[g + 1]; }))
          p.parameter.groups.push_back(g);
      if (p.parameter.groups.size() == table.group.size()) p.parameter.groups.clear();
      if (p.free) base_.push_back(parameters_.size());
      parameters_.push_back(std::move(p.parameter));
    }
  }

  static constexpr std::size_t not_there = static_cast<std::size_t>(-1);
  std::size_t enter(const mechanism::Mechanism& m, std::size_t count, double size) {
    const std::size_t first = parameters_.size();
    Candidate candidate{&m, {}, {}, {}};
    for (std::size_t k = 0; k < count; ++k) {
      const mechanism::Parameter& p = m.parameters.at(k);
      candidate.parameters.push_back(parameters_.size());
      parameters_.push_back(
          {m.id + "." + p.name, p.unit, p.start, p.neutral, p.lower, p.upper, k == 0 ? size : 0.01, {}, {}});
    }
    candidates_.push_back(std::move(candidate));
    return first;
  }
  void declare() {
    const bool intensities = elements_.empty();
    if (intensities) leak_ = enter(mechanism::polarizer_leak(), 1, 0.01);
    if (intensities && !analyser_.empty()) turn_ = enter(mechanism::polarizer_angle(), 1, 0.01);
    if (!retardance_.empty()) order_ = enter(mechanism::retarder_dispersion(), 1, 0.1);
    if (!theta_.empty()) film_ = enter(mechanism::surface_coating(), 2, 1e-9);
  }
  static std::span<const double> neutral() { return {}; }  // what declare() enters is not there
  static double at(std::span<const double> values, std::size_t place) {
    return place < values.size() ? values[place] : 0;
  }

  Mueller between_polarizers(std::span<const double> values, std::size_t r) const {
    Mueller all = optics::identity_mueller();
    const auto through = [&](const std::vector<double>& angle) {
      if (angle.empty()) return;
      const double late = equation::retarder_dispersion(retardance_[r], at(values, order_), design_m_ / wavelength_[r]);
      all = optics::linear_retarder(angle[r], late) * all;
    };
    through(retarder_[0]);
    if (!theta_.empty()) all = mirror(values, r) * all;
    through(retarder_[1]);
    return all;
  }
  // thin_film.h has waves exp(+i w t): conjugates. Its r_p refers to the axes of optics/mueller.h.
  Mueller mirror(std::span<const double> values, std::size_t r) const {
    const std::complex<double> index{n_[r], k_.empty() ? 0 : -k_[r]};
    const double film_m = at(values, film_), film_eta = film_ < values.size() ? values[film_ + 1] : 1;
    const surface::FilmAmplitudes a =
        surface::film_amplitudes(std::cos(theta_[r]), index, film_eta, film_m, wavelength_[r]);
    return optics::mueller_of(std::conj(a.s), std::conj(a.p));
  }
  double intensity(std::span<const double> values, std::size_t r, const Mueller& between) const {
    const double leak = at(values, leak_);
    const auto passed = [&](const optics::Stokes& s, double angle) {
      const double along = photograph::behind_polarizer(s.s[0], s.s[1], s.s[2], angle);
      return equation::polarizer_leak(along, s.s[0] - along, leak);
    };
    optics::Stokes light{{1, 0, 0, 0}};
    if (!polarizer_.empty()) {
      const double a = 2 * polarizer_[r];
      const auto half = [&](double along) { return equation::polarizer_leak(0.5 * along, -0.5 * along, leak); };
      light = {{equation::polarizer_leak(0.5, 0.5, leak), half(std::cos(a)), half(std::sin(a)), 0}};
    }
    light = between * light;
    return analyser_.empty() ? light.s[0] : passed(light, analyser_[r] + at(values, turn_));
  }

  std::string name_;
  std::vector<Element> elements_;  // empty: intensities
  std::vector<double> wavelength_, polarizer_, analyser_, retarder_[2], retardance_, theta_, n_, k_;
  std::vector<std::size_t> gain_of_row_;
  double design_m_ = 550e-9;
  std::size_t leak_ = not_there, turn_ = not_there, order_ = not_there, film_ = not_there;
};

}  // namespace

const Model& polarimeter() {
  static const Model model{
      .name = "polarimeter",
      .sentence = "Intensities behind polarizers and retarders, or elements of a Mueller matrix.",
      .columns = {{"wavelength_m", "m", "in vacuum"},
                  {"polarizer", "rad", "angle of the first polarizer; left out: there is none", false},
                  {"analyser", "rad", "angle of the last one; left out: there is none", false},
                  {"retarder", "rad", "angle of a retarder's slow axis before the mirror, if there is one", false},
                  {"retarder_2", "rad", "the same behind the mirror", false},
                  {"retardance", "rad", "of the retarders, as stated", false},
                  {"design_m", "m", "wavelength of the stated retardance; left out: the median of wavelength_m", false},
                  {"theta_i", "rad", "angle of incidence on a mirror, if there is one", false},
                  {"mirror_n", "1", "n of its index n + i k at this wavelength", false},
                  {"mirror_k", "1", "k of it; left out: 0", false}},
      .group = "retarder",
      .reads_light = false,
      .bind = bind_as<Polarimeter>};
  return model;
}

}  // namespace gonio::explain::tables
