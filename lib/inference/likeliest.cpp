// See finalists.h: what all the sets say together, and which of them comes first.
#include <algorithm>
#include <functional>
#include <map>
#include <numeric>
#include <set>
#include <string>

#include "inference/finalists.h"

namespace gonio::inference {
namespace {

constexpr double form_errors = 2;
constexpr double near_likeliest = 0.5;  // of the likeliest set's probability

}  // namespace

bool matters(const Finalist& f) {
  return f.refused.empty() && !(f.statistics.times < 0);
}

// Is each of these mechanisms one of those, or one of those on fewer targets?
bool Finalists::is_form_of(const Finalist& f, const Finalist& of) const {
  const std::vector<Candidate>& all = race_.system().problem().candidates();
  return f.model.candidates.size() == of.model.candidates.size() &&
         std::ranges::all_of(f.model.candidates, [&](std::size_t part) {
           return std::ranges::any_of(of.model.candidates,
                                      [&](std::size_t whole) { return is_within(all[part], all[whole]); });
         });
}

// Of forms of one thing the plainest that unseen groups do not clearly call worse: a response is a power law before it
// is a spline, and one picture too bright before two.
const Finalist& Finalists::plainest_form(const Finalist& of) const {
  const Finalist* plainest = &of;
  for (const Finalist& f : list_) {
    if (!matters(f) || !is_form_of(f, of)) continue;
    if (!(f.statistics.numbers < plainest->statistics.numbers)) continue;
    if (errors_between(f.model.held_out, of.model.held_out, 0) < form_errors) plainest = &f;
  }
  return *plainest;
}

std::map<std::string, double> Finalists::inclusions() const {
  std::map<std::string, double> inclusion;
  for (const Finalist& f : list_)
    if (matters(f))
      for (const std::string& name : physics_of(f)) inclusion[name] += f.probability;
  return inclusion;
}

const Finalist* Finalists::sure_part() const {
  std::map<std::set<std::string>, double> sets;
  for (const Finalist& f : list_)
    if (matters(f)) sets[physics_of(f)] += f.probability;
  std::vector<double> largest;
  for (const auto& [physics, probability] : sets) largest.push_back(probability);
  std::ranges::sort(largest, std::greater<>());
  largest.resize(std::min(largest.size(), most_listed));
  if (std::accumulate(largest.begin(), largest.end(), 0.0) > likelier_than_not) return nullptr;
  std::set<std::string> sure;
  for (const auto& [name, probability] : inclusions())
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
  std::set<std::string> median;
  for (const auto& [name, probability] : inclusions())
    if (probability > 0.5 * in_library()) median.insert(name);
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

bool Finalists::holds(const Finalist& whole, const Finalist& part) const {
  return std::ranges::includes(physics_of(whole), physics_of(part));
}

double Finalists::inclusion(const Finalist& some) const {
  double sum = 0;
  for (const Finalist& f : list_)
    if (matters(f) && holds(f, some)) sum += f.probability;
  return sum;
}

double Finalists::in_library() const {
  double sum = 0;
  for (const Finalist& f : list_) sum += matters(f) ? f.probability : 0;
  return sum;
}

}  // namespace gonio::inference
