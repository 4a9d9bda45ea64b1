// Photographs with what was found in them drawn over: an SVG that holds the picture.
#include "tools/reassemble/draw.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "camera/camera_model.h"
#include "io/picture.h"
#include "io/raster.h"
#include "manifest/image_list.h"
#include "manifest/sections/camera.h"
#include "report/page.h"

namespace gonio::tools::reassemble {
namespace {

constexpr int shown_px = 900;

// Means of whole blocks; brightness so that the 99th percentile is white, as sRGB.
io::Image small_picture(const io::Image& picture, int& block) {
  block = std::max(1, (std::max(picture.width, picture.height) + shown_px - 1) / shown_px);
  const int colour[3] = {picture.channel("R"), picture.channel("G"), picture.channel("B")};
  io::Image small(picture.width / block, picture.height / block, {"R", "G", "B"});
  for (int y = 0; y < small.height; ++y)
    for (int x = 0; x < small.width; ++x)
      for (int c = 0; c < 3; ++c) {
        float sum = 0;
        for (int v = 0; v < block; ++v)
          for (int u = 0; u < block; ++u)
            sum += picture.at(x * block + u, y * block + v, colour[0] < 0 ? 0 : colour[c]);
        small.at(x, y, c) = sum / static_cast<float>(block * block);
      }
  return small;
}

std::string picture_png(const std::filesystem::path& path, int& block, int& width, int& height) {
  io::Image picture = io::read_picture(path);
  width = picture.width, height = picture.height;
  io::Image small = small_picture(picture, block);
  if (io::picture_format(path) == io::PictureFormat::exr) {
    std::vector<float> values;
    for (const float v : small.data)
      if (std::isfinite(v)) values.push_back(v);
    if (!values.empty()) {
      const auto at = values.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(values.size() - 1));
      std::nth_element(values.begin(), at, values.end());
      const float white = *at > 0 ? *at : 1;
      for (float& v : small.data) v = io::srgb_from_linear(std::clamp(v / white, 0.0F, 1.0F));
    }
  }
  return io::encode_png(small);
}

const char* colour_of(Look look) {  // that the colour-blind tell apart (Okabe & Ito 2008), dashes beside
  switch (look) {
    case Look::paired: return "#0072b2";
    case Look::bundled: return "#009e73";
    case Look::refracted: return "#e69f00";
    case Look::reflected: return "#cc79a7";
    case Look::alone: break;
  }
  return "#999999";
}

}  // namespace

std::vector<Look> looks_of(const Work& work, std::size_t view) {
  std::vector<Look> looks;
  for (const reassembly::Fate fate : work.placement.fate[view])
    looks.push_back(fate == reassembly::Fate::bundled     ? Look::bundled
                    : fate == reassembly::Fate::refracted ? Look::refracted
                    : fate == reassembly::Fate::reflected ? Look::reflected
                                                          : Look::alone);
  for (const reassembly::Placed& placed : work.placement.pieces)
    for (const reassembly::Pair& pair : placed.pairs)
      for (const reassembly::Sighting& s : work.bundles.found[pair.bundle].sightings)
        if (s.view == view && placed.verdict == reassembly::Verdict::placed) looks[s.outline] = Look::paired;
  return looks;
}

std::string drawing_of(const Work& work, std::size_t view) {
  const manifest::Document& document = work.call.document;
  const reassembly::View& seen = work.seen.views[view];
  const std::size_t image = *manifest::index_of_image(document, seen.image);
  int block = 1, width = 0, height = 0;
  const std::string png = picture_png(manifest::picture_path(document, image), block, width, height);
  std::string svg = format("<svg viewBox=\"-0.5 -0.5 %d %d\" role=\"img\" aria-label=\"markers in %s\">", width, height,
                           report::escape(seen.image).c_str());
  svg += format("<image x=\"-0.5\" y=\"-0.5\" width=\"%d\" height=\"%d\" href=\"data:image/png;base64,",
                width / block * block, height / block * block) +
         report::base64(png) + "\"/>";
  const double line = std::max(1.0, width / 450.0);
  const std::vector<Look> looks = looks_of(work, view);
  for (std::size_t o = 0; o < seen.outlines.size(); ++o) {
    const reassembly::Outline& outline = seen.outlines[o];
    const char* dash = looks[o] == Look::refracted ? "4 2" : looks[o] == Look::reflected ? "1.5 1.5" : "none";
    svg += format(
        "<circle cx=\"%.2f\" cy=\"%.2f\" r=\"%.2f\" fill=\"none\" stroke=\"%s\" stroke-width=\"%.2f\" "
        "stroke-dasharray=\"%s\"/>",
        outline.centre_px.x, outline.centre_px.y, outline.radius_px + line, colour_of(looks[o]), line, dash);
  }
  // Where the placed markers should be: crosses.
  const camera::CameraModel camera = reassembly::camera_of(document, image);
  for (std::size_t p = 0; p < work.pieces.size(); ++p) {
    const reassembly::Placed& placed = work.placement.pieces[p];
    if (placed.verdict != reassembly::Verdict::placed) continue;
    for (const reassembly::PieceMarker& marker : work.pieces[p].markers) {
      const auto at = camera.project(inverse(seen.world_from_camera) *
                                     (placed.world_from_object * (work.placement.scale * marker.centre_m)));
      if (!at) continue;
      svg += format("<path d=\"M%.2f %.2fh%.2fM%.2f %.2fv%.2f\" stroke=\"#d55e00\" stroke-width=\"%.2f\"/>",
                    at->x - 4 * line, at->y, 8 * line, at->x, at->y - 4 * line, 8 * line, 0.6 * line);
    }
  }
  return svg + "</svg>";
}

}  // namespace gonio::tools::reassemble
