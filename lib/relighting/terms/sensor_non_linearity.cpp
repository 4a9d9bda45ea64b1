// sensor.non-linearity: the quadratic form, stated at the largest value of the pictures; a power law and a tone curve
// need a ramp of exposures (explain/stacks).
#include "render/mechanisms/sensor_non_linearity.h"

#include "relighting/image_model.h"
#include "relighting/observed.h"
#include "relighting/uses.h"

namespace gonio::relighting::terms {
namespace {

std::vector<Use> candidates(const Setting& s) {
  std::vector<Use> uses = camera_uses(s, mechanism::sensor_non_linearity());
  for (Use& use : uses)
    for (std::size_t k = 1; k < use.numbers.size(); ++k) {  // the quadratic alone is sought
      use.numbers[k].start = k == 1 ? largest_value(s.recordings) : use.numbers[k].neutral;
      use.numbers[k].free = false;
    }
  return uses;
}

void record(const Use& use, const Frame& frame, std::span<double> values) {
  const std::span<const double> amounts = camera_amounts(use, frame);
  const render::Response response{.quadratic = amounts[0], .gamma = amounts[2], .reference = amounts[1]};
  for (double& v : values) v = response(v);
}

}  // namespace

const Term& sensor_non_linearity() {
  static const Term term{
      .mechanism = mechanism::sensor_non_linearity,
      .reach = Reach::record,
      .order = 60,
      .candidates = candidates,
      .record = record,
  };
  return term;
}

}  // namespace gonio::relighting::terms
