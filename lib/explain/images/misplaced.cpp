// See misplaced.h.
#include "explain/images/misplaced.h"

#include <algorithm>

#include "metric/mix_ups.h"

namespace gonio::explain::images {
namespace {

// The surface that most of a pixel shows; the sky is a kind of its own.
std::uint32_t shown_by(const ViewCache& cache, const Pixel& pixel, std::uint32_t sky) {
  float most = pixel.sky;
  std::uint32_t surface = sky;
  for (std::size_t f = pixel.first_facet; f < pixel.first_facet + pixel.facets; ++f)
    if (cache.facets[f].weight > most) most = cache.facets[f].weight, surface = cache.facets[f].surface;
  return surface;
}

metric::PictureOfSet picture_of(const Recordings& recordings, const ImageModel& model, std::size_t number,
                                const std::vector<std::uint32_t>& picked) {
  const Recording& image = recordings.images[number];
  const ViewCache& cache = model.cache(image.view);
  metric::PictureOfSet picture{.name = "`" + image.id + "`",
                               .width = image.picture.width,
                               .height = image.picture.height,
                               .channels = 3,
                               .recording = image.picture.data,
                               .counts = image.counts,
                               .noise = image.noise,
                               .at = {},
                               .label = {},
                               .predicted = std::vector<double>(3 * picked.size()),
                               .view = image.view,
                               .lights = {}};
  model.predict(model.layout().start, number, picked, picture.predicted);
  const auto sky = static_cast<std::uint32_t>(model.layout().start.surfaces.size());
  for (const std::uint32_t p : picked) {
    const Pixel& pixel = cache.pixels[p];
    picture.at.push_back(static_cast<std::uint32_t>(pixel.y * picture.width + pixel.x));
    picture.label.push_back(shown_by(cache, pixel, sky));
  }
  for (const std::size_t light : image.lights)
    picture.lights += (picture.lights.empty() ? "`" : " and `") + recordings.lights[light] + "`";
  return picture;
}

}  // namespace

Misplaced misplaced_files(const Recordings& recordings, const ImageModel& model,
                          const std::vector<std::vector<std::uint32_t>>& picked) {
  std::vector<metric::PictureOfSet> set;
  for (std::size_t i = 0; i < recordings.images.size(); ++i) set.push_back(picture_of(recordings, model, i, picked[i]));
  const std::vector<metric::MixUp> found = metric::mix_ups(set);
  Misplaced misplaced;
  for (const metric::MixUp& m : found)
    misplaced.files.push_back({recordings.images[m.image].id, recordings.images[m.shows].id, m.own, m.other});
  for (const std::string& sentence : metric::mix_up_sentences(set, found))
    misplaced.sentence += (misplaced.sentence.empty() ? "" : " ") + sentence;
  return misplaced;
}

}  // namespace gonio::explain::images
