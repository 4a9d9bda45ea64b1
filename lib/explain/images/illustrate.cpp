// What a person sees first: signed residuals before and after, and masks and boxes where the mismatch is. Whole
// pictures are simulated coarser than the sampled pixels (16 sub-samples, 64 paths), which the noise accounts for.
#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/atomic_file.h"
#include "base/text.h"
#include "explain/images/images_problem.h"
#include "explain/images/pictures.h"
#include "inference/explanation.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "relighting/textures.h"

namespace gonio::explain::images {
namespace {

constexpr double pixels_per_view = 60000;  // larger pictures are thinned out
constexpr double mask_limit = 5;           // standard errors of a window
constexpr std::size_t most_pictures = 4, least_box = 6, most_boxes = 4;

WholeImage whole_image(const Recording& image, const ImageModel& model, std::size_t number, int stride,
                       const SceneState& before, const SceneState& after) {
  WholeImage whole;
  whole.stride = stride;
  whole.width = (image.picture.width + stride - 1) / stride;
  whole.height = (image.picture.height + stride - 1) / stride;
  std::vector<std::uint32_t> all(static_cast<std::size_t>(whole.width) * static_cast<std::size_t>(whole.height));
  for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
  const std::size_t rows = 3 * all.size();
  whole.before.resize(rows), whole.after.resize(rows), whole.sigma.resize(rows), whole.observed.resize(rows);
  whole.counts.resize(all.size());
  model.predict(before, number, all, whole.before);
  model.predict(after, number, all, whole.after);
  model.variance(after, number, all, whole.sigma);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Pixel& pixel = model.cache(image.view).pixels[i];
    const auto place = static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(image.picture.width) +
                       static_cast<std::size_t>(pixel.x);
    whole.counts[i] = image.counts[place];
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t r = 3 * i + c;
      const double noise = noise_sigma(image, whole.after[r], 3 * place + c);
      whole.observed[r] = image.picture.data[3 * place + c];
      whole.sigma[r] = std::sqrt(whole.sigma[r] + noise * noise);
    }
  }
  return whole;
}

int stride_for(const View& view) {
  const double pixels = static_cast<double>(view.model.width_px()) * view.model.height_px();
  return std::max(1, static_cast<int>(std::ceil(std::sqrt(pixels / pixels_per_view))));
}

double rms_of(const WholeImage& image) {
  double sum = 0, n = 0;
  for (std::size_t i = 0; i < image.counts.size(); ++i)
    if (image.counts[i])
      for (std::size_t c = 3 * i; c < 3 * i + 3; ++c) sum += image.observed[c] * image.observed[c], n += 1;
  return std::sqrt(sum / std::max(1.0, n));
}

// The brightest that is to be seen well: one value in two hundred is clipped.
double white_of(const WholeImage& image) {
  std::vector<double> values = image.observed;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(0.995 * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, at);
  return *at > 0 ? *at : 1;
}

// The photograph with the region outlined, the simulation without and with the named physics, the difference without
// and with it, and where it acts. All of one tone.
std::vector<Picture> pictures_of(const std::string& id, const WholeImage& image, const std::vector<Box>& boxes,
                                 bool named) {
  const double white = white_of(image), full = 0.1 * rms_of(image);
  const std::string tone = format("A value of %.3g is shown as white, sRGB curve.", white);
  const std::string scale = format(
      "Red: the recording is brighter; blue: darker. Full colour at %.3g, a tenth of the picture's rms; grey pixels do "
      "not count.",
      full);
  const auto encoded = [](const io::Image& picture) { return io::encode_png(picture); };
  io::Image recording = shown(image.observed, image, white);
  const std::string plain = encoded(recording), believed = encoded(shown(image.before, image, white)),
                    difference = encoded(residual_picture(image, false, full));
  outline(boxes, image, recording);
  std::vector<Picture> all;
  if (named) {
    all.push_back({.title = id,
                   .png = encoded(recording),
                   .caption = boxes.empty() ? tone : "Outlined: where the mismatch is largest. " + tone});
    all.push_back({.title = "simulation as believed",
                   .png = believed,
                   .over_title = "with what was named",
                   .over_png = encoded(shown(image.after, image, white)),
                   .caption = id + ", simulated: drag, or use the arrow keys. " + tone});
    all.push_back({.title = "difference as believed",
                   .png = difference,
                   .over_title = "with what was named",
                   .over_png = encoded(residual_picture(image, true, full)),
                   .caption = id + ", recording less simulation. " + scale});
    return all;
  }
  all.push_back({.title = "recording",
                 .png = plain,
                 .over_title = "simulation as believed",
                 .over_png = believed,
                 .caption = id + ": drag, or use the arrow keys. " + tone});
  io::Image outlined = residual_picture(image, false, full);
  outline(boxes, image, outlined);
  all.push_back({.title = id + ", recording less simulation", .png = encoded(outlined), .caption = scale});
  return all;
}

}  // namespace

