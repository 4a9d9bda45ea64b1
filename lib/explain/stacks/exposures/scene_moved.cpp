// scene.moved in a stack of exposures: found before anything is fitted (moved.h), and its readings are left out. A box
// and a number for each picture, which no fit moves.
#include "explain/stacks/exposure_binding.h"

namespace gonio::mechanism {
const Mechanism& scene_moved();
}

namespace gonio::explain::stacks::exposures {
namespace {

void enter_regions(StackEntry& entry, const ExposureFacts& facts) {
  std::vector<std::string> pictures;
  for (const MovedRegion& region : facts.moved) {
    pictures.push_back(entry.stack.images[region.image].id);
    entry.add_for(pictures.back(), "relative", 0.1);
    for (const char* side : {"left_px", "top_px", "width_px", "height_px"}) entry.add_for(pictures.back(), side, 1);
  }
  if (!pictures.empty()) entry.propose_all(std::move(pictures));
}

}  // namespace

const ExposureBinding& scene_moved() {
  static const ExposureBinding binding{.mechanism = mechanism::scene_moved,
                                       .order = 70,
                                       .enter = enter_regions,
                                       .set = [](std::span<const double>, const Stack&, ReadingChain&) {}};
  return binding;
}

}  // namespace gonio::explain::stacks::exposures
