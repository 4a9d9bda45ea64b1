#include "relighting/observed.h"

#include <algorithm>
#include <cmath>

#include "relighting/image_model.h"
#include "relighting/uses.h"

namespace gonio::relighting {

Rgb mean_of(const Recording& image) {
  return image.mean;
}

Rgb opposite(const Recording& image, const Pixel& pixel) {
  const int x = image.picture.width - 1 - pixel.x, y = image.picture.height - 1 - pixel.y;
  const Rgb value{image.picture.at(x, y, 0), image.picture.at(x, y, 1), image.picture.at(x, y, 2)};
  return std::isfinite(value.x + value.y + value.z) ? value : Rgb{};
}

double largest_value(const Recordings& recordings) {
  float largest = 0;
  for (const Recording& image : recordings.images)
    for (std::size_t i = 0; i < image.picture.data.size(); ++i)
      if (image.counts[i / 3]) largest = std::max(largest, image.picture.data[i]);
  return largest;
}

std::size_t readings_near(const Recordings& recordings, double value) {
  std::size_t count = 0;
  for (const Recording& image : recordings.images)
    for (std::size_t i = 0; i < image.picture.data.size(); ++i)
      count += image.counts[i / 3] && image.picture.data[i] >= 0.99 * value;
  return count;
}

std::vector<Use> camera_uses(const Setting& setting, const mechanism::Mechanism& mechanism) {
  std::vector<std::string> cameras;
  for (const View& view : setting.recordings.views)
    if (std::find(cameras.begin(), cameras.end(), view.camera) == cameras.end()) cameras.push_back(view.camera);
  std::vector<Use> uses;
  for (const std::string& camera : cameras)
    if (!switched_on(setting.document, mechanism.id, camera))
      uses.push_back(target_use(mechanism, {camera}, {0}, false));
  return uses;
}

std::optional<std::size_t> camera_target(const Use& use, const Recordings& recordings, const Recording& image) {
  if (use.on.empty()) return 0;
  auto found = std::ranges::find(use.on, image.id);
  if (found == use.on.end()) found = std::ranges::find(use.on, recordings.views[image.view].camera);
  if (found == use.on.end()) return std::nullopt;
  return static_cast<std::size_t>(found - use.on.begin());
}

std::span<const double> camera_amounts(const Use& use, const Frame& frame) {
  const std::optional<std::size_t> target = camera_target(use, frame.model.recordings(), frame.image);
  return target ? use.amounts(frame.state, *target) : use.neutral_amounts();
}

}  // namespace gonio::relighting
