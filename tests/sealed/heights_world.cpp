// Height maps of rough surfaces: noise on a grid of half the step, averaged under round or drawn-out windows, gratings
// with flanks, scratches; written as a profiler's file.
#include <algorithm>
#include <cmath>

#include "geom/vector.h"
#include "sealed/camera_chain.h"
#include "sealed/recording.h"
#include "sealed/worlds.h"

namespace gonio::sealed {
namespace {

constexpr int side = 240, finer = 2, margin = 24;  // margin: of the finer grid
constexpr double step_m = 0.4e-6, rough_m = 8e-8, instrument_m = 2e-9;

class Heights final : public World {
 public:
  std::vector<EffectKind> effects() const override {
    const std::vector<std::string> lay{"surface.azimuth", "surface.lay-azimuth", "surface.spatial-frequency"},
        surface{"surface"};
    std::vector<EffectKind> k;
    const auto add = [&](EffectKind kind) -> EffectKind& { return k.emplace_back(std::move(kind)); };
    add({"grating", "surface.micro-ridges", surface, lay, 0.25, 0.9}).as_drawn().values = [this](const Numbers& size) {
      constexpr double first_harmonic = 1.09;  // of flanks over 0.3 of a period
      return std::vector<TrueValue>{
          {"surface.micro-ridges", "ridge_period_m", period_m_, true, false},
          {"surface.micro-ridges", "ridge_amplitude_m", first_harmonic * size[0] * rough_m, false}};
    };
    add({"drawn out", "surface.anisotropy", surface, lay, 0.15, 0.6}).as_drawn();
    add({"scratches", "", surface, {}, 2, 6});
    return k;
  }
  void design(Random& random, const std::string&) override {
    period_m_ = step_m * random.uniform(4.5, 14);
    azimuth_ = random.uniform(0, pi);
    lay_ = random.uniform(0, pi);
    wide_ = random.uniform(7, 11);
    const std::size_t across = side * finer + 2 * margin;
    for (std::size_t i = 0; i < across * across; ++i) white_.push_back(random.normal());
    for (int k = 0; k < 6; ++k)
      scratches_.push_back({random.uniform(0, pi), random.uniform(0.2, 0.8), random.uniform(0.2, 0.8)});
  }
  Numbers base() const override { return {}; }
  Numbers base_steps() const override { return {}; }
  Numbers simulate(const Numbers&, const Sizes& sizes) const override {
    Numbers z = averaged(wide_, size_of(sizes, "drawn out"));
    const Numbers fine = averaged(0.4 * wide_, size_of(sizes, "drawn out"));
    for (std::size_t i = 0; i < z.size(); ++i) z[i] = rough_m * (0.9 * z[i] + 0.45 * fine[i]);
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        double& at = z[static_cast<std::size_t>(y * side + x)];
        if (const double height = size_of(sizes, "grating"); height > 0) at += height * rough_m * flanked(x, y);
        if (const double depth = size_of(sizes, "scratches"); depth > 0)
          for (const Vec3& s : scratches_) at -= depth * rough_m * scratched(s, x, y);
      }
    return z;
  }
  Numbers sigma(const Numbers& clean) const override { return Numbers(clean.size(), rough_m); }
  Numbers noisy(const Numbers& clean, Random& random) const override {
    Numbers z = clean;
    for (double& v : z) v += instrument_m * random.normal();
    return z;
  }
  Numbers norm(const Numbers& observed) const override { return Numbers(observed.size(), rough_m * rough_m); }
  bool relative() const override { return true; }
  bool asks_rivals() const override { return false; }
  bool knows_floor() const override { return false; }  // scored by spectra
  void locate(const Numbers&, const Numbers&, Case&) const override {}
  void write(const Numbers& observed, const Numbers&, Case& into) const override {
    into.files["map.sur"] = profile(side, side, step_m, observed);
    Value m = Value::object();
    m["tables"]["t"] = Value::object({{"file", "map"}, {"model", "heights"}});
    finish(m, into);
  }

 private:
  // White noise under a window (1 - r^2)^2 of this radius on the finer grid, drawn out by exp(+-drawn / 2) along the
  // lay and across it; of variance one.
  Numbers averaged(double radius, double drawn) const {
    const double along = radius * std::exp(0.5 * drawn), aside = radius * std::exp(-0.5 * drawn);
    std::vector<double> window;
    std::vector<std::ptrdiff_t> offset;
    double power = 0;
    const int reach = std::min(margin, static_cast<int>(along) + 1);
    const std::ptrdiff_t across = side * finer + 2 * margin;
    for (int v = -reach; v <= reach; ++v)
      for (int u = -reach; u <= reach; ++u) {
        const double p = (u * std::cos(lay_) + v * std::sin(lay_)) / along,
                     q = (v * std::cos(lay_) - u * std::sin(lay_)) / aside, rest = 1 - p * p - q * q;
        if (rest <= 0) continue;
        window.push_back(rest * rest), offset.push_back(v * across + u);
        power += rest * rest * rest * rest;
      }
    for (double& w : window) w /= std::sqrt(power);
    Numbers z;
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const double* at = &white_[static_cast<std::size_t>((y * finer + margin) * across + x * finer + margin)];
        double sum = 0;
        for (std::size_t k = 0; k < window.size(); ++k) sum += window[k] * at[offset[k]];
        z.push_back(sum);
      }
    return z;
  }
  // A bar, a flank, a gap, a flank, averaged over the point.
  double flanked(int x, int y) const {
    double sum = 0;
    for (int k = 0; k < 16; ++k) {
      const double u = (x + (k % 4) / 4.0) * std::cos(azimuth_) + (y + k / 4 / 4.0) * std::sin(azimuth_);
      const double phase = u * step_m / period_m_ - std::floor(u * step_m / period_m_);
      sum += std::clamp(4 * std::abs(phase - 0.5) - 1, -0.6, 0.6) / 0.6 / 16;
    }
    return sum;
  }
  static double scratched(const Vec3& s, int x, int y) {
    const double across = (x - s.y * side) * std::cos(s.x) + (y - s.z * side) * std::sin(s.x),
                 along = (y - s.z * side) * std::cos(s.x) - (x - s.y * side) * std::sin(s.x);
    return std::abs(along) < 0.15 * side ? std::exp(-0.5 * across * across / 2.25) : 0;
  }
  std::vector<double> white_;
  std::vector<Vec3> scratches_;  // direction, middle in shares of the side
  double period_m_ = 1, azimuth_ = 0, lay_ = 0, wide_ = 9;
};

}  // namespace

std::unique_ptr<World> heights_world() {
  return std::make_unique<Heights>();
}

}  // namespace gonio::sealed
