// See finalists.h: what all the sets say together, and which of them comes first.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <string>

#include "inference/finalists.h"
#include "stats/distributions.h"

namespace gonio::inference {
namespace {

constexpr std::size_t enough_groups = 5;  // for a standard error over groups to mean something
constexpr double form_errors = 2;
constexpr double near_likeliest = 0.5;  // of the likeliest set's probability

}  // namespace

bool matters(const Finalist& f) {
  return f.refused.empty() && !(f.statistics.times < 0);
}

double errors_between(const HeldOut& before, const HeldOut& after, double floor) {
  const Gain g = gain(before, after);
  const std::size_t groups = before.whitened.size();
  if (!(g.sigma < std::numeric_limits<double>::max())) return -at_most_errors;
  if (groups < enough_groups) {
    const double blocks = block_z(before, after);
    const double sigma = blocks != 0 ? std::abs(g.mean / blocks) : 0;
    const double all = std::hypot(sigma, floor);
    return all > 0 ? std::clamp(g.mean / all, -at_most_errors, at_most_errors) : 0;
  }
  const double sigma = std::hypot(g.sigma, floor);
  if (!(sigma > 0)) return g.mean > 0 ? at_most_errors : 0;
  const double t = g.mean / sigma;
  const double tail = stats::student_upper(std::abs(t), static_cast<double>(groups) - 1);
  return std::copysign(std::min(stats::normal_upper_quantile(tail), at_most_errors), t);
}

// Of forms of one thing the plainest that unseen groups do not clearly call worse: a response is a power law before it
// is a spline.
const Finalist& Finalists::plainest_form(const Finalist& of) const {
  const Finalist* plainest = &of;
  for (const Finalist& f : list_) {
    if (!matters(f) || physics_of(f) != physics_of(of) || f.model.candidates.size() != of.model.candidates.size())
      continue;
    if (!(f.statistics.numbers < plainest->statistics.numbers)) continue;
    if (errors_between(f.model.held_out, of.model.held_out, 0) < form_errors) plainest = &f;
  }
  return *plainest;
}

const Finalist* Finalists::sure_part() const {
  std::map<std::string, double> inclusion;
  std::map<std::set<std::string>, double> sets;
  for (const Finalist& f : list_) {
    if (!matters(f)) continue;
    const std::set<std::string> physics = physics_of(f);
    sets[physics] += f.probability;
    for (const std::string& name : physics) inclusion[name] += f.probability;
  }
  std::vector<double> largest;
  for (const auto& [physics, probability] : sets) largest.push_back(probability);
  std::ranges::sort(largest, std::greater<>());
  largest.resize(std::min(largest.size(), most_listed));
  if (std::accumulate(largest.begin(), largest.end(), 0.0) > likelier_than_not) return nullptr;
  std::set<std::string> sure;
  for (const auto& [name, probability] : inclusion)
    if (probability >= options_.sure) sure.insert(name);
  const Finalist* part = nullptr;
  for (const Finalist& f : list_)
    if (matters(f) && physics_of(f) == sure && (part == nullptr || f.gained > part->gained)) part = &f;
  return part;
}

const Finalist* Finalists::likeliest() const {
  if (const Finalist* part = sure_part()) return &plainest_form(*part);
  // The median probability model (Barbieri & Berger, Annals of Statistics 32, 2004): whatever is more likely than not
  // to be among what was left out, in any set and form; where that is no likely set, the likeliest.
  std::map<std::string, double> inclusion;
  double all = 0;
  for (const Finalist& f : list_) {
    if (!matters(f)) continue;
    all += f.probability;
    for (const std::string& name : physics_of(f)) inclusion[name] += f.probability;
  }
  std::set<std::string> median;
  for (const auto& [name, probability] : inclusion)
    if (probability > 0.5 * all) median.insert(name);
  const Finalist *best = nullptr, *best_median = nullptr;
  for (const Finalist& f : list_) {
    if (!matters(f)) continue;
    if (best == nullptr || f.probability > best->probability) best = &f;
    if (physics_of(f) != median) continue;
    if (best_median == nullptr || f.probability > best_median->probability) best_median = &f;
  }
  if (best_median != nullptr && best_median->probability > near_likeliest * best->probability) best = best_median;
  return best == nullptr ? nullptr : &plainest_form(*best);
}

double Finalists::with(const Finalist& some) const {
  const std::set<std::string> wanted = physics_of(some);
  double sum = 0;
  for (const Finalist& f : list_)
    if (matters(f) && std::ranges::includes(physics_of(f), wanted)) sum += f.probability;
  return sum;
}

double Finalists::in_library() const {
  double sum = 0;
  for (const Finalist& f : list_) sum += matters(f) ? f.probability : 0;
  return sum;
}

}  // namespace gonio::inference
