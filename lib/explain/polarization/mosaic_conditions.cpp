// Conditions of samples of a polarization camera: what the simulated light is there, and along what the mechanisms bend
// its readings.
#include <cmath>
#include <functional>
#include <limits>

#include "explain/polarization/polarization_outcome.h"
#include "photograph/polarizers.h"

namespace gonio::explain::polarization {
namespace {

using inference::Condition;

constexpr double step_rad = 1e-3, step_of_leak = 1e-3, step_of_lens_rad = 0.3;

// Readings of all rows in another state.
std::vector<double> readings_of(const MosaicLight& light, const std::vector<Row>& rows, const State& state) {
  std::vector<double> all, tile;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i == 0 || rows[i].tile != rows[i - 1].tile) light.readings(rows[i].tile, state, tile);
    all.push_back(tile[rows[i].place]);
  }
  return all;
}

class Conditions {
 public:
  Conditions(const MosaicLight& light, const std::vector<Row>& rows, const State& state, double gain,
             const std::vector<PolarizerMeans>& means)
      : light_(light), rows_(rows), state_(state), gain_(gain), means_(means), base_(readings_of(light, rows, state)) {}

  std::vector<Condition> all() {
    const auto degree = [&](const Row& row) {
      const StokesVector& s = light_.site(row.tile, row.place).stokes;
      return s[0] > 0 ? std::hypot(s[1], s[2]) / s[0] : 0;
    };
    const auto polarizer = [&](const Row& row) {
      const Site& site = light_.site(row.tile, row.place);
      return photograph::polarizer_angle(site.x, site.y);
    };
    const auto incidence = [&](const Row& row) { return light_.site(row.tile, row.place).incidence_rad; };
    const auto radius = [&](const Row& row) {
      const Vec2 r = light_.site(row.tile, row.place).radius;
      return std::hypot(r.x, r.y) / half_diagonal(row);
    };
    add("light.polarized-part", "1", "sensor", degree,
        slope([](State& s, double by) { s.array.leak += by; }, step_of_leak));
    add("light.polarized-across", "rad", "sensor", polarizer,
        slope([](State& s, double by) { s.array.turn_rad += by; }, step_rad));
    add("camera.image-radius", "1", "optics", radius,
        slope([](State& s, double by) { s.array.retardance_rad += by; }, step_of_lens_rad));
    add("sensor.neighbours", "1", "sensor", degree,
        slope([](State& s, double by) { s.array.share += by; }, step_of_leak));
    if (!light_.setup().screens.empty()) {
      add("screen.polarized-part", "rad", "light", incidence,
          slope([](State& s, double by) { s.screen_leak += by; }, step_of_leak), true);
      add("screen.polarized-across", "rad", "light", incidence,
          slope([](State& s, double by) { s.screen_turn_rad += by; }, step_rad), true);
    }
    for (std::size_t k = 0; k < light_.setup().rough.size() && k < 1; ++k)
      add("surface.depolarized", "rad", "surface", incidence,
          slope([k](State& s, double by) { s.rougher[k] += by; }, 0.1), true);
    const std::vector<double> relative = scaled(base_, 1);
    add("surface.incidence-angle", "rad", "surface", incidence, relative);
    add(
        "image.radiance", "1", "sensor", [&, i = std::size_t{0}](const Row&) mutable { return base_[i++]; }, relative);
    std::vector<double> veil;
    const auto mean_of = [&](const Row& row) {
      const Site& site = light_.site(row.tile, row.place);
      return means_[light_.tiles()[row.tile].image][polarizer_over(site.x, site.y)];
    };
    for (const Row& row : rows_) veil.push_back(mean_of(row));
    add("image.mean", "1", "optics", mean_of, veil);
    const auto column = [&](const Row& row) { return static_cast<double>(light_.site(row.tile, row.place).x); };
    const auto line = [&](const Row& row) { return static_cast<double>(light_.site(row.tile, row.place).y); };
    add("image.x", "px", "sensor", column, relative);
    add("image.y", "px", "sensor", line, relative);
    return std::move(conditions_);
  }

 private:
  double half_diagonal(const Row& row) const {
    const auto& picture = light_.recordings().images[light_.tiles()[row.tile].image].picture;
    return std::hypot(1.0, static_cast<double>(picture.height) / picture.width);
  }
  std::vector<double> scaled(std::vector<double> values, double by) const {
    for (double& v : values) v *= gain_ * by;
    return values;
  }
  // What a reading changes by, for one of a number.
  std::vector<double> slope(const std::function<void(State&, double)>& change, double step) const {
    State other = state_;
    change(other, step);
    std::vector<double> moved = readings_of(light_, rows_, other);
    for (std::size_t i = 0; i < moved.size(); ++i) moved[i] -= base_[i];
    return scaled(std::move(moved), 1 / step);
  }
  template <class Value>
  void add(const char* name, const char* unit, const char* stage, Value value, std::vector<double> direction,
           bool everywhere = false) {
    Condition c{name, unit, stage, {}, std::move(direction), "1"};
    for (const Row& row : rows_) {
      const double v = value(row);
      c.values.push_back(everywhere && std::isnan(v) ? 0 : v);
    }
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const double v : c.values)
      if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
    if (low < high) conditions_.push_back(std::move(c));
  }

  const MosaicLight& light_;
  const std::vector<Row>& rows_;
  State state_;
  double gain_;
  const std::vector<PolarizerMeans>& means_;
  std::vector<double> base_;
  std::vector<Condition> conditions_;
};

}  // namespace

std::vector<Condition> mosaic_conditions(const MosaicLight& light, const std::vector<Row>& rows, const State& state,
                                         double gain, const std::vector<PolarizerMeans>& means) {
  return Conditions(light, rows, state, gain, means).all();
}

}  // namespace gonio::explain::polarization
