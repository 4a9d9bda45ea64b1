#include "metric/entries.h"

#include <algorithm>

#include "base/error.h"
#include "camera/intrinsics.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/comparison.h"
#include "manifest/sections/image.h"
#include "manifest/sections/rendering.h"

namespace gonio::metric {

std::vector<Entry> entries(const manifest::Document& document) {
  std::vector<Entry> found;
  for (std::size_t k = 0; k < document.renderings.size(); ++k) {
    const manifest::Rendering& rendering = document.renderings[k];
    const std::string at = "/renderings/" + std::to_string(k);
    const auto listed = manifest::index_of_image(document, rendering.image);
    if (!listed)
      throw Error(Exit::data, manifest::place(document, at + "/image"),
                  "names \"" + rendering.image + "\", which is not in images");
    const manifest::ImageEntry& image = document.images[*listed];
    if (image.file.empty()) continue;
    Entry entry;
    entry.image = image.id;
    entry.photograph = manifest::picture_path(document, *listed);
    // What a sensor behind polarizers gets, where render --stokes made it: half of the light, more or less.
    const auto mosaic = rendering.files.find("mosaic");
    const bool behind_polarizers = camera::mosaic_of(document, image.camera) == "polarizers";
    entry.rendering = behind_polarizers && mosaic != rendering.files.end()
                          ? manifest::resolve(document, mosaic->second, at + "/files/mosaic")
                          : manifest::resolve(document, rendering.file, at + "/file");
    entry.mask = manifest::mask_path(document, *listed);
    entry.response = image.response;
    entry.saturation = image.saturation;
    entry.photograph_place = manifest::place(document, "/images/" + std::to_string(*listed));
    entry.rendering_place = manifest::place(document, at);
    entry.noise = image.noise;
    found.push_back(std::move(entry));
  }
  if (found.empty())
    throw Error(Exit::data, manifest::place(document, "/renderings"),
                document.renderings.empty() ? "is empty: there is nothing to compare"
                                            : "has no rendering of an image with a file",
                "run render first, or give --reference and --rendered");
  return found;
}

manifest::Document document_of(const Entry& entry) {
  manifest::Document document;
  manifest::ImageEntry image;
  image.id = entry.image;
  image.file = manifest::add_file(document, entry.photograph, entry.image);
  image.response = entry.response;
  image.saturation = entry.saturation;
  image.noise = entry.noise;
  if (!entry.mask.empty()) image.mask = manifest::add_file(document, entry.mask, entry.image + "-mask");
  document.images.push_back(std::move(image));
  document.renderings.push_back(
      {entry.image, manifest::add_file(document, entry.rendering, entry.image + "-rendering"), {}, {}});
  return document;
}

Overlay lay_over(const Entry& entry, Channels channels) {
  std::optional<Mask> mask;
  if (!entry.mask.empty()) mask = photograph::read_mask(entry.mask);
  photograph::LinearPicture photograph =
      photograph::read_linear(entry.photograph, entry.response, entry.photograph_place, entry.saturation);
  std::optional<manifest::Noise> noise = entry.noise;
  if (entry.prepare) entry.prepare(photograph, noise);
  return lay_over(entry.image, std::move(photograph),
                  photograph::read_linear(entry.rendering, entry.rendering_response, entry.rendering_place),
                  mask ? &*mask : nullptr, channels, noise);
}

void enter(manifest::Document& document, const std::string& image, const Measures& m,
           const std::map<std::string, std::string>& files) {
  manifest::Comparison comparison;
  comparison.image = image;
  comparison.exposure_scale = m.exposure_scale.value;
  if (m.exposure_fitted) comparison.sigma["exposure_scale"] = {m.exposure_scale.sigma};
  const auto put = [&](const char* name, std::optional<double>& field, const std::optional<Estimate>& estimate) {
    if (!estimate) return;
    field = estimate->value;
    comparison.sigma[name] = {estimate->sigma};
  };
  put("rmse", comparison.rmse, m.rmse);
  put("relative_rmse", comparison.relative_rmse, m.relative_rmse);
  put("ssim", comparison.ssim, m.ssim);
  put("log10_error", comparison.log10_error, m.log10_error);
  put("z_rms", comparison.z_rms, m.z_rms);
  put("z_above_3", comparison.z_above_3, m.z_above_3);
  comparison.pixels = m.pixels;
  if (m.not_finite.pixels > 0) comparison.not_finite = m.not_finite.pixels;
  if (!files.empty()) {
    comparison.files = manifest::Value::object();
    for (const auto& [name, id] : files) comparison.files[name] = id;
  }
  const auto same = std::ranges::find(document.comparisons, image, &manifest::Comparison::image);
  if (same != document.comparisons.end())
    *same = std::move(comparison);
  else
    document.comparisons.push_back(std::move(comparison));
}

}  // namespace gonio::metric
