// The surface of greatest contrast (optimize.h).
#include "contrast/predict/optimize.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "contrast/predict/simplex_search.h"

namespace gonio::contrast {
namespace {

constexpr double kept = 0.95;  // of the contrast, by which tolerances are stated

std::string with_unit(const std::string& parameter, double value) {
  if (parameter.ends_with("_rad")) return format("%.4g degrees", value / degree);
  if (parameter.ends_with("_m")) return format("%.4g um", value * 1e6);
  return format("%.4g", value);
}

manifest::Parameters parameters_at(const Wish& wish, const std::vector<double>& values) {
  manifest::Parameters p;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (wish.bounds[i].parameter != pitch_name) p[wish.bounds[i].parameter] = manifest::Parameter(values[i]);
  return p;
}

std::optional<double> pitch_at(const Wish& wish, const std::vector<double>& values) {
  for (std::size_t i = 0; i < values.size(); ++i)
    if (wish.bounds[i].parameter == pitch_name) return values[i];
  return {};
}

// What diffraction adds to alpha_v, entered into `p`.
void blur(manifest::Parameters& p, double pitch_m, const Specimen& specimen, double wavelength_m) {
  const auto number = [&](const char* name) {
    const auto found = p.find(name);
    return found != p.end() ? found->second.scalar() : specimen.number(name, specimen.place());
  };
  const double added = diffraction_alpha(pitch_m, number("ridge_rad"), wavelength_m);
  const double upper = specimen.declared("alpha_v", specimen.place()).upper;
  p["alpha_v"] = manifest::Parameter(std::min(upper, std::hypot(number("alpha_v"), added)));
}

void check_bounds(const Specimen& specimen, const Wish& wish) {
  if (wish.bounds.empty())
    throw Error(Exit::usage, "--bound", "is missing: nothing may be changed",
                "give the range of each parameter: --bound alpha=0.02:0.3");
  for (const Bound& b : wish.bounds) {
    const std::string place = "--bound " + b.parameter;
    if (std::ranges::count(wish.bounds, b.parameter, &Bound::parameter) > 1)
      throw Error(Exit::usage, place, "is given twice", "give one range");
    if (!(b.lower < b.upper))
      throw Error(Exit::usage, place,
                  "leaves no room from " + with_unit(b.parameter, b.lower) + " to " + with_unit(b.parameter, b.upper),
                  "write the lower end first: LOW:HIGH");
    if (b.parameter == pitch_name) {
      if (specimen.info().id != "ridged")
        throw Error(Exit::usage, place, "is a length of ridges, and the model is \"" + specimen.info().id + "\"",
                    "bound the model's own lengths");
      if (!(b.lower > 0)) throw Error(Exit::usage, place, "begins at " + shortest_text(b.lower) + " m", "more than 0");
      continue;
    }
    const manifest::ParameterInfo& info = specimen.declared(b.parameter, place);
    if (b.lower < info.lower || b.upper > info.upper)
      throw Error(Exit::usage, place,
                  "from " + shortest_text(b.lower) + " to " + shortest_text(b.upper) + " leaves " +
                      shortest_text(info.lower) + " to " + shortest_text(info.upper) +
                      (info.unit == "1" ? "" : " " + info.unit),
                  info.meaning);
  }
}

Box box_of(const Wish& wish) {
  Box box;
  for (const Bound& b : wish.bounds) {
    box.lower.push_back(b.lower);
    box.upper.push_back(b.upper);
  }
  return box;
}

// Where the contrast falls to `kept` of its best between `best` and `end`; `end` where it does not.
double edge(const std::function<double(double)>& contrast, double best, double end, double limit) {
  constexpr int steps = 60;  // the first fall counts, then it is halved
  double inside = best;
  for (int i = 1; i <= steps; ++i) {
    const double at = best + (end - best) * i / steps;
    if (contrast(at) >= limit) {
      inside = at;
      continue;
    }
    double outside = at;
    for (int j = 0; j < 30; ++j) {
      const double middle = (inside + outside) / 2;
      (contrast(middle) >= limit ? inside : outside) = middle;
    }
    return inside;
  }
  return end;
}

Optimum::Number described(const Specimen& specimen, const Wish& wish, const std::vector<double>& best, double contrast,
                          std::size_t i) {
  const Bound& b = wish.bounds[i];
  Optimum::Number n{.parameter = b.parameter, .value = best[i], .bound = b};
  const auto along = [&](double x) {
    std::vector<double> values = best;
    values[i] = std::clamp(x, b.lower, b.upper);
    return contrast_at(specimen, wish, values);
  };
  const double near = 2e-3 * (b.upper - b.lower);
  const auto rises_towards = [&](double end, double inwards) {
    return std::abs(best[i] - end) < near && along(end) >= contrast && along(end) > along(end + inwards) * (1 + 1e-7);
  };
  n.at_bound = rises_towards(b.lower, near) ? -1 : rises_towards(b.upper, -near) ? 1 : 0;
  if (n.at_bound != 0) n.value = n.at_bound < 0 ? b.lower : b.upper;
  n.less = along(0.9 * best[i]) / contrast;
  n.more = along(1.1 * best[i]) / contrast;
  n.keeps_from = edge(along, n.value, b.lower, kept * contrast);
  n.keeps_to = edge(along, n.value, b.upper, kept * contrast);
  constexpr int scanned = 60;
  for (int k = 0; k <= scanned; ++k) {
    n.at.push_back(b.lower + (b.upper - b.lower) * k / scanned);
    n.contrast.push_back(along(n.at.back()));
  }
  return n;
}

}  // namespace

double diffraction_alpha(double pitch_m, double ridge_rad, double wavelength_m) {
  // Half of the full width of sinc^2 at half maximum, over that of exp(-x^2).
  return 0.442946 / (2 * std::sqrt(std::log(2.0))) * wavelength_m / (pitch_m * std::cos(ridge_rad));
}

double contrast_at(const Specimen& specimen, const Wish& wish, const std::vector<double>& values) {
  manifest::Parameters p = parameters_at(wish, values);
  if (const auto pitch = pitch_at(wish, values)) blur(p, *pitch, specimen, wish.wavelength_m);
  const Reflectance f = specimen.with(p);
  const std::vector<double> rotations = rotations_of(wish.experiment);
  double sum = 0, least = std::numeric_limits<double>::infinity();
  for (const double tilt : wish.experiment.tilts_rad) {
    std::vector<double> seen;
    for (const double rotation : rotations) seen.push_back(signal(wish.experiment, f, tilt, rotation));
    double of_tilt = 0;
    for (const auto& [a, b] : wish.experiment.pairs_rad) {
      const auto at = [&](double rad) { return seen[std::ranges::find(rotations, rad) - rotations.begin()]; };
      of_tilt += contrast_of(wish.experiment.definition, at(a), at(b));
    }
    of_tilt /= static_cast<double>(wish.experiment.pairs_rad.size());
    sum += of_tilt;
    least = std::min(least, of_tilt);
  }
  return wish.least ? least : sum / static_cast<double>(wish.experiment.tilts_rad.size());
}

Optimum optimize(const Specimen& specimen, const Wish& wish) {
  check(wish.experiment);
  check_bounds(specimen, wish);
  const Found found = greatest(box_of(wish), wish.points,
                               [&](const std::vector<double>& values) { return contrast_at(specimen, wish, values); });
  if (!(found.value > 0))
    throw Error(Exit::data, specimen.place(), "shows no contrast anywhere within the bounds",
                "widen --bound, or change tilts and pairs so that some light is seen");
  Optimum o;
  o.contrast = found.value;
  o.evaluations = found.evaluations;
  for (std::size_t i = 0; i < wish.bounds.size(); ++i)
    o.numbers.push_back(described(specimen, wish, found.at, found.value, i));
  std::vector<double> values;
  for (const auto& n : o.numbers) values.push_back(n.value);
  o.parameters = specimen.parameters();
  for (const auto& [name, p] : parameters_at(wish, values)) o.parameters[name] = p;
  return o;
}

std::string optimum_csv(const Optimum& o) {
  std::string text =
      "parameter,value,lower_bound,upper_bound,held_by,keeps_95_percent_from,keeps_95_percent_to,"
      "contrast_share_10_percent_less,contrast_share_10_percent_more\n";
  for (const auto& n : o.numbers)
    text += n.parameter + format(",%.7g,%.7g,%.7g,%s,%.7g,%.7g,%.5g,%.5g\n", n.value, n.bound.lower, n.bound.upper,
                                 n.at_bound < 0   ? "lower"
                                 : n.at_bound > 0 ? "upper"
                                                  : "",
                                 n.keeps_from, n.keeps_to, n.less, n.more);
  return text;
}

std::string optimum_sentence(const Optimum& o, const Wish& wish) {
  std::string text = std::string("The ") + (wish.least ? "least contrast of a tilt" : "mean contrast") +
                     " is greatest, " + format("%.4g", o.contrast) +
                     (wish.experiment.definition == Definition::difference ? " per sr" : "") + ", at ";
  for (std::size_t i = 0; i < o.numbers.size(); ++i) {
    const auto& n = o.numbers[i];
    text += (i > 0 ? ", " : "") + n.parameter + " " + with_unit(n.parameter, n.value);
    if (n.at_bound != 0) text += std::string(" (held by its ") + (n.at_bound < 0 ? "lower" : "upper") + " bound)";
  }
  return text + ".";
}

}  // namespace gonio::contrast
