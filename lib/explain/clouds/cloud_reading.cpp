// See cloud_reading.h.
#include "explain/clouds/cloud_reading.h"

#include <algorithm>
#include <cmath>

#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "mesh/reconstruct/viewpoints.h"
#include "scan/cloud_file.h"
#include "stats/intervals.h"

namespace gonio::explain {
namespace {

using manifest::Document;

// Images of one cloud by its first camera.
std::vector<const manifest::ImageEntry*> images_of(const Document& d, const std::string& name,
                                                   const manifest::Cloud& cloud) {
  std::vector<const manifest::ImageEntry*> found;
  for (const std::size_t i : mesh::images_of_cloud(d, name))
    if (d.images[i].camera == cloud.cameras[0]) found.push_back(&d.images[i]);
  return found;
}

std::optional<double> mean_of(const std::vector<const manifest::ImageEntry*>& images,
                              std::optional<double> manifest::ImageEntry::*what) {
  double sum = 0;
  for (const manifest::ImageEntry* image : images) {
    if (!(image->*what)) return std::nullopt;
    sum += *(image->*what);
  }
  return images.empty() ? std::nullopt : std::optional(sum / static_cast<double>(images.size()));
}

std::uint64_t key(long x, long y) {
  return static_cast<std::uint64_t>(x) << 32 | (static_cast<std::uint64_t>(y) & 0xffffffffu);
}

}  // namespace

bool is_placed(const Document& document, const std::string& name, const manifest::Cloud& cloud) {
  const auto images = images_of(document, name, cloud);
  return !images.empty() && images[0]->world_from_camera.has_value();
}

bool is_projector(const Document& d, const std::string& camera, const std::string& projection) {
  return std::ranges::none_of(d.images, [&](const manifest::ImageEntry& image) {
    return image.camera == camera && image.projection == projection && image.shows;
  });
}

ReadCloud read_one(const Document& d, const std::string& name, const manifest::Cloud& cloud,
                   const scan::Station& first) {
  const std::vector<const manifest::ImageEntry*> images = images_of(d, name, cloud);
  ReadCloud read;
  if (!images.empty() && images[0]->world_from_camera) {
    const Rigid<frame::World, frame::Camera>& pose = *images[0]->world_from_camera;
    read.world_from_rig = pose * inverse(first.rig_from_camera), read.placed = true;
  }
  read.points = scan::read_cloud(manifest::resolve(d, cloud.file, "/clouds/" + name + "/file"), read.world_from_rig);
  read.temperature_K = mean_of(images, &manifest::ImageEntry::temperature_K);
  read.time_s = mean_of(images, &manifest::ImageEntry::time_s);
  return read;
}

void state_changes(std::span<const ReadCloud> clouds, std::span<CloudView> views) {
  const auto state = [&](std::optional<double> ReadCloud::*value, double CloudView::*change) {
    double sum = 0;
    for (const ReadCloud& c : clouds) {
      if (!(c.*value)) return false;
      sum += *(c.*value);
    }
    for (CloudView& v : views) v.*change = *(clouds[v.cloud].*value) - sum / static_cast<double>(clouds.size());
    return true;
  };
  if (!state(&ReadCloud::temperature_K, &CloudView::warmer_K)) state(&ReadCloud::time_s, &CloudView::later_s);
}

PointsByPixel::PointsByPixel(std::span<const scan::ScanPoint> points) : points_(points) {
  for (std::size_t i = 0; i < points.size(); ++i)
    found_[key(std::lround(points[i].pixel.x), std::lround(points[i].pixel.y))] = i;
}

std::optional<std::size_t> PointsByPixel::at(long x, long y) const {
  const auto it = found_.find(key(x, y));
  return it == found_.end() ? std::nullopt : std::optional(it->second);
}

equation::Neighbours PointsByPixel::brightness(Vec2 pixel) const {
  equation::Neighbours all{};
  const long x = std::lround(pixel.x), y = std::lround(pixel.y);
  for (std::size_t k = 0; k < all.size(); ++k) {
    const auto place = at(x + static_cast<long>(k % 5) - 2, y + static_cast<long>(k / 5) - 2);
    if (!place) return {};
    all[k] = points_[*place].reflected;
  }
  return all;
}

std::vector<Chosen> chosen(std::span<const Vec2> pixels, std::size_t each) {
  Vec2 low{1e30, 1e30}, high{-1e30, -1e30};
  for (const Vec2& p : pixels) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  std::vector<std::vector<std::size_t>> tiles(tiles_a_side * tiles_a_side);
  const auto place = [](double v, double from, double to) {
    const double share = to > from ? (v - from) / (to - from) : 0;
    return std::min(tiles_a_side - 1, static_cast<std::size_t>(share * static_cast<double>(tiles_a_side)));
  };
  for (std::size_t i = 0; i < pixels.size(); ++i)
    tiles[place(pixels[i].y, low.y, high.y) * tiles_a_side + place(pixels[i].x, low.x, high.x)].push_back(i);
  std::vector<Chosen> all;
  std::uint32_t number = 0;
  for (const std::vector<std::size_t>& tile : tiles) {
    const std::size_t count = std::min(each, tile.size());
    // The golden ratio's multiples: no stride that a pattern's period could share.
    for (std::size_t k = 0; k < count; ++k) {
      double whole = 0;
      const double at = count == tile.size() ? static_cast<double>(k) / static_cast<double>(count)
                                             : std::modf((static_cast<double>(k) + 0.5) * 0.6180339887498949, &whole);
      all.push_back({tile[static_cast<std::size_t>(at * static_cast<double>(tile.size()))], number});
    }
    number += count > 0;
  }
  return all;
}

std::vector<std::size_t> near_median(std::span<const double> values) {
  const double middle = stats::median(values);
  std::vector<double> sizes;
  for (const double v : values) sizes.push_back(std::abs(v - middle));
  const double reach = far_sigmas * 1.4826 * stats::median(sizes);
  std::vector<std::size_t> near;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (sizes[i] <= reach) near.push_back(i);
  return near;
}

}  // namespace gonio::explain
