// light.spectrum: red and blue against green, by the time of each picture.
#include "light/mechanisms/light_spectrum.h"

#include "relighting/uses.h"

namespace gonio::relighting::terms {
namespace {

std::vector<Use> candidates(const Setting& s) {
  if (!(s.recordings.last_time_s > s.recordings.first_time_s) ||
      switched_on(s.document, mechanism::light_spectrum().id))
    return {};
  return {scene_use(mechanism::light_spectrum())};
}

void edit(const Use& use, std::size_t image, const SceneLayout&, const Recordings& r, SceneState& state) {
  const std::span<const double> shares = use.amounts(state);
  if (!r.images[image].time_s || !(r.last_time_s > r.first_time_s)) return;
  const double along = (*r.images[image].time_s - r.first_time_s) / (r.last_time_s - r.first_time_s);
  state.gain[image] *= Rgb{equation::light_spectrum(shares[0], along), 1, equation::light_spectrum(shares[1], along)};
}

}  // namespace

const Term& light_spectrum() {
  static const Term term{
      .mechanism = mechanism::light_spectrum,
      .reach = Reach::compose,
      .candidates = candidates,
      .edit = edit,
  };
  return term;
}

}  // namespace gonio::relighting::terms
