// sensor.black-offset in a stack of lights.
#include "render/mechanisms/sensor_black_offset.h"

#include "explain/stacks/light_binding.h"

namespace gonio::explain::stacks::lights {
namespace {

void enter_offset(StackEntry& entry) {
  const double scale = entry.stack.full_scale;
  Parameter& offset = entry.add("offset", 0.05 * scale);
  offset.lower = -scale, offset.upper = scale, offset.start = 0.005 * scale;
  entry.propose_all();
}

}  // namespace

const LightBinding& sensor_black_offset() {
  static const LightBinding binding{
      .mechanism = mechanism::sensor_black_offset,
      .order = 70,
      .written = Written::with_response,
      .enter = enter_offset,
      .set = [](std::span<const double> p, const Stack&, PatchModel& model) { model.offset = p[0]; }};
  return binding;
}

}  // namespace gonio::explain::stacks::lights
