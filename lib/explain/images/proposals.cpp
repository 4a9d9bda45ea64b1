// Measurements that could be taken next with the same set-up: another exposure, which parts what adds to a reading from
// what adds to the light; the lamps off, which leaves what is there without them. A new exposure is the image's gain
// times a factor; its own gain is free where the image's is.
#include "explain/images/images_problem.h"

namespace gonio::explain::images {
namespace {

struct Change {
  double exposure;  // factor
  bool dark;        // lamps off
};
constexpr Change changes[] = {{4, false}, {0.25, false}, {1, true}};
constexpr std::size_t kinds = std::size(changes);
constexpr std::size_t most_images = 3;  // of different views or lights nothing new is to be learned from more

}  // namespace

std::vector<Proposal> ImagesProblem::proposals() const {
  std::vector<Proposal> all;
  for (std::size_t g = 0; g < std::min(most_images, recordings_.images.size()); ++g) {
    const Recording& image = recordings_.images[g];
    for (const Change& change : changes) {
      manifest::Value setup = manifest::Value::object();
      setup["image"] = image.id;
      if (change.dark) {
        setup["light"] = manifest::Value::array();
        all.push_back({"image " + image.id + " again with the lamps off", setup});
        continue;
      }
      if (image.exposure_s)
        setup["exposure_s"] = *image.exposure_s * change.exposure;
      else
        setup["exposure_scale"] = change.exposure;
      all.push_back(
          {"image " + image.id + " again at " + (change.exposure > 1 ? "four times" : "a quarter of") + " its exposure",
           setup});
    }
  }
  return all;
}

ProposedRows ImagesProblem::propose(std::span<const double> values, std::size_t proposal) const {
  const std::size_t g = proposal / kinds;
  const Change& change = changes[proposal % kinds];
  SceneState raw = raw_state(values);
  raw.gain[g] *= change.exposure;
  if (change.dark)
    for (LightState& light : raw.lights) light.intensity = {};
  ProposedRows rows;
  rows.prediction.resize(3 * picked_[g].size());
  model_->predict(raw, g, picked_[g], rows.prediction);
  for (const double v : rows.prediction) rows.sigma.push_back(noise_sigma(recordings_.images[g], v));
  if (recordings_.images[g].gain.free) {
    SceneState above = raw;
    above.gain[g] *= 1 + 1e-4;
    std::vector<double> there(rows.prediction.size());
    model_->predict(above, g, picked_[g], there);
    for (std::size_t i = 0; i < there.size(); ++i) there[i] = (there[i] - rows.prediction[i]) * 1e4;
    rows.nuisance.push_back(std::move(there));
  }
  return rows;
}

}  // namespace gonio::explain::images
