// sensor.crosstalk: bands of one pixel mixed.
#include "render/mechanisms/sensor_crosstalk.h"

#include "relighting/image_model.h"
#include "relighting/observed.h"
#include "relighting/uses.h"

namespace gonio::relighting::terms {
namespace {

std::vector<Use> candidates(const Setting& s) {
  return camera_uses(s, mechanism::sensor_crosstalk());
}

void record(const Use& use, const Frame& frame, std::span<double> values) {
  const double share = camera_amounts(use, frame)[0];
  for (std::size_t i = 0; i + 2 < values.size(); i += 3) {
    const double sum = values[i] + values[i + 1] + values[i + 2];
    for (std::size_t c = 0; c < 3; ++c) values[i + c] = equation::sensor_crosstalk(values[i + c], share, sum);
  }
}

}  // namespace

const Term& sensor_crosstalk() {
  static const Term term{
      .mechanism = mechanism::sensor_crosstalk,
      .reach = Reach::record,
      .order = 20,
      .candidates = candidates,
      .record = record,
  };
  return term;
}

}  // namespace gonio::relighting::terms
