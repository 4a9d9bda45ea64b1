// The contrast experiment on traced ridges (brute_force.h).
#include "contrast/predict/brute_force.h"

#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "relief/lobe.h"

namespace gonio::contrast {
namespace {

relief::RidgeShape shape_of(const TracedRidges& t, double ridge_rad, int patch) {
  relief::RidgeShape shape = t.shape;
  shape.ridge_rad = ridge_rad;
  shape.ridges = t.ridges;
  shape.seed = split_mix(t.seed * 1000003 + static_cast<std::uint64_t>(patch));
  return shape;
}

relief::Material facets_of(const TracedRidges& t) {
  return relief::material_of("ridged",
                             {{"ridge_rad", 0.0},
                              {"alpha_u", t.alpha_u},
                              {"alpha_v", t.alpha_v},
                              {"eta", t.eta},
                              {"k", 0.0},
                              {"rho_d", t.rho_d}},
                             "ridges");
}

Estimate over_patches(const std::vector<double>& values) {
  double sum = 0, squares = 0;
  const auto n = static_cast<double>(values.size());
  for (const double v : values) sum += v / n;
  for (const double v : values) squares += (v - sum) * (v - sum);
  return {sum, std::sqrt(squares / (n * (n - 1)))};
}

void check(const TracedRidges& t) {
  if (t.patches < 2)
    throw Error(Exit::usage, "patches", "are " + std::to_string(t.patches),
                "2 or more are needed for a standard error");
}

}  // namespace

std::vector<Estimate> traced_lobe(const TracedRidges& t, double ridge_rad, const std::vector<View>& views) {
  check(t);
  const relief::Material facets = facets_of(t);
  std::vector<std::vector<double>> seen(views.size());
  for (int patch = 0; patch < t.patches; ++patch) {
    const relief::RidgeShape shape = shape_of(t, ridge_rad, patch);
    const relief::Relief relief = relief::ridges(shape);
    for (std::size_t i = 0; i < views.size(); ++i)
      seen[i].push_back(mean(relief::lobe(relief, facets, views[i].wo, views[i].wi, {},
                                          {.paths = t.paths, .seed = split_mix(shape.seed + i)})
                                 .value));
  }
  std::vector<Estimate> all;
  for (const auto& values : seen) all.push_back(over_patches(values));
  return all;
}

TracedSignals traced_signals(const Experiment& e, const std::vector<double>& ridge_rad, const TracedRidges& t) {
  std::vector<View> views;
  for (const double tilt : e.tilts_rad)
    for (const double rotation : rotations_of(e)) views.push_back(view_of(e, tilt, rotation));
  TracedSignals signals;
  for (const double angle : ridge_rad) {
    const std::vector<Estimate> f = traced_lobe(t, angle, views);
    for (std::size_t i = 0; i < views.size(); ++i) {
      signals.value.push_back((f[i].value + e.veil / pi) * views[i].wi.z);
      signals.sigma.push_back(f[i].sigma * views[i].wi.z);
    }
  }
  return signals;
}

Prediction traced_prediction(const Experiment& e, const std::vector<double>& ridge_rad, const TracedRidges& t) {
  check(e);
  if (e.light_spread_rad > 0 || e.camera_spread_rad > 0)
    throw Error(Exit::usage, "--light-spread", "is not known to traced ridges", "trace them between points");
  TracedSignals s = traced_signals(e, ridge_rad, t);
  Prediction p = assembled(e, {{"ridge_rad", ridge_rad}}, with_errors(std::move(s.value), s.sigma, 2000, t.seed));
  p.surface = "ridges";
  p.model = "traced relief";
  p.uncertain = {"signals: standard error over " + std::to_string(t.patches) + " patches"};
  return p;
}

Estimate covered_share(const TracedRidges& t, double ridge_rad) {
  check(t);
  std::vector<double> shares;
  for (int patch = 0; patch < t.patches; ++patch) {
    const relief::RidgeShape shape = shape_of(t, ridge_rad, patch);
    const relief::Relief relief = relief::ridges(shape);
    double covered = 0;
    for (int j = 0; j < relief.ny(); ++j)
      for (int i = 0; i < relief.nx(); ++i)
        covered += relief.z_m(i, j) > relief::ridge_profile_m(shape, j * relief.step_y_m()) + 1e-9 ? 1 : 0;
    shares.push_back(covered / (static_cast<double>(relief.nx()) * relief.ny()));
  }
  return over_patches(shares);
}

}  // namespace gonio::contrast
