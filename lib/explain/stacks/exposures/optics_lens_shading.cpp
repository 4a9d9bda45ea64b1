// optics.lens-shading in a stack of pictures taken through several apertures. How much light each passes at the centre
// is never quite what its f-number says: a number for each belongs to the base model.
#include "scene/mechanisms/optics_lens_shading.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "explain/stacks/aperture_shading.h"
#include "explain/stacks/exposure_binding.h"
#include "inference/wording.h"

namespace gonio::explain::stacks::exposures {
namespace {

std::set<double> apertures_of(const Stack& stack) {
  std::set<double> all;
  for (const StackImage& image : stack.images) all.insert(image.f_number);
  return all;
}

// The widest passes what it says: radiances are known up to a factor.
void enter_shading(StackEntry& entry, const ExposureFacts&) {
  const std::set<double> apertures = apertures_of(entry.stack);
  if (apertures.size() < 2) return;
  const ApertureShading like = aperture_shading(entry.stack);
  Parameter& shift = entry.add("shift", 0.1);
  shift.start = std::max(like.shift, 0.1);
  Parameter& rim = entry.add("rim_f_number", 0.1 * *apertures.begin());
  rim.start = like.rim_f_number;
  if (!entry.is_stated()) rim.neutral = rim.start;
  entry.propose_all({}, true);
  for (auto f = std::next(apertures.begin()); f != apertures.end(); ++f) {
    Parameter light;
    light.name = "light of f/" + inference::printed(*f);
    light.unit = "1";
    light.size = 0.1;
    light.lower = -0.9, light.upper = 9;
    entry.add_base(std::move(light));
  }
}

void set_shading(std::span<const double> p, const Stack& stack, ReadingChain& chain) {
  if (p.empty()) return;
  chain.rim_shift = p[0], chain.rim_f_number = p[1];
  const std::set<double> apertures = apertures_of(stack);
  for (const StackImage& image : stack.images) {
    const auto place = std::distance(apertures.begin(), apertures.find(image.f_number));
    chain.passes.push_back(place == 0 ? 1 : 1 + p[1 + static_cast<std::size_t>(place)]);
  }
}

}  // namespace

const ExposureBinding& optics_lens_shading() {
  static const ExposureBinding binding{
      .mechanism = mechanism::optics_lens_shading, .order = 70, .enter = enter_shading, .set = set_shading};
  return binding;
}

}  // namespace gonio::explain::stacks::exposures
