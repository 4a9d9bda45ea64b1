// See stability.h.
#include "inference/stability.h"

#include <algorithm>
#include <numeric>
#include <set>

#include "base/progress.h"
#include "base/random.h"

namespace gonio::inference {
namespace {

constexpr std::size_t fewest_groups = 4;

std::set<std::vector<std::size_t>> parts_left_out(std::size_t groups, std::size_t draws, std::uint64_t seed) {
  std::set<std::vector<std::size_t>> parts;
  Random random(seed, 0x73746162u);
  std::vector<std::size_t> order(groups);
  for (std::size_t tries = 0; tries < 50 * draws && parts.size() < draws; ++tries) {
    std::iota(order.begin(), order.end(), 0);
    for (std::size_t k = groups - 1; k > 0; --k)
      std::swap(order[k], order[random.below(static_cast<std::uint32_t>(k + 1))]);
    std::vector<std::size_t> part(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(groups / 4));
    std::sort(part.begin(), part.end());
    parts.insert(part);
  }
  return parts;
}

}  // namespace

// A power law and a spline of one response are one answer: the first candidate of a mechanism on its targets stands for
// all of them.
std::vector<std::size_t> whatever_the_form(const Problem& problem, std::vector<std::size_t> named) {
  const std::vector<Candidate>& all = problem.candidates();
  for (std::size_t& c : named)
    c = static_cast<std::size_t>(
        std::ranges::find_if(
            all, [&](const Candidate& other) { return other.id() == all[c].id() && other.on == all[c].on; }) -
        all.begin());
  std::ranges::sort(named);
  named.erase(std::ranges::unique(named).begin(), named.end());
  return named;
}

std::size_t Stability::same(const Problem& problem, Verdict verdict, std::vector<std::size_t> named) const {
  named = whatever_the_form(problem, std::move(named));
  std::size_t times = 0;
  for (const Answer& a : answers)
    if (a.named == named && (!named.empty() || a.verdict == verdict)) times += a.times;
  return times;
}

Stability stability(const Problem& problem, std::size_t draws, std::uint64_t seed,
                    const std::function<Explanation(const std::vector<std::size_t>& left_out)>& explained) {
  const std::size_t groups = problem.observations().groups();
  Stability result;
  if (groups < fewest_groups) return result;
  result.groups = groups - groups / 4;
  const std::set<std::vector<std::size_t>> parts = parts_left_out(groups, draws, seed);
  for (const std::vector<std::size_t>& part : parts) {
    const Explanation e = explained(part);
    const std::vector<std::size_t> named = whatever_the_form(problem, e.named);
    const auto known = std::ranges::find_if(result.answers, [&](const Stability::Answer& a) {
      return a.named == named && (!named.empty() || a.verdict == e.verdict);
    });
    ++result.draws;
    ++(known != result.answers.end() ? *known : result.answers.emplace_back(e.verdict, named)).times;
    log(LogLevel::info, problem.domain() + ": part " + std::to_string(result.draws) + " of " +
                            std::to_string(parts.size()) + ": " + verdict_name(e.verdict));
  }
  std::stable_sort(result.answers.begin(), result.answers.end(),
                   [](const Stability::Answer& a, const Stability::Answer& b) { return a.times > b.times; });
  return result;
}

}  // namespace gonio::inference
