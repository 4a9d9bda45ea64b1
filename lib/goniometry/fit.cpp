// See fit.h: the order of things. Candidates are fitted from the starts that do best on a few rows, then judged.
#include "goniometry/fit.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>

#include "base/error.h"
#include "base/parallel.h"
#include "goniometry/checks.h"
#include "goniometry/fit_candidates.h"
#include "goniometry/fit_problem.h"
#include "goniometry/limits.h"
#include "goniometry/selection.h"
#include "goniometry/start.h"
#include "goniometry/uncertainty.h"

namespace gonio::goniometry {
namespace {

constexpr int screening = 15, thorough = 60;  // iterations
constexpr double first_allowance = 0.1;       // for errors of the model, while starts are tried
constexpr double alike = 1e-4;                // of the mean square: what rounding and steps decide

struct Run {  // of one candidate
  Candidate candidate;
  Solution solution;
  std::vector<Errors> folds;
  Fit fit;
};

std::string text_of(const char* form, double a, double b = 0) {
  char text[160];
  std::snprintf(text, sizeof text, form, a, b);
  return text;
}

// Beginnings for all bands, best first, from trials on few rows and bands.
std::vector<std::vector<double>> good_starts(const Problem& all, const Candidate& candidate,
                                             const FitOptions& options) {
  std::vector<std::size_t> bands;
  const Samples few = few_of(all, bands);
  Problem problem(few, all.scale());
  if (problem.scale() == Scale::noise) problem.set_model_error(first_allowance, few.f);
  const auto beginnings = starts(candidate, guess_of(problem), bands.size(), options.random_starts, options.seed);
  std::vector<Solution> tried(beginnings.size());
  parallel_for(0, tried.size(),
               [&](std::size_t k) { tried[k] = solve(problem, candidate, beginnings[k], problem.rows(), screening); });
  std::ranges::stable_sort(tried, {}, [](const Solution& s) { return s.at.cost; });
  std::vector<std::vector<double>> out;
  const std::size_t s = candidate.shared.size(), c = candidate.colours.size();
  double last = -1;
  for (const Solution& solution : tried) {
    if (out.size() == 2 || (last >= 0 && solution.at.cost < 1.001 * last)) continue;
    last = solution.at.cost;
    out.emplace_back(solution.x.begin(), solution.x.begin() + static_cast<std::ptrdiff_t>(s));
    for (std::size_t b = 0; b < all.bands(); ++b) {
      std::size_t nearest = 0;
      for (std::size_t k = 1; k < bands.size(); ++k)
        if (std::max(bands[k], b) - std::min(bands[k], b) < std::max(bands[nearest], b) - std::min(bands[nearest], b))
          nearest = k;
      for (std::size_t k = 0; k < c; ++k) out.back().push_back(solution.x[s + nearest * c + k]);
    }
  }
  return out;
}

// Two populations of facets have no order of their own: the smoother one comes first.
void put_in_order(const Problem& problem, const Candidate& candidate, Solution& solution) {
  std::size_t first = whole_sample, second = whole_sample, share = whole_sample;
  for (std::size_t i = 0; i < candidate.shared.size(); ++i) {
    const std::string& name = candidate.name(candidate.shared[i]);
    if (name == "alpha") first = i;
    if (name == "second_alpha") second = i;
    if (name == "second_share") share = i;
  }
  if (first == whole_sample || second == whole_sample || share == whole_sample) return;
  std::vector<double> x = solution.x;
  if (x[first] <= x[second] || 1 - x[share] > candidate.shared[share].upper) return;
  std::swap(x[first], x[second]);
  x[share] = 1 - x[share];
  Solution swapped = solve(problem, candidate, x, problem.rows(), thorough);
  if (swapped.at.cost <= solution.at.cost * (1 + alike)) solution = std::move(swapped);
}

Solution best_solution(const Problem& problem, const Candidate& candidate, const FitOptions& options) {
  Solution best;
  best.at.cost = std::numeric_limits<double>::infinity();
  for (const auto& start : good_starts(problem, candidate, options)) {
    Solution solution = solve(problem, candidate, start, problem.rows(), thorough);
    if (best.x.empty() || solution.at.cost < best.at.cost) best = std::move(solution);
  }
  if (!best.x.empty()) put_in_order(problem, candidate, best);
  return best;
}

// Share of the tolerance that brings the mean square to one about these predictions; 0 where it is below without.
double model_error_of(const Problem& problem, const Candidate& candidate, const Solution& solution) {
  const std::vector<double> m = problem.predictions(candidate, solution.x);
  std::vector<double> r2, s2, m2;
  const Samples& samples = problem.samples();
  const std::size_t bands = problem.bands();
  for (const std::uint32_t r : problem.rows())
    for (std::size_t b = 0; b < bands; ++b) {
      if (!problem.used(r, b)) continue;
      const std::size_t k = r * bands + b;
      const double off = samples.f[k] - m[k], may = problem.tolerance(r, m[k]);
      r2.push_back(off * off), s2.push_back(samples.sigma[k] * samples.sigma[k]), m2.push_back(may * may);
    }
  const double left = std::max(1.0, static_cast<double>(r2.size()) - static_cast<double>(solution.x.size()));
  const auto excess_at = [&](double e) {
    double sum = 0;
    for (std::size_t i = 0; i < r2.size(); ++i) sum += r2[i] / (s2[i] + e * e * m2[i]);
    return sum / left - 1;
  };
  // Four standard deviations of a mean square of normal noise are none of the model's.
  if (excess_at(0) < 4 * std::sqrt(2 / left)) return 0;
  double low = 0, high = 1;
  for (int i = 0; i < 50; ++i) {
    const double middle = (low + high) / 2;
    (excess_at(middle) > 0 ? low : high) = middle;
  }
  return high;
}

// Why a fit is not to be believed; empty where it is.
std::string doubt(const Run& run, double least) {
  for (std::size_t i = 0; i < run.solution.x.size(); ++i) {
    const Slot& slot = slot_of(run.candidate, i);
    const auto& info = run.candidate.model->info().parameters[slot.parameter];
    if ((info.name.starts_with("alpha") || info.name == "second_alpha") && slot.lower > info.lower &&
        slot.lower == least && run.solution.x[i] <= slot.lower * (1 + 1e-6))
      return too_narrow(least);
  }
  if (!std::isfinite(run.solution.at.cost)) return "no start led to a finite misfit";
  if (run.fit.energy > 1 + energy_tolerance)
    return text_of("it returns %.3f of the light from some direction, more than arrives", run.fit.energy);
  if (run.fit.reciprocity > 1e-6)
    return text_of("it is not reciprocal: exchanging the directions changes it by %.2g", run.fit.reciprocity);
  return {};
}

std::string verdict_of(const Run& run) {
  const Fit& f = run.fit;
  std::string text = f.model->info().id + (f.variant.empty() ? "" : " (" + f.variant + ")");
  const char* unit = f.scale == Scale::noise   ? " sigma"
                     : f.scale == Scale::log10 ? " decades"
                                               : " of log(1 + 100 f cos cos)";
  text += text_of(": rms %.3g", f.fitted.scaled) + unit;
  if (f.model_error > 0) text += text_of(" with a model error of %.2g %%", 100 * f.model_error);
  if (std::isfinite(f.held_out.scaled)) text += text_of(", held out %.3g", f.held_out.scaled);
  text += text_of("; %.0f numbers", static_cast<double>(f.numbers.size()));
  std::string pressed, unseen;
  for (const FittedNumber& n : f.numbers) {
    std::string& list = n.at != FittedNumber::At::inside ? pressed : unseen;
    if ((n.at == FittedNumber::At::inside && std::isfinite(n.sigma)) || list.find(n.name) != std::string::npos)
      continue;
    list += (list.empty() ? "" : ", ") + n.name;
  }
  if (!pressed.empty()) text += "; at a bound: " + pressed;
  if (!unseen.empty()) text += "; not determined: " + unseen;
  if (!f.converged) text += "; not converged";
  return text;
}

void state(const Problem& problem, const std::vector<Rows>& blocks, bool check, Run& run) {
  Fit& fit = run.fit;
  const auto& x = run.solution.x;
  fit.model = run.candidate.model;
  fit.variant = run.candidate.variant;
  fit.triples = run.candidate.triples(x, problem.bands());
  fit.converged = run.solution.converged;
  fit.observations = run.solution.at.observations;
  fit.scale = problem.scale();
  fit.model_error = problem.model_error();
  state_uncertainty(problem, run.candidate, run.solution, blocks, fit);
  const Errors errors = errors_of(problem, run.candidate, x, problem.rows());
  fit.fitted = errors.rms();
  for (std::size_t b = 0; b < problem.bands(); ++b)
    fit.band_log1p.push_back(
        std::sqrt(errors.band_log1p[b] / std::max<double>(1, static_cast<double>(errors.band_count[b]))));
  Errors all;
  for (const Errors& fold : run.folds) all.add(fold);
  fit.held_out = all.rms();
  if (check) fit.energy = greatest_albedo(fit), fit.reciprocity = reciprocity_error(fit, problem.samples());
}

void check_samples(const Samples& s) {
  if (s.rows() == 0 || s.bands() == 0) throw Error(Exit::data, s.name, "no samples", "see what was dropped, and why");
  if (s.wo.size() != s.rows() || s.f.size() != s.rows() * s.bands() ||
      (!s.sigma.empty() && s.sigma.size() != s.f.size()) || (!s.series.empty() && s.series.size() != s.rows()))
    throw Error(Exit::internal, s.name, "directions, reflectances and their uncertainties differ in number");
}

Samples thinned(const Samples& samples, std::size_t most, std::vector<std::string>& notes) {
  if (samples.rows() <= most) return samples;
  Rows rows;
  for (std::size_t k = 0; k < most; ++k) rows.push_back(static_cast<std::uint32_t>(k * samples.rows() / most));
  std::vector<std::size_t> bands(samples.bands());
  std::iota(bands.begin(), bands.end(), std::size_t{0});
  notes.push_back("fitted to " + std::to_string(most) + " of " + std::to_string(samples.rows()) + " directions");
  return chosen_rows(samples, rows, bands);
}

Scale scale_of(const Samples& samples, Scale wanted) {
  const bool stated = std::ranges::any_of(samples.sigma, [](double s) { return s > 0; });
  if (wanted == Scale::noise && !stated)
    throw Error(Exit::data, samples.name, "the samples state no uncertainty", "fit on the scale log1p or log10");
  return wanted != Scale::automatic ? wanted : stated ? Scale::noise : Scale::log1p;
}

void rank(std::vector<Run>& runs, double least, const FitOptions& options, Fits& out) {
  const auto score = [&](const Run& run) {
    return options.folds > 1 && !run.folds.empty() ? run.fit.held_out.scaled : run.fit.fitted.scaled;
  };
  std::erase_if(runs, [&](const Run& run) {
    const std::string why = doubt(run, least);
    if (!why.empty()) out.refusals.push_back({run.candidate.model->info().id, run.candidate.variant, why});
    return !why.empty();
  });
  std::ranges::stable_sort(runs, {}, score);
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  for (std::size_t k = 0; k < runs.size(); ++k) {
    Fit& fit = runs[k].fit;
    const Excess over = excess(runs[k].folds, runs[0].folds);
    fit.held_out_excess = over.mean, fit.held_out_excess_sigma = over.sigma;
    const double negligible = runs[0].folds.empty() ? 0 : alike * score(runs[0]) * score(runs[0]);
    if (over.mean <= std::max(over.sigma, negligible) && fit.numbers.size() < fewest &&
        (k == 0 || !runs[k].folds.empty()))
      out.chosen = k, fewest = fit.numbers.size();
  }
  for (std::size_t k = 0; k < runs.size() && out.chosen < runs.size(); ++k) {
    const Run &run = runs[k], &chosen = runs[out.chosen];
    if (k != out.chosen && run.fit.numbers.size() == chosen.fit.numbers.size() && !run.folds.empty() &&
        std::abs(excess(run.folds, chosen.folds).mean) <= alike * score(chosen) * score(chosen))
      out.notes.push_back(run.fit.model->info().id + " does as well as " + chosen.fit.model->info().id +
                          ": these samples do not tell them apart");
  }
  for (Run& run : runs) {
    run.fit.verdict = verdict_of(run);
    out.candidates.push_back(std::move(run.fit));
  }
}

// Where samples state their noise: the least error that any model must admit holds for all. Fits have begun with
// first_allowance, lest what no model can say of dark samples decides where they go.
void allow_for_models(Problem& problem, std::vector<Run>& runs) {
  if (problem.scale() != Scale::noise || runs.empty()) return;
  const auto best = std::ranges::min_element(runs, {}, [](const Run& run) { return run.solution.at.cost; });
  for (int round = 0; round < 3; ++round) {
    const double e = model_error_of(problem, best->candidate, best->solution);
    problem.set_model_error(e, problem.predictions(best->candidate, best->solution.x));
    best->solution = solve(problem, best->candidate, best->solution.x, problem.rows(), thorough);
  }
  for (Run& run : runs) run.solution = solve(problem, run.candidate, run.solution.x, problem.rows(), thorough);
}

}  // namespace

const FittedNumber* Fit::number(const std::string& name, std::size_t band) const {
  const auto found = std::ranges::find_if(numbers, [&](const auto& n) { return n.name == name && n.band == band; });
  return found == numbers.end() ? nullptr : &*found;
}

double Fit::evaluate(Vec3 wo, Vec3 wi, std::size_t band) const {
  return model->evaluate(triples[band / 3], wo, wi)[static_cast<int>(band % 3)];
}

Fits fit_surfaces(const Samples& given, const FitOptions& options) {
  check_samples(given);
  Fits out;
  const Samples samples = thinned(given, options.most_rows, out.notes);
  Problem problem(samples, scale_of(samples, options.scale));
  if (problem.rows().empty()) throw Error(Exit::data, samples.name, "no sample above the horizon has a number to fit");
  if (problem.scale() == Scale::noise) problem.set_model_error(first_allowance, samples.f);
  out.least_alpha = least_alpha(samples);
  const bool turns = turns_about_normal(samples);
  if (options.anisotropic == true && !turns)
    out.notes.push_back("half vectors stay in one plane: a direction of the sample shows little there");
  std::vector<Run> runs;
  for (const Candidate& c :
       candidates(options, options.anisotropic.value_or(turns), out.least_alpha, samples.name, out.refusals)) {
    if (c.unknowns(problem.bands()) >= problem.rows().size() * problem.bands()) {
      out.refusals.push_back({c.model->info().id, c.variant, "more numbers than samples"});
      continue;
    }
    runs.push_back({c, best_solution(problem, c, options), {}, {}});
  }
  allow_for_models(problem, runs);
  const std::vector<Rows> blocks = blocks_of(problem), folds = folds_of(problem, blocks, options.folds);
  for (Run& run : runs) {
    run.folds = held_out(problem, run.candidate, run.solution, folds);
    state(problem, blocks, options.check, run);
  }
  rank(runs, out.least_alpha, options, out);
  return out;
}

}  // namespace gonio::goniometry
