// See fit.h: the order of things. Candidates are fitted from the starts that do best on a few rows, then judged.
#include "goniometry/fit/fit.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>

#include "base/error.h"
#include "base/parallel.h"
#include "goniometry/fit/checks.h"
#include "goniometry/fit/fit_candidates.h"
#include "goniometry/fit/fit_choice.h"
#include "goniometry/fit/fit_problem.h"
#include "goniometry/fit/limits.h"
#include "goniometry/fit/selection.h"
#include "goniometry/fit/start.h"
#include "goniometry/fit/telling.h"
#include "goniometry/fit/uncertainty.h"

namespace gonio::goniometry {
namespace {

constexpr int screening = 15, thorough = 60;  // iterations
constexpr double first_allowance = 0.1;       // for errors of the model, while starts are tried
constexpr double hopeless = 2;                // times the rms of the best

// Rows and bands on which starts are tried.
struct Few {
  std::vector<std::size_t> bands;
  Samples samples;
  Problem problem;
  Guess guess;
  explicit Few(const Problem& all) : samples(few_of(all, bands)), problem(samples, all.scale()) {
    if (problem.scale() == Scale::noise) problem.set_model_error(first_allowance, samples.f);
    guess = guess_of(problem);
  }
  Few(const Few&) = delete;
};

struct Trial {  // of one candidate on few rows
  Candidate candidate;
  std::vector<Solution> best;  // two at most that differ, best first
  double cost() const { return best.empty() ? std::numeric_limits<double>::infinity() : best.front().at.cost; }
};

// From the starts that the samples suggest, from random ones, and from the best trial of a simpler form.
Trial trial_of(const Few& few, const Candidate& candidate, const std::vector<Trial>& earlier,
               const FitOptions& options) {
  auto beginnings = starts(candidate, few.guess, few.bands.size(), options.random_starts, options.seed);
  const Trial* simpler = nullptr;
  for (const Trial& t : earlier)
    if (std::isfinite(t.cost()) && grows(t.candidate, candidate) && (simpler == nullptr || t.cost() < simpler->cost()))
      simpler = &t;
  if (simpler != nullptr)
    for (auto& start : grown(simpler->candidate, simpler->best.front().x, candidate, few.guess))
      beginnings.push_back(std::move(start));
  std::vector<Solution> tried(beginnings.size());
  parallel_for(0, tried.size(), [&](std::size_t k) {
    tried[k] = solve(few.problem, candidate, beginnings[k], few.problem.rows(), screening);
  });
  std::ranges::stable_sort(tried, {}, [](const Solution& s) { return s.at.cost; });
  Trial trial{candidate, {}};
  for (Solution& solution : tried)
    if (trial.best.size() < 2 && (trial.best.empty() || solution.at.cost >= 1.001 * trial.best.back().at.cost))
      trial.best.push_back(std::move(solution));
  return trial;
}

// Numbers of the candidate's variant that these directions cannot tell, whatever was measured there. `in_plane`: no
// function of the half vector's azimuth shows, so that what a slope at some start still says of a direction is the
// shape of this model's lobe.
std::string untold_of(const Few& few, const Candidate& candidate, const FitOptions& options, bool in_plane) {
  std::vector<Telling> told =
      telling(few.problem, candidate, starts(candidate, few.guess, few.bands.size(), 0, options.seed));
  for (Telling& t : told)
    if (in_plane && t.number.starts_with("anisotropy")) t.share = 0;
  return untold_numbers(told);
}

// Colours of a band begin where those of the nearest tried one ended.
std::vector<double> spread(const Few& few, const Candidate& candidate, const std::vector<double>& x,
                           std::size_t bands) {
  const std::size_t s = candidate.shared.size(), c = candidate.colours.size();
  std::vector<double> all(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(s));
  const auto distance = [](std::size_t a, std::size_t b) { return std::max(a, b) - std::min(a, b); };
  for (std::size_t b = 0; b < bands; ++b) {
    std::size_t nearest = 0;
    for (std::size_t k = 1; k < few.bands.size(); ++k)
      if (distance(few.bands[k], b) < distance(few.bands[nearest], b)) nearest = k;
    for (std::size_t k = 0; k < c; ++k) all.push_back(x[s + nearest * c + k]);
  }
  return all;
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

Solution best_solution(const Problem& problem, const Few& few, const Trial& trial) {
  Solution best;
  best.at.cost = std::numeric_limits<double>::infinity();
  for (const Solution& tried : trial.best) {
    const auto start = spread(few, trial.candidate, tried.x, problem.bands());
    Solution solution = solve(problem, trial.candidate, start, problem.rows(), thorough);
    if (best.x.empty() || solution.at.cost < best.at.cost) best = std::move(solution);
  }
  if (!best.x.empty()) put_in_order(problem, trial.candidate, best);
  return best;
}

// With more bands than are tried, what errs there more than `hopeless` times as much as the best is not fitted to all.
void leave_out_hopeless(const Problem& all, const Few& few, std::vector<Trial>& trials, Fits& out) {
  if (all.bands() <= few.bands.size() || trials.empty()) return;
  const Trial& best = *std::ranges::min_element(trials, {}, [](const Trial& t) { return t.cost(); });
  const double least = best.cost();
  const std::string than = best.candidate.model->info().id;
  std::erase_if(trials, [&](const Trial& t) {
    const double times = std::sqrt(t.cost() / least);
    if (!(times > hopeless)) return false;
    char text[200];
    std::snprintf(text, sizeof text, "errs %.1f times as much as %s on %zu directions of %zu bands: not fitted to all",
                  times, than.c_str(), few.samples.rows(), few.samples.bands());
    out.refusals.push_back({t.candidate.model->info().id, t.candidate.variant, text});
    return true;
  });
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
  const bool turns = turns_about_normal(samples), in_plane = told_direction(samples) < 1e-3;
  if (options.anisotropic == true && !turns)
    out.notes.push_back("asked for in spite of the directions: " + untold_direction(samples));
  if (!options.anisotropic && !turns)
    out.untold = untold_direction(samples), out.refusals.push_back({"every surface", "anisotropic", out.untold});
  const Few few(problem);
  std::vector<Trial> trials;
  for (const Candidate& c :
       candidates(options, options.anisotropic.value_or(turns), out.least_alpha, samples.name, out.refusals)) {
    if (c.unknowns(problem.bands()) >= problem.rows().size() * problem.bands())
      out.refusals.push_back({c.model->info().id, c.variant, "more numbers than samples"});
    else if (const std::string untold = untold_of(few, c, options, in_plane); !untold.empty())
      out.refusals.push_back({c.model->info().id, c.variant, untold});
    else
      trials.push_back(trial_of(few, c, trials, options));
  }
  leave_out_hopeless(problem, few, trials, out);
  std::vector<Run> runs;
  for (const Trial& trial : trials) runs.push_back({trial.candidate, best_solution(problem, few, trial), {}, {}});
  allow_for_models(problem, runs);
  const std::vector<Rows> blocks = blocks_of(problem), folds = folds_of(problem, blocks, options.folds);
  for (Run& run : runs) {
    run.folds = held_out(problem, run.candidate, run.solution, folds);
    state(problem, blocks, options.check, run);
  }
  choose(problem, std::move(runs), out.least_alpha, options, out);
  return out;
}

}  // namespace gonio::goniometry