Illustration ImagesProblem::illustrate(const Explanation& explanation, const std::filesystem::path& out,
                                       manifest::Document& document) const {
  Illustration result;
  std::vector<ViewCache> caches;
  std::vector<int> strides;
  CacheOptions coarse{.samples = 4, .paths = 64, .seed = cache_options_.seed + 1};
  const Tints tints(*scene_);
  for (const View& view : recordings_.views) {
    strides.push_back(stride_for(view));
    std::vector<std::array<int, 2>> grid;
    for (int y = 0; y < view.model.height_px(); y += strides.back())
      for (int x = 0; x < view.model.width_px(); x += strides.back()) grid.push_back({x, y});
    caches.push_back(build_cache(*caster_, view, layout_.lights, *monomials_, grid, coarse));
    tints.apply(*caster_, view, caches.back());
  }
  ImageModel model(recordings_, layout_, *monomials_, std::move(caches));
  const SceneState before = raw_state(explanation.base_values), after = raw_state(explanation.values);
  Shared shared{shared_.fine, nullptr, nullptr};
  const Setting setting{document, *scene_, *caster_, recordings_, layout_, model, &after, &shared};
  std::vector<Use> uses = model_->uses();
  for (Use& use : uses)
    if (use.term->prepare && !use.neutral(after)) use.prepared = use.term->prepare(setting, use);
  model.take_uses(*model_, std::move(uses));
  std::vector<std::string> worst;  // images that hold most of the excess
  for (const LocatedGroup& group : explanation.groups) {
    const auto g =
        static_cast<std::size_t>(std::ranges::find(observations_.group, group.name) - observations_.group.begin());
    const std::string& id = recordings_.images[groups_[g].image].id;
    if (worst.size() < most_pictures && std::ranges::count(worst, id) == 0) worst.push_back(id);
  }
  std::vector<std::vector<Picture>> pictures(worst.size());
  const bool named = !explanation.named.empty();
  result.seen_at_once = named ? 3 : 2;
  for (std::size_t g = 0; g < recordings_.images.size(); ++g) {
    const Recording& image = recordings_.images[g];
    const WholeImage whole = whole_image(image, model, g, strides[image.view], before, after);
    const auto rank = static_cast<std::size_t>(std::ranges::find(worst, image.id) - worst.begin());
    const bool is_shown = rank < worst.size();
    std::vector<Box> boxes;
    if (explanation.verdict != Verdict::null)
      boxes = boxes_of(mismatch_mask(whole, mask_limit, explanation.smallest_effect), whole, least_box, most_boxes);
    for (Box& box : boxes) box.group = image.id;
    if (is_shown) pictures[rank] = pictures_of(image.id, whole, boxes, named);
    if (explanation.verdict == Verdict::null) continue;
    result.boxes.insert(result.boxes.end(), boxes.begin(), boxes.end());
    const std::vector<double> acts = effect(whole, named);
    if (is_shown)
      pictures[rank].push_back({.title = image.id + (named ? ": where it acts" : ": where the mismatch is"),
                                .png = io::encode_png(effect_picture(acts, whole)),
                                .caption = "Half coloured at three noise widths."});
    if (out.empty()) continue;
    const std::filesystem::path path = out / ("effect-" + image.id + ".exr");
    io::write_picture(path, spread(acts, whole, image.picture.width, image.picture.height));
    result.masks.push_back(manifest::add_file(document, path, "effect-" + image.id));
  }
  for (std::vector<Picture>& of_image : pictures) std::ranges::move(of_image, std::back_inserter(result.pictures));
  return result;
}

}  // namespace gonio::explain::images
