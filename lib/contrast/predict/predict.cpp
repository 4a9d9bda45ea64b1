// The contrast experiment carried out on a model (predict.h).
#include "contrast/predict/predict.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "base/text.h"

namespace gonio::contrast {
namespace {

struct Layout {  // where things lie in a list of signals
  explicit Layout(const Experiment& e) : rotations(rotations_of(e)), tilts(e.tilts_rad.size()) {}
  std::size_t rotation(double rad) const {
    return static_cast<std::size_t>(std::ranges::find(rotations, rad) - rotations.begin());
  }
  std::size_t at(std::size_t setting, std::size_t tilt, double rad) const {
    return (setting * tilts + tilt) * rotations.size() + rotation(rad);
  }
  std::vector<double> rotations;
  std::size_t tilts;
};

// A number of interest as a sum over what was drawn: nominal value, and the standard deviation of the draws.
class Spread {
 public:
  void add(double x) {
    ++count_;
    const double step = x - mean_;
    mean_ += step / count_;
    squares_ += step * (x - mean_);
  }
  double sigma() const { return count_ > 1 ? std::sqrt(squares_ / (count_ - 1)) : 0; }

 private:
  double count_ = 0, mean_ = 0, squares_ = 0;
};

// `quantity` of the nominal signals, with its spread over the draws.
template <class Quantity>
Estimate estimated(const Signals& signals, const Quantity& quantity) {
  Spread spread;
  for (const auto& draw : signals.draws) spread.add(quantity(draw));
  return {quantity(signals.value), spread.sigma()};
}

using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;  // places of two signals

Estimate mean_contrast(const Signals& signals, const Pairs& pairs, Definition definition) {
  return estimated(signals, [&](const std::vector<double>& s) {
    double sum = 0;
    for (const auto& [a, b] : pairs) sum += contrast_of(definition, s[a], s[b]);
    return sum / static_cast<double>(pairs.size());
  });
}

Combination combination_of(const Signals& s, std::size_t a, std::size_t b) {
  Combination c;
  const auto of_pair = [a, b](double (*contrast)(double, double)) {
    return [a, b, contrast](const std::vector<double>& v) { return contrast(v[a], v[b]); };
  };
  c.first = estimated(s, [a](const std::vector<double>& v) { return v[a]; });
  c.second = estimated(s, [b](const std::vector<double>& v) { return v[b]; });
  c.difference = estimated(s, of_pair(difference_of));
  c.michelson = estimated(s, of_pair(michelson_of));
  c.first_brighter = c.first.value >= c.second.value;
  return c;
}

// Means over all combinations whose key is the same; keys count from 0.
template <class Key>
Means means_over(const std::string& over, std::size_t count, const Signals& signals, const Pairs& places,
                 Definition definition, const Key& key) {
  Means means{.over = over};
  for (std::size_t k = 0; k < count; ++k) {
    Pairs chosen;
    for (std::size_t i = 0; i < places.size(); ++i)
      if (key(i) == k) chosen.push_back(places[i]);
    means.mean.push_back(mean_contrast(signals, chosen, definition));
  }
  return means;
}

struct Unsure {  // one number of the surface that is drawn
  std::string parameter;
  std::size_t component = 0;
  double sigma = 0, lower = 0, upper = 0;
};

std::vector<Unsure> unsure_numbers(const Specimen& specimen) {
  std::vector<Unsure> all;
  for (const auto& [name, sigma] : specimen.sigma()) {
    const manifest::ParameterInfo& info = specimen.declared(name, specimen.place() + "/sigma/" + name);
    for (std::size_t c = 0; c < sigma.size(); ++c)
      if (sigma[c] > 0) all.push_back({name, c, sigma[c], info.lower, info.upper});
  }
  return all;
}

// `at` moved by a normal error, within the bounds: drawn anew where it falls outside.
double drawn(double at, const Unsure& u, double error, Random& random) {
  for (int i = 0; i < 100; ++i, error = random.normal())
    if (const double v = at + error * u.sigma; v >= u.lower && v <= u.upper) return v;
  return std::clamp(at, u.lower, u.upper);
}

// The parameters of one setting; with `random` those of one draw. The errors are the same for all settings.
manifest::Parameters parameters_of(const Specimen& specimen, const std::vector<Varied>& varied,
                                   const std::vector<double>& setting, const std::vector<Unsure>& unsure,
                                   Random* random) {
  manifest::Parameters changed;
  for (std::size_t i = 0; i < varied.size(); ++i) changed[varied[i].parameter] = manifest::Parameter(setting[i]);
  if (random == nullptr) return changed;
  for (const Unsure& u : unsure) {
    manifest::Parameter& p =
        changed
            .try_emplace(u.parameter,
                         [&] {
                           const auto stated = specimen.parameters().find(u.parameter);
                           return stated != specimen.parameters().end() && stated->second.given()
                                      ? stated->second
                                      : manifest::Parameter(specimen.number(u.parameter, specimen.place()));
                         }())
            .first->second;
    if (p.value.size() <= u.component) p.value.resize(3, p.value.front());
    p.value[u.component] = drawn(p.value[u.component], u, random->normal(), *random);
  }
  return changed;
}

std::vector<double> signals_of(const Specimen& specimen, const PredictOptions& options,
                               const std::vector<Unsure>& unsure, Random* random) {
  std::vector<double> values;
  const std::vector<double> rotations = rotations_of(options.experiment);
  const Random start = random != nullptr ? *random : Random(0);
  for (const auto& setting : settings_of(options.varied)) {
    if (random != nullptr) *random = start;  // one error for all settings
    const Reflectance f = specimen.with(parameters_of(specimen, options.varied, setting, unsure, random));
    for (const double tilt : options.experiment.tilts_rad)
      for (const double rotation : rotations) values.push_back(signal(options.experiment, f, tilt, rotation));
  }
  return values;
}

void check_varied(const Specimen& specimen, const std::vector<Varied>& varied) {
  for (const Varied& v : varied) {
    const std::string place = "--vary " + v.parameter;
    const manifest::ParameterInfo& info = specimen.declared(v.parameter, place);
    if (v.values.empty()) throw Error(Exit::usage, place, "has no values", "list them: --vary ridge_rad=5deg,10deg");
    for (const double x : v.values)
      if (!(x >= info.lower && x <= info.upper))
        throw Error(Exit::usage, place,
                    "value " + shortest_text(x) + " is outside " + shortest_text(info.lower) + " to " +
                        shortest_text(info.upper) + (info.unit == "1" ? "" : " " + info.unit),
                    info.meaning);
    if (std::ranges::count(varied, v.parameter, &Varied::parameter) > 1)
      throw Error(Exit::usage, place, "is given twice", "list all values in one --vary");
  }
}

}  // namespace

std::vector<double> rotations_of(const Experiment& experiment) {
  std::vector<double> all;
  for (const auto& pair : experiment.pairs_rad)
    for (const double rotation : {pair.first, pair.second})
      if (std::ranges::find(all, rotation) == all.end()) all.push_back(rotation);
  return all;
}

std::vector<std::vector<double>> settings_of(const std::vector<Varied>& varied) {
  std::vector<std::vector<double>> all{{}};
  for (const Varied& v : varied) {
    std::vector<std::vector<double>> longer;
    for (const auto& before : all)
      for (const double x : v.values) {
        longer.push_back(before);
        longer.back().push_back(x);
      }
    all = std::move(longer);
  }
  return all;
}

Signals with_errors(std::vector<double> value, const std::vector<double>& sigma, int draws, std::uint64_t seed) {
  Signals signals{.value = std::move(value), .draws = {}};
  for (int d = 0; d < draws; ++d) {
    Random random(seed, static_cast<std::uint64_t>(d));
    signals.draws.push_back(signals.value);
    for (std::size_t i = 0; i < sigma.size(); ++i) signals.draws.back()[i] += sigma[i] * random.normal();
  }
  return signals;
}

Prediction assembled(const Experiment& e, const std::vector<Varied>& varied, const Signals& signals) {
  const auto settings = settings_of(varied);
  const Layout layout(e);
  Prediction p;
  p.experiment = e;
  p.varied = varied;
  p.draws = static_cast<int>(signals.draws.size());
  Pairs places;
  std::vector<std::array<std::size_t, 3>> keys;  // setting, tilt, pair
  for (std::size_t s = 0; s < settings.size(); ++s)
    for (std::size_t t = 0; t < layout.tilts; ++t)
      for (std::size_t q = 0; q < e.pairs_rad.size(); ++q) {
        places.emplace_back(layout.at(s, t, e.pairs_rad[q].first), layout.at(s, t, e.pairs_rad[q].second));
        keys.push_back({s, t, q});
        p.combinations.push_back(combination_of(signals, places.back().first, places.back().second));
        p.combinations.back().varied = settings[s];
        p.combinations.back().tilt_rad = e.tilts_rad[t];
        p.combinations.back().pair_rad = e.pairs_rad[q];
      }
  const auto add = [&](const std::string& over, std::size_t count, const auto& key) -> Means& {
    p.means.push_back(means_over(over, count, signals, places, e.definition, key));
    return p.means.back();
  };
  Means& tilt = add("tilt", layout.tilts, [&](std::size_t i) { return keys[i][1]; });
  tilt.at = e.tilts_rad;
  for (const double at : tilt.at) tilt.label.push_back(degrees_text(at));
  for (std::size_t v = 0; v < varied.size(); ++v) {
    const auto& values = varied[v].values;
    Means& means = add(varied[v].parameter, values.size(), [&](std::size_t i) {
      return static_cast<std::size_t>(std::ranges::find(values, settings[keys[i][0]][v]) - values.begin());
    });
    means.at = values;
    for (const double at : values)
      means.label.push_back(varied[v].parameter.ends_with("_rad") ? degrees_text(at) : shortest_text(at));
  }
  Means& pair = add("rotation", e.pairs_rad.size(), [&](std::size_t i) { return keys[i][2]; });
  for (std::size_t q = 0; q < e.pairs_rad.size(); ++q) {
    pair.at.push_back(static_cast<double>(q));
    pair.label.push_back(pair_name(e.pairs_rad[q]));
  }
  p.mean = mean_contrast(signals, places, e.definition);
  return p;
}

Prediction predict(const Specimen& specimen, const PredictOptions& options) {
  check(options.experiment);
  check_varied(specimen, options.varied);
  const std::vector<Unsure> unsure = unsure_numbers(specimen);
  Signals signals;
  signals.value = signals_of(specimen, options, unsure, nullptr);
  if (!unsure.empty()) {
    signals.draws.resize(static_cast<std::size_t>(options.draws));
    parallel_for(0, signals.draws.size(), [&](std::size_t d) {
      Random random(options.seed, d);
      signals.draws[d] = signals_of(specimen, options, unsure, &random);
    });
  }
  Prediction p = assembled(options.experiment, options.varied, signals);
  p.surface = specimen.name();
  p.model = specimen.info().id;
  for (const manifest::ParameterInfo& info : specimen.info().parameters)
    if (std::ranges::find(options.varied, info.name, &Varied::parameter) == options.varied.end())
      p.stated.push_back({info.name, info.unit, specimen.number(info.name, specimen.place()), info.meaning});
  for (const Unsure& u : unsure) {
    const std::string unit = specimen.declared(u.parameter, specimen.place()).unit;
    p.uncertain.push_back(u.parameter + " " + format("%.3g", u.sigma) + (unit == "1" ? "" : " " + unit));
  }
  return p;
}

std::size_t largest(const Means& means) {
  return static_cast<std::size_t>(std::ranges::max_element(means.mean, {}, &Estimate::value) - means.mean.begin());
}

}  // namespace gonio::contrast
