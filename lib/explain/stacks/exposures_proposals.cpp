// Pictures that could be taken next for a stack of exposures: what bends a response shows at levels that the stack has
// not reached, and what adds to readings when no light does.
#include <algorithm>
#include <cmath>

#include "explain/stacks/exposures_problem.h"
#include "inference/wording.h"

namespace gonio::explain::stacks {
namespace {

constexpr double wide_gap = 2.5;       // of neighbouring exposures
constexpr double tells_nothing = 1e3;  // full scales of noise: a reading that says no more than "at least"

}  // namespace

std::vector<ExposuresProblem::Proposed> ExposuresProblem::proposed() const {
  std::vector<std::size_t> order;
  for (std::size_t g = 0; g < taken_.size(); ++g) order.push_back(g);
  std::ranges::stable_sort(order, {}, [this](std::size_t g) { return taken_[g].exposure_s; });
  const double shortest = taken_[order.front()].exposure_s, longest = taken_[order.back()].exposure_s;
  std::vector<Proposed> all = {
      {order.back(), 2 * longest}, {order.front(), shortest / 2}, {order.back(), longest, true}};
  double widest = wide_gap;
  std::size_t below = order.size();
  for (std::size_t k = 0; k + 1 < order.size(); ++k) {
    const double gap = taken_[order[k + 1]].exposure_s / taken_[order[k]].exposure_s;
    if (gap > widest) widest = gap, below = k;
  }
  if (below < order.size()) all.push_back({order[below], taken_[order[below]].exposure_s * std::sqrt(widest)});
  return all;
}

std::vector<Proposal> ExposuresProblem::proposals() const {
  std::vector<Proposal> all;
  for (const Proposed& p : proposed()) {
    const std::string& id = stack_.images[p.like].id;
    manifest::Value setup = manifest::Value::object();
    setup["image"] = id;
    setup["exposure_s"] = p.exposure_s;
    if (p.dark) setup["light"] = manifest::Value::array();
    all.push_back({"image " + id + " again " +
                       (p.dark ? std::string("with the lamps off") : "at " + inference::quantity(p.exposure_s, "s", 3)),
                   setup});
  }
  return all;
}

// A radiance is known as well as the picture tells that shows it best.
ProposedRows ExposuresProblem::propose(std::span<const double> values, std::size_t proposal) const {
  const Proposed p = proposed()[proposal];
  const ReadingChain now = chain(values);
  ProposedRows rows;
  for (std::size_t s = 0; s < sites_.size(); ++s) {
    const int channel = sites_[s].channel;
    Taken at = taken_at(p.like, s);
    at.exposure_s = p.exposure_s;
    at.image = Taken::unseen;
    const double light = p.dark ? 0 : radiance(now, values, s);
    const double reading = now(light, channel, at);
    rows.prediction.push_back(reading);
    const double shown = values[base_[s]];
    const double known = shown > 0 ? noise_.sigma(shown_in_[s], shown) / shown : 1;
    const bool clipped = reading >= 0.98 * stack_.full_scale;
    rows.sigma.push_back(clipped ? tells_nothing * stack_.full_scale
                                 : std::hypot(noise_.sigma(p.like, reading), p.dark ? 0 : known * reading));
  }
  return rows;
}

}  // namespace gonio::explain::stacks
