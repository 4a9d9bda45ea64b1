// See raw_document.h.
#include "photograph/raw_document.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/progress.h"
#include "base/text.h"
#include "io/codes.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "photograph/developed.h"
#include "photograph/response.h"

namespace gonio::photograph {
namespace {

constexpr double same_gain = 1e-6;  // of it
constexpr double same_code = 0.01;
constexpr double straight = 1e-5;  // of full scale
using Steps = std::vector<manifest::DevelopedStep>;

Steps steps_of(const RawRecipe& recipe, const DevelopedView& d) {
  namespace step = manifest::develop_step;
  const auto count = [](std::size_t frames) { return static_cast<std::int64_t>(frames); };
  Steps steps;
  steps.push_back({step::black});
  if (recipe.dark) steps.push_back({step::dark, {}, count(recipe.dark->frames)});
  if (recipe.dark || recipe.flat) steps.push_back({step::defects});
  const bool refined = std::ranges::any_of(d.merged.exposures_sigma, [](double sigma) { return sigma > 0; });
  if (refined) steps.push_back({step::exposure_times});
  steps.push_back({step::merge, {}, count(d.stated_s.size()), d.merged.exposures_s});
  if (refined) steps.back().sigma = {{"exposures_s", d.merged.exposures_sigma}};
  if (recipe.flat) steps.push_back({step::flat, {}, count(recipe.flat->frames)});
  if (d.picture.channel("Y") < 0)
    steps.push_back({step::demosaic, demosaicing_names[static_cast<std::size_t>(recipe.demosaicing)]});
  return steps;
}

std::string words_of(const RawView& view, const DevelopedView& d) {
  std::string text =
      view.name + ": " + (view.frames.size() == 1 ? "one exposure" : format("%zu exposures", view.frames.size()));
  if (view.frames.size() > 1) {
    double most = 0;
    std::size_t off = 0;
    for (std::size_t k = 0; k < view.frames.size(); ++k) {
      if (d.merged.exposures_sigma[k] == 0) continue;
      const double change = d.merged.exposures_s[k] / d.stated_s[k] - 1;
      if (std::abs(change) > std::abs(most)) most = change, off = k;
    }
    if (most != 0)
      text += format("; the shutter farthest from its time: %g s, %+.2f(%.0f) %%", d.stated_s[off], 100 * most,
                     1e4 * d.merged.exposures_sigma[off] / d.stated_s[off]);
    text += format("; chi-square per degree of freedom %.3f", d.merged.chi_square_per_freedom);
  }
  if (d.noise_from_exposures)
    text += format("; %.3g electrons per code, read noise %.3g codes", d.noise.gain, d.noise.read);
  for (const auto& [share, what] :
       {std::pair{d.share_too_bright, "too bright"}, {d.share_moved, "moved"}, {d.share_unusable, "unusable"}})
    if (share > 0) text += format("; %.2g %% %s", 100 * share, what);
  return text;
}

// From a scene's radiance to codes per second, where every image of the view says what it is for its own codes.
std::optional<manifest::Parameter> gain_of_view(const manifest::Document& document,
                                                const std::vector<std::size_t>& images) {
  std::optional<manifest::Parameter> gain;
  for (const std::size_t i : images) {
    const manifest::ImageEntry& image = document.images[i];
    if (!image.gain || !image.exposure_s) return std::nullopt;
    const double per_second =
        image.gain->scalar() * full_code_of(manifest::picture_path(document, i)) / *image.exposure_s;
    if (!gain) gain = image.gain, gain->value = {per_second};
    if (std::abs(per_second - gain->scalar()) > same_gain * gain->scalar()) return std::nullopt;
  }
  return gain;
}

// The code without light and the code at which the sensor is full, as the image says them: a raw frame's response is a
// straight line of slope 1, above black.
RawStated stated_by_image(const manifest::Document& document, std::size_t i) {
  const manifest::ImageEntry& image = document.images[i];
  const double full = full_code_of(manifest::picture_path(document, i));
  RawStated stated;
  if (image.saturation) stated.white = *image.saturation * full + 0.5;
  if (image.response.is_null() || image.response == manifest::Value("linear")) return stated;
  const std::string place = manifest::place(document, "/images/" + std::to_string(i) + "/response");
  const Response response(image.response, place);
  response.check_invertible(place);
  const double black = response.code(0);
  for (const double share : {0.0, 0.25, 0.5, 1.0})
    if (std::abs(response(static_cast<float>(black + share * (1 - black))) - share * (1 - black)) > straight)
      throw Error(Exit::data, place, "bends: these are no codes of a raw frame",
                  "merge frames whose codes rise evenly with light, above black");
  stated.black = black * full;
  return stated;
}

// What all images agree on takes the place of what nobody stated on the command line.
void take_stated(const manifest::Document& document, std::size_t i, bool first, const RawStated& by_user,
                 RawStated& stated) {
  const RawStated own = stated_by_image(document, i);
  const auto take = [&](std::optional<double> RawStated::*member, const char* what) {
    if (by_user.*member) return;
    if (!first && (own.*member).has_value() != (stated.*member).has_value())
      throw Error(Exit::data, manifest::place(document, "/images/" + std::to_string(i)),
                  format("and the images before it do not both state %s", what), "state it for all, or for none");
    if (!first && own.*member && std::abs(*(own.*member) - *(stated.*member)) > same_code)
      throw Error(Exit::data, manifest::place(document, "/images/" + std::to_string(i)),
                  format("states %s at code %g, images before it %g", what, *(own.*member), *(stated.*member)),
                  "develop cameras apart (--camera)");
    stated.*member = own.*member;
  };
  take(&RawStated::black, "black");
  take(&RawStated::white, "full scale");
}

manifest::ImageEntry entry_of(const manifest::Document& document, const RawRequest& request, std::size_t view) {
  manifest::ImageEntry entry;
  if (!request.images.empty()) entry = document.images[request.images[view][0]];
  entry.id = request.views[view].name;
  if (!request.camera.empty()) entry.camera = request.camera;
  entry.exposure_s.reset(), entry.saturation.reset(), entry.noise.reset();
  entry.response = {};
  entry.gain = request.images.empty() ? std::nullopt : gain_of_view(document, request.images[view]);
  entry.group.clear();
  return entry;
}

// In codes, of images that all say the same of files with the same codes.
std::optional<manifest::Noise> noise_of_images(const manifest::Document& document, const RawRequest& request) {
  std::optional<manifest::Noise> noise;
  for (const auto& view : request.images)
    for (const std::size_t i : view) {
      const auto& stated = document.images[i].noise;
      if (!stated) return std::nullopt;
      const double full = full_code_of(manifest::picture_path(document, i));
      const manifest::Noise codes{stated->gain / full, stated->read * full};
      if (noise && (noise->gain != codes.gain || noise->read != codes.read)) return std::nullopt;
      noise = codes;
    }
  return noise;
}

}  // namespace

void views_of_images(const manifest::Document& document, const std::string& camera, RawRequest& request,
                     std::vector<std::filesystem::path>& dark_frames) {
  const RawStated by_user = request.recipe.stated;
  std::vector<std::string> groups;
  bool first = true;
  for (std::size_t i = 0; i < document.images.size(); ++i) {
    const manifest::ImageEntry& image = document.images[i];
    if (image.file.empty() || (!camera.empty() && image.camera != camera)) continue;
    refuse_developed(document, i, "leave it out, or give the frames that it was made of");
    const auto path = manifest::picture_path(document, i);
    take_stated(document, i, first, by_user, request.recipe.stated);
    first = false;
    if (image.dark == true) {
      dark_frames.push_back(path), request.spent.push_back(i);
      continue;
    }
    if (const auto found = document.cameras.find(image.camera); found != document.cameras.end())
      if (request.recipe.stated.mosaic.empty()) request.recipe.stated.mosaic = found->second.mosaic;
    const std::string group = image.group.empty() ? "" : image.camera + "/" + image.group;
    auto at = static_cast<std::size_t>(std::ranges::find(groups, group) - groups.begin());
    if (group.empty() || at == groups.size()) {
      at = groups.size();
      groups.push_back(group.empty() ? image.camera + "//" + image.id : group);
      request.views.push_back({image.group.empty() ? image.id : image.group, {}, {}});
      request.images.emplace_back();
    }
    request.views[at].frames.push_back(path);
    request.views[at].exposures_s.push_back(image.exposure_s);
    request.images[at].push_back(i);
  }
  request.recipe.noise = noise_of_images(document, request);
}

void develop_raw(manifest::Document& document, const RawRequest& request) {
  Progress progress("develop", request.views.size());
  std::vector<manifest::ImageEntry> developed;
  std::vector<bool> replaced(document.images.size());
  for (std::size_t v = 0; v < request.views.size(); ++v) {
    const RawView& view = request.views[v];
    DevelopedView d = develop_view(view, request.recipe);
    log(LogLevel::info, words_of(view, d));
    for (const auto& path : view.frames) request.note_input(path);
    const auto picture = request.output_path(view.name + ".exr"), mask = request.output_path(view.name + "-mask.png");
    io::write_picture(picture, d.picture);
    io::Image counts(d.picture.width, d.picture.height, {"Y"});
    std::ranges::transform(d.trusted, counts.data.begin(), [](std::uint8_t t) { return t != 0 ? 1.0f : 0.0f; });
    io::write_png(mask, counts, 8);
    manifest::ImageEntry entry = entry_of(document, request, v);
    entry.developed = steps_of(request.recipe, d);
    entry.file = manifest::add_file(document, picture, view.name);
    entry.mask = manifest::add_file(document, mask, view.name + "-mask");
    developed.push_back(std::move(entry));
    if (!request.images.empty())
      for (const std::size_t i : request.images[v]) replaced[i] = true;
    progress.advance();
  }
  for (const std::size_t i : request.spent) replaced[i] = true;
  std::vector<manifest::ImageEntry> images;
  for (std::size_t i = 0; i < document.images.size(); ++i) {
    if (!replaced[i]) images.push_back(document.images[i]);
    for (std::size_t v = 0; v < request.images.size(); ++v)
      if (request.images[v][0] == i) images.push_back(developed[v]);
  }
  if (request.images.empty()) images.insert(images.end(), developed.begin(), developed.end());
  document.images = std::move(images);
}

}  // namespace gonio::photograph
