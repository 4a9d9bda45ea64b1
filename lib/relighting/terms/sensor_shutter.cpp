// sensor.shutter: pictures whose exposures are stated and differ.
#include "render/mechanisms/sensor_shutter.h"

#include <set>

#include "relighting/image_model.h"
#include "relighting/observed.h"
#include "relighting/uses.h"

namespace gonio::relighting::terms {
namespace {

std::vector<Use> candidates(const Setting& s) {
  std::set<double> exposures;
  for (const Recording& image : s.recordings.images)
    if (image.exposure_s) exposures.insert(*image.exposure_s);
  if (exposures.size() < 2) return {};
  std::vector<Use> uses = camera_uses(s, mechanism::sensor_shutter());
  for (Use& use : uses)
    for (Number& n : use.numbers) {
      n.lower = std::max(n.lower, -0.5 * *exposures.begin());
      n.upper = std::min(n.upper, *exposures.begin());
      n.start = 0.02 * *exposures.begin();
    }
  return uses;
}

void record(const Use& use, const Frame& frame, std::span<double> values) {
  if (!frame.image.exposure_s) return;
  const double extra_s = camera_amounts(use, frame)[0];
  for (double& v : values) v = equation::sensor_shutter(v, extra_s, *frame.image.exposure_s);
}

}  // namespace

const Term& sensor_shutter() {
  static const Term term{
      .mechanism = mechanism::sensor_shutter,
      .reach = Reach::record,
      .order = 2,
      .candidates = candidates,
      .record = record,
      .pointwise = true,
  };
  return term;
}

}  // namespace gonio::relighting::terms
