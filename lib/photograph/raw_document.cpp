// See raw_document.h.
#include "photograph/raw_document.h"

#include <algorithm>

#include "base/error.h"
#include "base/progress.h"
#include "base/text.h"
#include "io/codes.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"

namespace gonio::photograph {
namespace {

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

manifest::ImageEntry entry_of(const manifest::Document& document, const RawRequest& request, std::size_t view) {
  manifest::ImageEntry entry;
  if (!request.images.empty()) entry = document.images[request.images[view][0]];
  entry.id = request.views[view].name;
  if (!request.camera.empty()) entry.camera = request.camera;
  entry.exposure_s.reset(), entry.saturation.reset(), entry.noise.reset();
  entry.response = {};
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
  std::vector<std::string> groups;
  for (std::size_t i = 0; i < document.images.size(); ++i) {
    const manifest::ImageEntry& image = document.images[i];
    if (image.file.empty() || (!camera.empty() && image.camera != camera)) continue;
    const auto path = manifest::picture_path(document, i);
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
