// optics.veiling-glare in a stack of exposures.
#include "render/mechanisms/optics_veiling_glare.h"

#include "explain/stacks/exposure_binding.h"

namespace gonio::explain::stacks::exposures {
namespace {

void enter_glare(StackEntry& entry, const ExposureFacts&) {
  entry.add("share", 0.1);
  entry.propose_all();
}

}  // namespace

const ExposureBinding& optics_veiling_glare() {
  static const ExposureBinding binding{
      .mechanism = mechanism::optics_veiling_glare,
      .order = 50,
      .enter = enter_glare,
      .set = [](std::span<const double> p, const Stack&, ReadingChain& chain) { chain.glare_share = p[0]; }};
  return binding;
}

}  // namespace gonio::explain::stacks::exposures
