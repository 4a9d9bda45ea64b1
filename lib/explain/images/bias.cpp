// What the fast model gets wrong at a fit: pixels by the path tracer less the same by the cache, sent on through the
// sensor chain. Light between glossy surfaces, which the cache knows at one angle and one roughness, is the largest
// part of it; the cache's own Monte Carlo error is another, and falls out.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "explain/images/images_problem.h"
#include "explain/images/traced.h"
#include "inference/explanation.h"
#include "manifest/document.h"
#include "relighting/uses.h"
#include "scene/mechanisms.h"

namespace gonio::explain::images {
namespace {

constexpr double paths = 2.4e6;  // of one look, over all pictures: two seconds or so
constexpr std::uint64_t bias_seed = 61;

// The state without what happens behind the lens.
SceneState before_the_sensor(SceneState raw, std::span<const Use> uses) {
  for (const Use& use : uses) {
    if (use.term->reach != Reach::record) continue;
    std::vector<double>& amounts = raw.amounts[use.place];
    const std::span<const double> neutral = use.neutral_amounts();
    for (std::size_t k = 0; k < amounts.size(); ++k) amounts[k] = neutral[k % neutral.size()];
  }
  return raw;
}

}  // namespace

std::optional<inference::Bias> ImagesProblem::bias(std::span<const double> values,
                                                   std::span<const std::size_t> candidates) const {
  for (const Use& use : model_->uses())
    if (!use.neutral(raw_state(values)) && scene::beyond_rendering(*use.mechanism)) return std::nullopt;
  Explanation fitted;
  fitted.values.assign(values.begin(), values.end());
  fitted.sigma.assign(values.size(), 0.0);
  fitted.named.assign(candidates.begin(), candidates.end());
  manifest::Document upgraded = *document_;
  write_back(bindings_, model_->uses(), fitted, upgraded);
  std::vector<TracedPixels> pictures(recordings_.images.size());
  for (std::size_t g = 0; g < pictures.size(); ++g) {
    pictures[g].entry = recordings_.images[g].entry;
    for (const std::uint32_t p : picked_[g]) {
      const Pixel& pixel = model_->cache(recordings_.images[g].view).pixels[p];
      pictures[g].at.push_back({pixel.x, pixel.y});
    }
  }
  if (!trace_pixels(upgraded, pictures, paths, bias_seed)) return std::nullopt;
  const SceneState raw = raw_state(values), plain = before_the_sensor(raw, model_->uses());
  inference::Bias bias;
  for (std::size_t g = 0; g < pictures.size(); ++g) {
    const std::vector<std::uint32_t>& picked = picked_[g];
    std::vector<double> fast(3 * picked.size());
    model_->predict(plain, g, picked, fast);
    std::vector<double> exact = pictures[g].radiance, above = exact;
    for (std::size_t i = 0; i < above.size(); ++i) above[i] += std::sqrt(pictures[g].variance[i]);
    const SceneState now = model_->edited(raw, g);
    for (std::vector<double>* each : {&fast, &exact, &above}) model_->record_terms(now, g, picked, *each);
    for (std::size_t i = 0; i < exact.size(); ++i) {
      bias.value.push_back(exact[i] - fast[i]);
      bias.variance.push_back((above[i] - exact[i]) * (above[i] - exact[i]));
    }
  }
  return bias;
}

}  // namespace gonio::explain::images
