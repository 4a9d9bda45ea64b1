// Many measurements of one known surface, and how often the intervals of its fits hold the truth.
#pragma once
#include <map>
#include <string>

#include "goniometry/fit/fit.h"
#include "goniometry/fit/synthetic.h"

namespace gonio::tests {

struct Truth {
  std::string model, variant;
  std::map<std::string, Rgb> numbers;
};

struct Cover {
  int held = 0, looks = 0, lost = 0;  // lost: the fit was refused, or a number ended at a bound
  double share() const { return looks > 0 ? static_cast<double>(held) / looks : 0; }
};

// By number; "" is all of them.
inline std::map<std::string, Cover> coverage(const Truth& truth, int repetitions, int per_incidence, double relative,
                                             double floor, bool stated, goniometry::Scale scale, std::uint64_t seed) {
  const surface::Model& model = *surface::find(truth.model);
  const surface::Values values = values_with(model, truth.numbers);
  goniometry::FitOptions options;
  options.models = {truth.model};
  options.anisotropic = truth.variant.find("anisotropic") != std::string::npos;
  options.folds = 0;
  options.check = false;
  options.random_starts = 2;
  options.scale = scale;
  std::map<std::string, Cover> cover;
  for (int k = 0; k < repetitions; ++k) {
    auto s = directions_of(8, per_incidence, 1000 * seed + k);
    measure(s, model, values, relative, floor, 1000 * seed + k, stated);
    const goniometry::Fits fits = goniometry::fit_surfaces(s, options);
    const goniometry::Fit* fit = nullptr;
    for (const auto& f : fits.candidates)
      if (f.variant == truth.variant) fit = &f;
    if (fit == nullptr) {
      ++cover[""].lost;
      continue;
    }
    for (const auto& n : fit->numbers) {
      const auto& parameters = model.info().parameters;
      std::size_t place = 0;
      while (parameters[place].name != n.name) ++place;
      double is = values.v[place][n.band == goniometry::whole_sample ? 0 : static_cast<int>(n.band)];
      // Of a direction near a bound either end of the line may be stated.
      if (n.name == "azimuth_rad") is = n.value + std::remainder(is - n.value, pi);
      const bool held = n.low <= is && is <= n.high;
      for (const std::string& key : {std::string(), n.name}) {
        if (n.at != goniometry::FittedNumber::At::inside) ++cover[key].lost;
        ++cover[key].looks, cover[key].held += held ? 1 : 0;
      }
    }
  }
  return cover;
}

}  // namespace gonio::tests
