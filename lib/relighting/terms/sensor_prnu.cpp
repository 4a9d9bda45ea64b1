// sensor.prnu: which pixels are the sensitive ones is read from other views of the same camera (fixed_pattern.h), so
// that a picture is never held against its own noise. With one view, or where nothing moves over the pixels, nothing is
// known of them: the term then does nothing.
#include "render/mechanisms/sensor_prnu.h"

#include <cmath>

#include "relighting/fixed_pattern.h"
#include "relighting/image_model.h"
#include "relighting/observed.h"
#include "relighting/uses.h"

namespace gonio::relighting::terms {
namespace {

struct Pattern final : Prepared {
  std::vector<std::vector<float>> normal;  // [view][pixel and colour]: n; NaN where it is unknown; empty: all is
};

std::shared_ptr<const Prepared> prepare(const Setting& s, const Use&) {
  auto result = std::make_shared<Pattern>();
  for (FixedPattern::OfView& view : fixed_pattern(s.recordings).views)
    result->normal.push_back(view.any ? std::move(view.normal) : std::vector<float>{});
  return result;
}

std::vector<Use> candidates(const Setting& s) {
  return camera_uses(s, mechanism::sensor_prnu());
}

void record(const Use& use, const Frame& frame, std::span<double> values) {
  const double sigma = camera_amounts(use, frame)[0];
  const std::vector<float>& normal = static_cast<const Pattern&>(*use.prepared).normal[frame.image.view];
  if (sigma == 0 || normal.empty()) return;
  const auto width = static_cast<std::size_t>(frame.image.picture.width);
  for (std::size_t i = 0; i < frame.picked.size(); ++i) {
    const Pixel& pixel = frame.cache.pixels[frame.picked[i]];
    const std::size_t place = 3 * (static_cast<std::size_t>(pixel.y) * width + static_cast<std::size_t>(pixel.x));
    for (std::size_t c = 0; c < 3; ++c)
      if (const double n = normal[place + c]; !std::isnan(n))
        values[3 * i + c] = equation::sensor_prnu(values[3 * i + c], sigma, n);
  }
}

}  // namespace

const Term& sensor_prnu() {
  static const Term term{
      .mechanism = mechanism::sensor_prnu,
      .reach = Reach::record,
      .order = 40,
      .candidates = candidates,
      .prepare = prepare,
      .record = record,
      .pointwise = true,
      .share_of_readings = 0,
  };
  return term;
}

}  // namespace gonio::relighting::terms
