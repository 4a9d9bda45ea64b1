// See mask_regions.h.
#include "alignment/mask_regions.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/alignment.h"
#include "manifest/sections/camera.h"

namespace gonio::alignment {
namespace {

constexpr double margin_px = 4;

// "left", ... where the mask reaches the picture's edge.
std::string cut_side(const std::vector<float>& share, int width, int height) {
  const auto on = [&](int x, int y) {
    return share[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] > 0.5F;
  };
  for (int y = 0; y < height; ++y) {
    if (on(0, y)) return "left";
    if (on(width - 1, y)) return "right";
  }
  for (int x = 0; x < width; ++x) {
    if (on(x, 0)) return "upper";
    if (on(x, height - 1)) return "lower";
  }
  return "";
}

}  // namespace

MaskRegions::MaskRegions(int width, int height, std::vector<Mask> masks)
    : width_(width), height_(height), masks_(std::move(masks)) {
  const int reach = static_cast<int>(std::ceil(margin_px));
  for (const Mask& own : masks_) {
    std::vector<std::uint8_t> near(own.share.size(), 0);
    const auto at = [&](int x, int y) {
      return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    };
    const auto mark_about = [&](int x, int y) {
      for (int v = std::max(0, y - reach); v <= std::min(height - 1, y + reach); ++v)
        for (int u = std::max(0, x - reach); u <= std::min(width - 1, x + reach); ++u)
          if ((u - x) * (u - x) + (v - y) * (v - y) <= margin_px * margin_px) near[at(u, v)] = 1;
    };
    for (const Mask& other : masks_) {
      const bool over = covers(own, other);
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
          if ((over && other.share[at(x, y)] > 0.5F) || (!other.unknown.empty() && other.unknown[at(x, y)]))
            mark_about(x, y);
    }
    near_[own.outline] = std::move(near);
  }
}

// Objects hide shadows. Where two objects meet, the masks do not say whose rim it is; two shadows of different lamps
// lie over each other, and so do two objects' shadows.
bool MaskRegions::covers(const Mask& own, const Mask& other) const {
  if (&own == &other || other.shadow) return false;
  return own.shadow || own.object != other.object;
}

const MaskRegions::Mask& MaskRegions::mask(std::size_t outline) const {
  for (const Mask& m : masks_)
    if (m.outline == outline) return m;
  throw Error(Exit::internal, "outlines", "lost a mask");
}

std::vector<RimPoint> MaskRegions::rim(std::size_t outline, double smooth_px, bool whole) const {
  const Mask& own = mask(outline);
  const auto inside = std::count_if(own.share.begin(), own.share.end(), [](float v) { return v > 0.5F; });
  if (inside == 0) throw Error(Exit::data, own.place, "is empty", "no pixel of it is above a half");
  if (inside == static_cast<std::ptrdiff_t>(own.share.size()))
    throw Error(Exit::data, own.place, "covers the whole picture", "it has no rim");
  if (whole) {
    const std::string side = cut_side(own.share, width_, height_);
    if (!side.empty())
      throw Error(Exit::data, own.place, "touches the picture's " + side + " border: the object is cut off",
                  "take a picture of all of it, or state a pose that is nearly right and give --from stated");
  }
  Region region{width_, height_, own.share, near_.at(outline), 0.8};
  if (own.shadow)  // what an object hides of its shadow goes on beneath it: its own rim ends there
    for (const Mask& other : masks_)
      if (covers(own, other))
        for (std::size_t i = 0; i < region.share.size(); ++i)
          region.share[i] = std::min(region.share[i], 1 - other.share[i]);
  auto points = rim_points(region, smoothed_by(outline, smooth_px), 12);
  if (std::none_of(points.begin(), points.end(), [](const RimPoint& p) { return p.counts; }) && !own.shadow)
    throw Error(Exit::data, own.place, "has no rim of its own", "specks, or hidden all around");
  return points;
}

bool MaskRegions::hides(std::size_t outline, Vec2 pixel) const {
  if (!(pixel.x >= 2 && pixel.y >= 2 && pixel.x <= width_ - 3 && pixel.y <= height_ - 3)) return true;
  const auto x = static_cast<std::size_t>(std::lround(pixel.x)), y = static_cast<std::size_t>(std::lround(pixel.y));
  return near_.at(outline)[y * static_cast<std::size_t>(width_) + x] != 0;
}

MaskRegions read_regions(const manifest::Document& document, const std::string& image,
                         const std::function<void(const std::filesystem::path&)>& note) {
  std::vector<MaskRegions::Mask> masks;
  int width = 0, height = 0;
  const auto size = camera::picture_size_px(
      document, manifest::camera_of_image(document, *manifest::index_of_image(document, image)));
  for (std::size_t i = 0; i < document.outlines.size(); ++i) {
    const manifest::Outline& o = document.outlines[i];
    if (o.image != image) continue;
    const std::string place = manifest::place(document, "/outlines/" + std::to_string(i) + "/mask");
    if (o.mask.empty())
      throw Error(Exit::data, place, "is missing", "give a picture whose pixels above a half belong to it");
    const auto path = manifest::resolve(document, o.mask, "/outlines/" + std::to_string(i) + "/mask");
    if (note) note(path);
    const io::Image picture = io::read_picture(path);
    if (picture.width != size[0] || picture.height != size[1])
      throw Error(Exit::data, place,
                  format("has %d x %d pixels, and the camera %d x %d", picture.width, picture.height, size[0], size[1]),
                  "masks are as large as the photograph");
    width = picture.width, height = picture.height;
    MaskRegions::Mask mask{i, o.object, place, o.kind == "shadow", std::vector<float>(picture.pixels()), true, {}};
    const int unknown = picture.channel("unknown");
    if (unknown >= 0) mask.unknown.resize(picture.pixels());
    std::size_t between = 0;
    for (std::size_t p = 0; p < picture.pixels(); ++p) {
      const float v = picture.data[p * picture.channels.size()];
      if (!std::isfinite(v)) throw Error(Exit::data, place, "has a pixel that is no number");
      mask.share[p] = std::clamp(v, 0.0F, 1.0F);
      if (unknown >= 0)
        mask.unknown[p] = picture.data[p * picture.channels.size() + static_cast<std::size_t>(unknown)] > 0.5F;
      between += v > 0.02F && v < 0.98F;
    }
    const auto inside = std::count_if(mask.share.begin(), mask.share.end(), [](float v) { return v > 0.5F; });
    mask.binary = static_cast<double>(between) < 0.5 * std::sqrt(static_cast<double>(inside));
    masks.push_back(std::move(mask));
  }
  return {width, height, std::move(masks)};
}

}  // namespace gonio::alignment
