// sensor.saturation: where several readings are as large as the largest one, that may be full scale.
#include "render/mechanisms/sensor_saturation.h"

#include "relighting/image_model.h"
#include "relighting/observed.h"
#include "relighting/uses.h"

namespace gonio::relighting::terms {
namespace {

constexpr std::size_t least_readings = 20;  // within a hundredth of the largest: more than noise heaps up there

std::vector<Use> candidates(const Setting& s) {
  const double full = largest_value(s.recordings);
  if (readings_near(s.recordings, full) < least_readings) return {};
  std::vector<Use> uses = camera_uses(s, mechanism::sensor_saturation());
  for (Use& use : uses) {
    use.family = "full scale of " + use.on[0];  // clipped-resampling has it, too
    for (Number& n : use.numbers) n.start = full, n.lower = 0.5 * full, n.upper = 1.2 * full;
  }
  return uses;
}

void record(const Use& use, const Frame& frame, std::span<double> values) {
  const double full_scale = camera_amounts(use, frame)[0];
  for (double& v : values) v = equation::sensor_saturation(v, full_scale);
}

}  // namespace

const Term& sensor_saturation() {
  static const Term term{
      .mechanism = mechanism::sensor_saturation,
      .reach = Reach::record,
      .order = 100,
      .candidates = candidates,
      .record = record,
      .pointwise = true,
  };
  return term;
}

}  // namespace gonio::relighting::terms
