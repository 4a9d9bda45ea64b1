// optics.veiling-glare: the veil is a share of the recorded picture's mean, which holds the veil itself: the picture
// without it has 1 / (1 + share) of that mean.
#include "render/mechanisms/optics_veiling_glare.h"

#include "relighting/image_model.h"
#include "relighting/observed.h"
#include "relighting/uses.h"

namespace gonio::relighting::terms {
namespace {

std::vector<Use> candidates(const Setting& s) {
  return camera_uses(s, mechanism::optics_veiling_glare());
}

void record(const Use& use, const Frame& frame, std::span<double> values) {
  const double share = camera_amounts(use, frame)[0];
  const Rgb mean = mean_of(frame.image) * (1 / (1 + share));
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = equation::optics_veiling_glare(values[i], share, mean[static_cast<int>(i % 3)]);
}

}  // namespace

const Term& optics_veiling_glare() {
  static const Term term{
      .mechanism = mechanism::optics_veiling_glare,
      .reach = Reach::record,
      .order = 10,
      .candidates = candidates,
      .record = record,
  };
  return term;
}

}  // namespace gonio::relighting::terms
