// See heights_problem.h.
#include "explain/heights/heights_problem.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "explain/heights/heights_outcome.h"
#include "inference/explanation.h"
#include "manifest/document.h"
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& surface_anisotropy();
const Mechanism& surface_micro_ridges();
}  // namespace gonio::mechanism

namespace gonio::explain {
namespace {

using namespace heights;

class HeightsProblem final : public Problem {
 public:
  explicit HeightsProblem(HeightsInput input)
      : input_(std::move(input)), spectra_(tile_spectra(input_.map, input_.place)), model_(spectra_) {
    base_parameters();
    lay();
    ridges();
    observe();
  }

  void predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const override {
    model_.predict(state(values), values[layout_.level + group], prediction);
  }

  std::string domain() const override { return "heights"; }
  std::string unit() const override { return "1"; }
  std::string score_name() const override { return "RMS of the logarithm of the power spectrum"; }
  std::string group_noun() const override { return "tile"; }
  Importance importance() const override { return Importance::share_of_signal; }

  std::string remarks(const Explanation& e) const override { return heights_remarks(input_, spectra_, *this, e); }
  void apply(const Explanation& e, manifest::Document& document) const override {
    upgrade_heights(input_, harmonic_, *this, e, document);
  }
  Illustration illustrate(const Explanation& e, const std::filesystem::path&, manifest::Document&) const override {
    return illustrate_heights(spectra_, *this, e);
  }

 private:
  SpectrumState state(std::span<const double> v) const {
    SpectrumState s;
    s.log_density.assign(v.begin() + static_cast<std::ptrdiff_t>(layout_.knots),
                         v.begin() + static_cast<std::ptrdiff_t>(layout_.knots + model_.knots()));
    s.row_variance_m2 = v[layout_.rows];
    s.a0 = v[layout_.lay], s.a45 = v[layout_.lay + 1];
    const std::size_t r = layout_.ridges;
    s.grating = {v[r], v[r + 1], v[r + 2], harmonic_};
    return s;
  }

  std::size_t add(Parameter p) {
    parameters_.push_back(std::move(p));
    return parameters_.size() - 1;
  }

  void base_parameters() {
    const std::string prefix = "tables/" + input_.table + "/";
    const std::vector<double> start = model_.start(spectra_.judged);
    layout_.knots = parameters_.size();
    for (std::size_t k = 0; k < model_.knots(); ++k)
      base_.push_back(
          add({prefix + "log_density_" + std::to_string(k), "ln m^4", start[k], start[k], -200, 50, 0.1, {}, {}}));
    const double variance = std::exp(start.back()) / (spectra_.step_x_m * spectra_.step_y_m);
    layout_.rows = add({prefix + "row_variance_m2", "m^2", 0, 0, 0, 1e-6, variance, {}, {}});
    base_.push_back(layout_.rows);
    layout_.level = parameters_.size();
    for (std::size_t t = 0; t < spectra_.judged.size(); ++t) {
      Parameter level{prefix + "tile-" + std::to_string(t) + "/level", "1", 0, 0, -20, 20, 0.1, {}, {t}};
      level.prior_sigma = 1.0;  // against the curve, whose height they share
      base_.push_back(add(std::move(level)));
    }
  }

  void enter(const mechanism::Mechanism& m, const std::vector<std::size_t>& parameters, bool known) {
    if (known)
      base_.insert(base_.end(), parameters.begin(), parameters.end());
    else
      candidates_.push_back({&m, on(), parameters, {}});
  }
  std::vector<std::string> on() const {
    return input_.surface.empty() ? std::vector<std::string>{} : std::vector<std::string>{input_.surface};
  }
  static double given(const manifest::Parameters& parameters, const std::string& name, double otherwise) {
    const auto found = parameters.find(name);
    return found != parameters.end() && found->second.given() ? found->second.scalar() : otherwise;
  }

