// sensor.black-offset: bounds and start from the pictures' own unit.
#include "render/mechanisms/sensor_black_offset.h"

#include <algorithm>

#include "relighting/image_model.h"
#include "relighting/observed.h"
#include "relighting/uses.h"

namespace gonio::relighting::terms {
namespace {

std::vector<Use> candidates(const Setting& s) {
  std::vector<Use> uses = camera_uses(s, mechanism::sensor_black_offset());
  const double full = largest_value(s.recordings);
  for (Use& use : uses)
    for (Number& n : use.numbers) n.lower = -0.2 * full, n.upper = 0.2 * full, n.start = 0.005 * full;
  return uses;
}

void record(const Use& use, const Frame& frame, std::span<double> values) {
  const double offset = camera_amounts(use, frame)[0];
  for (double& v : values) v = equation::sensor_black_offset(v, offset);
}

}  // namespace

const Term& sensor_black_offset() {
  static const Term term{
      .mechanism = mechanism::sensor_black_offset,
      .reach = Reach::record,
      .order = 80,
      .candidates = candidates,
      .record = record,
      .pointwise = true,
  };
  return term;
}

}  // namespace gonio::relighting::terms
