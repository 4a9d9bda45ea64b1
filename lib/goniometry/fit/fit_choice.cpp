// See fit_choice.h.
#include "goniometry/fit/fit_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>

#include "goniometry/fit/checks.h"
#include "goniometry/fit/limits.h"
#include "stats/distributions.h"

namespace gonio::goniometry {
namespace {

// Numbers that are amounts: at zero, what their variant adds is gone.
constexpr std::array amounts = {"second_share", "retro", "sigma_rad", "anisotropy", "anisotropy_0", "anisotropy_45"};

std::string text_of(const char* form, double a, double b = 0) {
  char text[160];
  std::snprintf(text, sizeof text, form, a, b);
  return text;
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
  std::string text = name_of(f);
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

std::vector<const FittedNumber*> own_amounts(const Run& run) {
  std::vector<const FittedNumber*> own;
  if (run.fit.variant.empty()) return own;
  for (const FittedNumber& n : run.fit.numbers)
    if (std::ranges::find(amounts, n.name) != amounts.end()) own.push_back(&n);
  return own;
}

// Mean square of the difference between what two fits predict, on the scale of the fit.
double apart(const Problem& problem, const Run& a, const Run& b) {
  const std::vector<double> one = problem.predictions(a.candidate, a.solution.x),
                            other = problem.predictions(b.candidate, b.solution.x);
  double sum = 0;
  std::size_t count = 0;
  for (const std::uint32_t r : problem.rows())
    for (std::size_t band = 0; band < problem.bands(); ++band) {
      if (!problem.used(r, band)) continue;
      const std::size_t k = r * problem.bands() + band;
      const double off = problem.residual(r, band, one[k]) - problem.residual(r, band, other[k]);
      sum += off * off, ++count;
    }
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

double square(double x) {
  return x * x;
}

// Fills same_as: of fits with fewer numbers the first that predicts the same.
void find_the_same(const Problem& problem, std::vector<Run>& runs, std::vector<std::string>& notes) {
  std::vector<Run*> order;
  for (Run& run : runs) order.push_back(&run);
  std::ranges::stable_sort(order, {}, [](const Run* run) { return run->fit.numbers.size(); });
  std::map<std::string, std::string> same;
  for (std::size_t k = 1; k < order.size(); ++k) {
    Fit& fit = order[k]->fit;
    const double left = square(fit.fitted.scaled);
    for (std::size_t i = 0; i < k && fit.same_as.empty(); ++i) {
      const Fit& plain = order[i]->fit;
      // Errors alike to a tenth can be those of predictions that are alike to a hundredth; others are spared the look.
      if (plain.numbers.size() >= fit.numbers.size() || !plain.same_as.empty() ||
          std::abs(square(plain.fitted.scaled) - left) > 0.1 * left)
        continue;
      if (apart(problem, *order[i], *order[k]) <= alike * left) fit.same_as = name_of(plain);
    }
    if (!fit.same_as.empty()) same[fit.same_as] += (same[fit.same_as].empty() ? "" : ", ") + name_of(fit);
  }
  for (const auto& [plain, others] : same) notes.push_back("The same as " + plain + ", with more numbers: " + others);
}

// Of the mean square that is least, what a fit may exceed it by and still do as well.
double tolerated(const Run& best, double least) {
  if (best.folds.empty()) return 0;
  const bool noise_alone = best.fit.scale == Scale::noise && best.fit.model_error == 0;
  return (noise_alone ? alike : material_gain) * square(least);
}

std::size_t simplest(const std::vector<Run>& runs, double negligible, bool told) {
  std::size_t chosen = whole_sample, fewest = std::numeric_limits<std::size_t>::max();
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const Fit& fit = runs[k].fit;
    if (fit.held_out_excess > std::max(fit.held_out_excess_sigma, negligible) || fit.numbers.size() >= fewest ||
        (k > 0 && runs[k].folds.empty()) || (told && !tells_its_variant(runs[k])))
      continue;
    chosen = k, fewest = fit.numbers.size();
  }
  return chosen;
}

std::string untold(const Run& run) {
  std::string text;
  for (const FittedNumber* n : own_amounts(run))
    text +=
        (text.empty() ? "its " : ", ") + n->name + " " +
        (std::isfinite(n->sigma) ? text_of("%.2g +- %.1g", n->value, n->sigma) : text_of("%.2g at a bound", n->value));
  return text + ": not told from nothing";
}

// Why this one is not chosen.
std::string reason_of(const Run& run, const Run& chosen, double negligible) {
  if (!run.fit.same_as.empty()) return "the same as " + run.fit.same_as;
  if (!run.fit.converged) return "did not converge";
  if (run.folds.empty() || chosen.folds.empty()) return {};
  const Excess over = excess(run.folds, chosen.folds);
  const bool richer = run.fit.numbers.size() > chosen.fit.numbers.size();
  if (over.mean < 0 && richer && !tells_its_variant(run)) return untold(run);
  if (over.mean < 0 && richer && -over.mean > over.sigma && -over.mean <= negligible) {
    const double share = -over.mean / square(chosen.fit.held_out.scaled);
    return text_of("errs less by %.2g %% of the mean square: below %.0f %%, not material", 100 * share,
                   100 * material_gain);
  }
  if (over.mean <= std::max(over.sigma, negligible))
    return richer ? "as good within one standard error, and no simpler" : "as good within one standard error";
  return "errs more on held-out directions";
}

void state_reasons(std::vector<Run>& runs, double negligible, Fits& out) {
  const Run& chosen = runs[out.chosen];
  const double left = square(chosen.fit.held_out.scaled);
  for (std::size_t k = 0; k < runs.size(); ++k) {
    Run& run = runs[k];
    if (k == out.chosen) continue;
    run.fit.reason = reason_of(run, chosen, negligible);
    if (run.fit.numbers.size() == chosen.fit.numbers.size() && !run.folds.empty() &&
        std::abs(excess(run.folds, chosen.folds).mean) <= alike * left)
      out.notes.push_back(run.fit.model->info().id + " does as well as " + chosen.fit.model->info().id +
                          ": these samples do not tell them apart");
  }
  // The best of those that are passed over for being richer.
  const Run& best = runs.front();
  if (out.chosen == 0 || !best.fit.same_as.empty() || best.fit.numbers.size() <= chosen.fit.numbers.size()) return;
  out.notes.push_back(name_of(best.fit) +
                      text_of(", with %.0f numbers to %.0f, ", static_cast<double>(best.fit.numbers.size()),
                              static_cast<double>(chosen.fit.numbers.size())) +
                      text_of("errs less by %.2g %% of the mean square on held-out directions",
                              100 * chosen.fit.held_out_excess / left) +
                      text_of(", +- %.1g %%: a richer surface is chosen beyond one standard error and %.0f %%",
                              100 * chosen.fit.held_out_excess_sigma / left,
                              100 * negligible / square(best.fit.held_out.scaled)));
}

}  // namespace

std::string name_of(const Fit& fit) {
  return fit.model->info().id + (fit.variant.empty() ? "" : " (" + fit.variant + ")");
}

bool tells_its_variant(const Run& run) {
  const auto own = own_amounts(run);
  if (own.empty()) return true;
  return std::ranges::any_of(own, [&](const FittedNumber* n) {
    if (n->at != FittedNumber::At::inside) return n->low > 0 || n->high < 0;
    const double reach = stats::student_quantile(1 - 0.025 / static_cast<double>(own.size()), n->degrees) * n->sigma;
    return std::abs(n->value) > reach;  // not of NaN: what is not determined is not told
  });
}

void choose(const Problem& problem, std::vector<Run> runs, double least_alpha, const FitOptions& options, Fits& out) {
  const auto score = [&](const Run& run) {
    return options.folds > 1 && !run.folds.empty() ? run.fit.held_out.scaled : run.fit.fitted.scaled;
  };
  std::erase_if(runs, [&](const Run& run) {
    const std::string why = doubt(run, least_alpha);
    if (!why.empty()) out.refusals.push_back({run.candidate.model->info().id, run.candidate.variant, why});
    return !why.empty();
  });
  if (runs.empty()) return;
  std::ranges::stable_sort(runs, {}, score);
  for (Run& run : runs) {
    const Excess over = excess(run.folds, runs[0].folds);
    run.fit.held_out_excess = over.mean, run.fit.held_out_excess_sigma = over.sigma;
    run.fit.verdict = verdict_of(run);
  }
  find_the_same(problem, runs, out.notes);
  const double negligible = tolerated(runs[0], score(runs[0]));
  out.chosen = simplest(runs, negligible, true);
  if (out.chosen == whole_sample) out.chosen = simplest(runs, negligible, false);
  state_reasons(runs, negligible, out);
  for (Run& run : runs) out.candidates.push_back(std::move(run.fit));
}

}  // namespace gonio::goniometry
