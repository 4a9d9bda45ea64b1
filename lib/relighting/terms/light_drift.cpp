// light.drift: all lamps together, by the time of each picture.
#include "light/mechanisms/light_drift.h"

#include <set>

#include "relighting/uses.h"

namespace gonio::relighting::terms {
namespace {

// Two numbers need three moments, and the time constant is sought between the shortest and ten times the whole time.
std::vector<Use> candidates(const Setting& s) {
  std::set<double> times;
  for (const Recording& image : s.recordings.images)
    if (image.time_s) times.insert(*image.time_s);
  if (times.size() < 3 || switched_on(s.document, mechanism::light_drift().id)) return {};
  const double whole = *times.rbegin() - *times.begin();
  Use use = scene_use(mechanism::light_drift());
  use.numbers[1].lower = whole / static_cast<double>(2 * times.size());
  use.numbers[1].upper = 10 * whole;
  use.numbers[1].start = 0.5 * whole;
  return {use};
}

void edit(const Use& use, std::size_t image, const SceneLayout&, const Recordings& recordings, SceneState& state) {
  const std::span<const double> amounts = use.amounts(state);
  if (const auto time = recordings.images[image].time_s)
    state.gain[image] *= equation::light_drift(amounts[0], amounts[1], *time - recordings.first_time_s);
}

}  // namespace

const Term& light_drift() {
  static const Term term{
      .mechanism = mechanism::light_drift,
      .reach = Reach::compose,
      .candidates = candidates,
      .edit = edit,
  };
  return term;
}

}  // namespace gonio::relighting::terms