  void lay() {
    const mechanism::Mechanism& m = mechanism::surface_anisotropy();
    std::vector<std::size_t> own;
    for (const mechanism::Parameter& info : m.parameters) {
      Parameter p{m.id + "." + info.name, info.unit, info.start, info.neutral, info.lower, info.upper, 0.05, {}, {}};
      if (input_.has_lay) p.start = p.neutral = given(input_.lay, info.name, info.neutral);
      own.push_back(add(std::move(p)));
    }
    layout_.lay = own[0];
    enter(m, own, input_.has_lay);
  }

  // Period and direction begin where the tiles that are set apart have their strongest line.
  void ridges() {
    Grating g = model_.search();
    if (input_.has_ridges) {
      g.period_m = given(input_.ridges, "ridge_period_m", g.period_m);
      g.azimuth_rad = given(input_.ridges, "ridge_azimuth_rad", g.azimuth_rad);
      g.amplitude_m = given(input_.ridges, "ridge_amplitude_m", g.amplitude_m);
      for (std::size_t k = 0; k + 1 < harmonics; ++k)
        g.harmonic[k] = given(input_.ridges, "ridge_harmonic_" + std::to_string(k + 2), 0);
    }
    const std::string prefix = mechanism::surface_micro_ridges().id + ".";
    const double bin = g.period_m / (static_cast<double>(spectra_.n) * std::max(spectra_.step_x_m, spectra_.step_y_m));
    const double reach = 0.5 * bin;  // a line is searched for to half a cycle per tile; beyond is another one
    const auto parameter = [&](const char* name, const char* unit, double start, double neutral, double lower,
                               double upper, double size) {
      Parameter p{prefix + name, unit, start, neutral, lower, upper, size, {}, {}};
      if (input_.has_ridges) p.neutral = p.start;
      return add(std::move(p));
    };
    std::vector<std::size_t> own;
    own.push_back(parameter("ridge_period_m", "m", g.period_m, g.period_m, g.period_m / (1 + reach),
                            g.period_m * (1 + reach), 0.2 * bin * g.period_m));
    own.push_back(parameter("ridge_azimuth_rad", "rad", g.azimuth_rad, g.azimuth_rad, g.azimuth_rad - reach,
                            g.azimuth_rad + reach, 0.2 * bin));
    own.push_back(parameter("ridge_amplitude_m", "m", g.amplitude_m, 0, 0, 100 * g.amplitude_m, 0.1 * g.amplitude_m));
    harmonic_ = g.harmonic;
    layout_.ridges = own[0];
    enter(mechanism::surface_micro_ridges(), own, input_.has_ridges);
  }

  void observe() {
    Observations& o = observations_;
    Condition frequency{"surface.spatial-frequency", "1/m", "surface", {}, {}, "ln"},
        azimuth{"surface.lay-azimuth", "rad", "surface", {}, {}, "ln"};
    o.first.push_back(0);
    for (std::size_t t = 0; t < spectra_.judged.size(); ++t) {
      const Tile& tile = spectra_.judged[t];
      o.group.push_back("tile " + std::to_string(tile.x) + "," + std::to_string(tile.y));
      for (std::size_t i = 0; i < spectra_.ordinates.size(); ++i) {
        const Ordinate& at = spectra_.ordinates[i];
        o.value.push_back(tile.log_power[i]);
        o.sigma.push_back(log_sigma);
        o.norm.push_back(1);
        o.block.push_back(static_cast<std::uint32_t>(t) * spectra_.blocks + at.block);
        frequency.values.push_back(std::hypot(at.fx, at.fy));
        azimuth.values.push_back(std::atan2(at.fy, at.fx));
      }
      o.first.push_back(o.value.size());
    }
    o.conditions = {std::move(frequency), std::move(azimuth)};
  }

  struct Layout {
    std::size_t knots = 0, rows = 0, level = 0, lay = 0, ridges = 0;
  };
  HeightsInput input_;
  TileSpectra spectra_;
  SpectrumModel model_;
  Layout layout_;
  std::array<double, harmonics - 1> harmonic_{};
};

}  // namespace

std::unique_ptr<Problem> heights_problem(HeightsInput input) {
  return std::make_unique<HeightsProblem>(std::move(input));
}

}  // namespace gonio::explain
