// See profile.h.
#include "inference/profile.h"

#include <algorithm>
#include <cmath>

#include "stats/distributions.h"

namespace gonio::inference {
namespace {

constexpr int profile_iterations = 12, doublings = 8, halvings = 6;

// Cost above the best fit's with the parameter held at a value.
class Profile {
 public:
  Profile(const System& system, const Fit& fit, std::size_t parameter)
      : system_(system), fit_(fit), parameter_(parameter), others_(fit.active) {
    std::erase(others_, parameter);
    kept_ = slopes(system, fit.values, others_);
  }
  double operator()(double value) const {
    std::vector<double> values = fit_.values;
    values[parameter_] = value;
    return inference::fit(system_, std::move(values), others_, profile_iterations, &kept_).cost - fit_.cost;
  }

 private:
  const System& system_;
  const Fit& fit_;
  std::size_t parameter_;
  std::vector<std::size_t> others_;
  Slopes kept_;
};

// Where the profile crosses `limit` between the fit and the bound; the bound where it does not.
double crossing(const Profile& profile, double value, double bound, double step, double limit) {
  if (value == bound || !(step > 0)) return value;
  const double sign = bound > value ? 1 : -1;
  double inside = value, outside = value;
  for (int k = 0; k < doublings; ++k, step *= 2) {
    outside = sign * std::min(sign * (value + sign * step), sign * bound);
    if (profile(outside) > limit) break;
    inside = outside;
    if (outside == bound || k + 1 == doublings) return outside;
  }
  for (int k = 0; k < halvings; ++k) {
    const double middle = 0.5 * (inside + outside);
    (profile(middle) > limit ? outside : inside) = middle;
  }
  return 0.5 * (inside + outside);
}

}  // namespace

bool needs_profile(const Parameter& parameter, const Estimate& e) {
  if (e.at_bound || !(e.sigma > 0)) return true;
  return e.lower_95 <= parameter.lower || e.upper_95 >= parameter.upper ||
         (e.lower_95 <= parameter.neutral && parameter.neutral <= e.upper_95);
}

void set_profile_interval(const System& system, const Fit& fit, Estimate& e) {
  const Parameter& parameter = system.problem().parameters()[e.parameter];
  Fit freed = fit;
  if (std::find(freed.inner.begin(), freed.inner.end(), e.parameter) == freed.inner.end())
    freed.inner.push_back(e.parameter);
  const Uncertainty u = uncertainty(system, freed);
  const Linearisation l = linearise(system, fit.values, freed.inner);
  std::vector<std::size_t> columns(freed.inner.size());
  for (std::size_t c = 0; c < columns.size(); ++c) columns[c] = c;
  const auto place = std::find(freed.inner.begin(), freed.inner.end(), e.parameter) - freed.inner.begin();
  Eigen::VectorXd unit = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(columns.size()));
  unit[place] = 1;
  const double model = NormalEquations(l, columns).solve(unit)(place, 0), sandwich = u.covariance(place, place);
  const double inflation = model > 0 && sandwich > 0 ? std::max(1.0, sandwich / model) : 1;
  const double quantile = stats::student_quantile(0.975, u.degrees[static_cast<std::size_t>(place)]);
  const double limit = quantile * quantile * inflation;
  const double reach = parameter.upper - parameter.lower;
  double step = sandwich > 0 ? std::sqrt(sandwich) : parameter.size;
  if (std::isfinite(reach)) step = std::min(step, 0.25 * reach);
  const Profile profile(system, fit, e.parameter);
  e.lower_95 = crossing(profile, e.value, parameter.lower, step, limit);
  e.upper_95 = crossing(profile, e.value, parameter.upper, step, limit);
  if (!(e.sigma > 0)) e.sigma = 0.5 * (e.upper_95 - e.lower_95) / quantile;
}

}  // namespace gonio::inference
