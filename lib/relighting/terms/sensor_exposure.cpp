// sensor.exposure: one number for each picture. Asked of the one or two pictures whose brightness stands out most, and
// of all but the one that stands out least, by which the others are measured: the lamps' intensities are free.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "relighting/image_model.h"
#include "relighting/uses.h"
#include "stats/intervals.h"

namespace gonio::mechanism {
const Mechanism& sensor_exposure();
}

namespace gonio::relighting::terms {
namespace {

constexpr std::size_t least_pictures = 3;  // of which one can stand out

// Logarithm of a picture's brightness over the prediction, less the median of the pictures that the same lamps light.
std::vector<double> standing_out(const Setting& s) {
  const std::vector<Recording>& images = s.recordings.images;
  std::vector<double> level;
  for (std::size_t g = 0; g < images.size(); ++g) {
    const ViewCache& cache = s.model.cache(images[g].view);
    std::vector<std::uint32_t> picked(cache.pixels.size());
    std::iota(picked.begin(), picked.end(), 0u);
    std::vector<double> predicted(3 * picked.size());
    s.model.predict(s.model.layout().start, g, picked, predicted);
    double observed = 0, expected = 0;
    for (std::size_t i = 0; i < picked.size(); ++i) {
      const Pixel& pixel = cache.pixels[i];
      const auto place = static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(images[g].picture.width) +
                         static_cast<std::size_t>(pixel.x);
      if (!images[g].counts[place]) continue;
      for (int c = 0; c < 3; ++c) {
        observed += images[g].picture.at(pixel.x, pixel.y, c);
        expected += predicted[3 * i + static_cast<std::size_t>(c)];
      }
    }
    level.push_back(observed > 0 && expected > 0 ? std::log(observed / expected) : 0);
  }
  std::vector<double> out;
  for (std::size_t g = 0; g < images.size(); ++g) {
    std::vector<double> alike;
    for (std::size_t other = 0; other < images.size(); ++other)
      if (images[other].lights == images[g].lights) alike.push_back(level[other]);
    out.push_back(level[g] - stats::median(alike.size() < 3 ? level : alike));
  }
  return out;
}

Use of_pictures(const Setting& s, std::vector<std::size_t> pictures, const std::vector<double>& out) {
  std::sort(pictures.begin(), pictures.end());
  std::vector<std::string> names;
  for (const std::size_t g : pictures) names.push_back(s.recordings.images[g].id);
  Use use = target_use(mechanism::sensor_exposure(), names, pictures, false);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    Number& n = use.numbers[i];
    const double start = std::clamp(std::expm1(out[pictures[i]]), 0.5 * n.lower, 0.5 * n.upper);
    n.start = std::abs(start) > 1e-3 ? start : n.start;
    n.groups = {pictures[i]};
  }
  use.family = use.mechanism->id;
  return use;
}

// Free gains say what this would.
bool gains_are_free(const Setting& s) {
  return std::ranges::any_of(s.recordings.images, [](const Recording& image) { return image.gain.free; });
}

std::vector<Use> candidates(const Setting& s) {
  const std::size_t count = s.recordings.images.size();
  if (count < least_pictures || gains_are_free(s) || switched_on(s.document, mechanism::sensor_exposure().id))
    return {};
  const std::vector<double> out = standing_out(s);
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return std::abs(out[a]) > std::abs(out[b]); });
  std::vector<Use> uses{of_pictures(s, {order[0]}, out)};
  if (count > least_pictures) uses.push_back(of_pictures(s, {order[0], order[1]}, out));
  if (count > least_pictures + 1) uses.push_back(of_pictures(s, {order.begin(), order.end() - 1}, out));
  return uses;
}

void edit(const Use& use, std::size_t image, const SceneLayout&, const Recordings&, SceneState& state) {
  const auto found = std::ranges::find(use.targets, image);
  if (found != use.targets.end())
    state.gain[image] *= 1 + use.amounts(state, static_cast<std::size_t>(found - use.targets.begin()))[0];
}

}  // namespace

const Term& sensor_exposure() {
  static const Term term{
      .mechanism = mechanism::sensor_exposure,
      .reach = Reach::compose,
      .candidates = candidates,
      .edit = edit,
  };
  return term;
}

}  // namespace gonio::relighting::terms
