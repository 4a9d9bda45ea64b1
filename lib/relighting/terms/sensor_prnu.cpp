// sensor.prnu: which pixels are the sensitive ones is read from other views of the same camera (fixed_pattern.h), so
// that a picture is never held against its own noise. Of a deviation d that they show, with variance e^2 by their
// noise, the best linear guess of the pixel's n is
//   n = d s / (9/8 s^2 + e^2),   s such that d^2 / (9/8 s^2 + e^2) has the median of chi-square, 0.455
// (Wiener 1949; the neighbours that d refers to have a pattern, too).
// With one view, or where nothing moves over the pixels, nothing is known of them: the term then does nothing.
#include "render/mechanisms/sensor_prnu.h"

#include <algorithm>
#include <cmath>

#include "relighting/fixed_pattern.h"
#include "relighting/image_model.h"
#include "relighting/observed.h"
#include "relighting/uses.h"
#include "stats/intervals.h"

namespace gonio::relighting::terms {
namespace {

constexpr double with_neighbours = 1.125;   // variance of a deviation over that of a pixel
constexpr double least = 1e-3, most = 0.3;  // of the size that a pattern is searched at

struct Pattern final : Prepared {
  std::vector<std::vector<float>> normal;  // [view][pixel and colour]: n; NaN where it is unknown; empty: all is
};

// s, by halving its logarithm's range.
double size_of(const FixedPattern::OfView& view) {
  std::vector<double> ratios;
  const auto median_at = [&](double size) {
    ratios.clear();
    for (std::size_t i = 0; i < view.deviation.size(); ++i)
      if (const double d = view.deviation[i]; !std::isnan(d))
        ratios.push_back(d * d / (with_neighbours * size * size + view.variance[i]));
    return stats::median(ratios);
  };
  double low = least, high = most;
  for (int i = 0; i < 12; ++i) {
    const double middle = std::sqrt(low * high);
    (median_at(middle) > 0.4549 ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

std::shared_ptr<const Prepared> prepare(const Setting& s, const Use&) {
  auto result = std::make_shared<Pattern>();
  for (const FixedPattern::OfView& view : fixed_pattern(s.recordings).views) {
    std::vector<float> normal;
    const double size = view.any ? size_of(view) : 0;
    for (std::size_t i = 0; view.any && i < view.deviation.size(); ++i)
      normal.push_back(
          static_cast<float>(view.deviation[i] * size / (with_neighbours * size * size + view.variance[i])));
    result->normal.push_back(std::move(normal));
  }
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
