#include "metric/exposure.h"

#include <cmath>

#include "base/error.h"
#include "metric/blocks.h"

namespace gonio::metric {
namespace {

struct Line {
  double score = 0, slope = 0;  // sum of w x (y - c x) and of w x x
};

// One sample's part at scale c: x the rendering, y the photograph. `known`: weigh by variance, and move x to its
// expected place.
Line sample(const Overlay& o, std::size_t i, double c, bool known) {
  const double x = o.rendering[i], y = o.photograph[i];
  if (!known) return {x * (y - c * x), x * x};
  const double total = o.variance(i, c);
  if (!(total > 0)) return {};
  const double of_x = o.rendering_variance.empty() ? 0.0 : double{o.rendering_variance[i]};
  const double of_y = total - c * c * of_x;
  const double adjusted = (x * of_y + c * y * of_x) / total;
  return {adjusted * (y - c * x) / total, adjusted * x / total};
}

template <class Visit>
void for_each_sample(const Overlay& o, const Visit& visit) {
  const std::size_t channels = o.channels.size();
  for (std::size_t p = 0; p < o.counts.size(); ++p) {
    if (!o.counts[p] || (!o.clipped.empty() && o.clipped[p])) continue;
    for (std::size_t c = 0; c < channels; ++c) visit(p, p * channels + c);
  }
}

Line sum(std::span<const Overlay* const> overlays, double c, bool known) {
  Line total;
  for (const Overlay* o : overlays)
    for_each_sample(*o, [&](std::size_t, std::size_t i) {
      const Line part = sample(*o, i, c, known);
      total.score += part.score;
      total.slope += part.slope;
    });
  return total;
}

double sandwich_sigma(std::span<const Overlay* const> overlays, double c, double slope, bool known) {
  double squares = 0;
  std::size_t used = 0;
  for (const Overlay* o : overlays) {
    const Blocks blocks(o->width, o->height);
    std::vector<double> score(blocks.count());
    std::vector<char> touched(blocks.count());
    for_each_sample(*o, [&](std::size_t p, std::size_t i) {
      const std::size_t b = blocks.of_pixel(p, o->width);
      score[b] += sample(*o, i, c, known).score;
      touched[b] = 1;
    });
    for (std::size_t b = 0; b < score.size(); ++b) {
      squares += score[b] * score[b];
      used += static_cast<std::size_t>(touched[b]);
    }
  }
  const double small_sample = used > 1 ? static_cast<double>(used) / static_cast<double>(used - 1) : 1.0;
  return std::sqrt(small_sample * squares) / slope;
}

}  // namespace

Estimate fit_exposure(std::span<const Overlay* const> overlays) {
  bool known = true;
  for (const Overlay* o : overlays) known = known && o->knows_variance();
  const Line plain = sum(overlays, 0, false);
  const std::string name = overlays.size() == 1 ? overlays[0]->name : "the renderings";
  if (!(plain.slope > 0))
    throw Error(Exit::data, name, "is black wherever the photograph counts: no exposure scale fits",
                "is the light on?");
  double c = plain.score / plain.slope, slope = plain.slope;
  if (known) {
    for (int iteration = 0; iteration < 100; ++iteration) {
      const Line at = sum(overlays, c, true);
      if (!(at.slope > 0))
        throw Error(Exit::data, name, "has a variance that weighs no sample", "check noise and variance");
      const double step = at.score / at.slope;
      slope = at.slope;
      c += step;
      if (std::abs(step) < 1e-12 * std::abs(c)) break;
    }
  }
  if (!(c > 0))
    throw Error(Exit::data, name,
                "fits the photograph only with the exposure scale " + std::to_string(c) + ", which is not positive",
                "is this the rendering of that photograph?");
  return {c, sandwich_sigma(overlays, c, slope, known)};
}

}  // namespace gonio::metric
