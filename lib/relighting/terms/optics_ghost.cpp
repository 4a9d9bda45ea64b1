// optics.ghost: the recording itself stands for the source of the ghost; what is wrong with that is of second order
// in the share.
#include "render/mechanisms/optics_ghost.h"

#include "relighting/image_model.h"
#include "relighting/observed.h"
#include "relighting/uses.h"

namespace gonio::relighting::terms {
namespace {

std::vector<Use> candidates(const Setting& s) {
  return camera_uses(s, mechanism::optics_ghost());
}

void record(const Use& use, const Frame& frame, std::span<double> values) {
  const double share = camera_amounts(use, frame)[0];
  for (std::size_t i = 0; i < frame.picked.size(); ++i) {
    const Rgb mirrored = opposite(frame.image, frame.cache.pixels[frame.picked[i]]);
    for (std::size_t c = 0; c < 3; ++c) {
      double& v = values[3 * i + c];
      v = equation::optics_ghost(v, share, mirrored[static_cast<int>(c)] - share * v);
    }
  }
}

}  // namespace

const Term& optics_ghost() {
  static const Term term{
      .mechanism = mechanism::optics_ghost,
      .reach = Reach::record,
      .order = 5,
      .candidates = candidates,
      .record = record,
  };
  return term;
}

}  // namespace gonio::relighting::terms
