// sensor.saturation: where several readings are as large as the largest one, that may be full scale.
//
// What is full may be the wells, before noise is added, or the converter, which cuts that off, or both at once.
// Readings that are the largest one to the bit were cut off last: a heap of them tells of the converter. Where the
// wells were full as well, about as many readings are heaped up below it by noise alone. How much of the noise comes
// after the wells is not asked: all of it.
#include "render/mechanisms/sensor_saturation.h"

#include <algorithm>

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

struct Cut final : Prepared {
  bool light = true;   // wells are full before noise is added
  bool noise = false;  // noise is cut off
};

std::shared_ptr<const Prepared> prepare(const Setting& s, const Use&) {
  const double full = largest_value(s.recordings);
  double at = 0, heaped = 0;  // readings there, and below it within two widths of noise beside what light alone brings
  for (const Recording& image : s.recordings.images) {
    const double sigma = noise_sigma(image, full);
    for (std::size_t i = 0; i < image.picture.data.size(); ++i) {
      if (!image.counts[i / 3]) continue;
      const double reading = image.picture.data[i], widths = (full - reading) / sigma;
      if (reading == full)
        ++at;
      else if (widths <= 2)
        ++heaped;
      else if (widths > 4 && widths <= 6)
        --heaped;
    }
  }
  auto cut = std::make_shared<Cut>();
  cut->noise = at >= least_readings;
  cut->light = !cut->noise || heaped > 0.25 * at;
  return cut;
}

void record(const Use& use, const Frame& frame, std::span<double> values) {
  const double full_scale = camera_amounts(use, frame)[0];
  const Cut& cut = static_cast<const Cut&>(*use.prepared);
  for (double& v : values) {
    if (cut.light) v = equation::sensor_saturation(v, full_scale);
    if (!cut.noise) continue;
    const double sigma = noise_sigma(frame.image, equation::sensor_saturation(v, full_scale));
    v = equation::sensor_saturation_of_noise(v, full_scale, sigma);
  }
}

}  // namespace

const Term& sensor_saturation() {
  static const Term term{
      .mechanism = mechanism::sensor_saturation,
      .reach = Reach::record,
      .order = 100,
      .candidates = candidates,
      .prepare = prepare,
      .record = record,
      .pointwise = true,
  };
  return term;
}

}  // namespace gonio::relighting::terms
