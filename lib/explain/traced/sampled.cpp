// See sampled.h.
#include "explain/traced/sampled.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/random.h"
#include "base/text.h"
#include "mesh/curvature.h"
#include "relighting/cells.h"
#include "relighting/sampled_pixels.h"
#include "render/camera_ray.h"
#include "render/vertex.h"

namespace gonio::explain::traced {
namespace {

using relighting::tile_px;

constexpr std::size_t least_groups = 8;
constexpr std::uint64_t seed = 127;
constexpr double share_of_objects = 2.0 / 3;

class Curvatures {
 public:
  explicit Curvatures(const scene::Scene& scene) : scene_(scene) {}
  double at(const render::SurfacePoint& point) {
    const auto* mesh = std::get_if<std::shared_ptr<const mesh::Mesh>>(&scene_.instances[point.instance].shape);
    if (mesh == nullptr) return 0;
    std::vector<float>& values = of_mesh_[mesh->get()];
    if (values.empty()) values = mesh::mean_curvature_per_m(**mesh);
    const auto& t = (*mesh)->triangles[point.triangle];
    const double a = values[t[0]], b = values[t[1]], c = values[t[2]];
    return a + (b - a) * point.b1 + (c - a) * point.b2;
  }

 private:
  const scene::Scene& scene_;
  std::map<const mesh::Mesh*, std::vector<float>> of_mesh_;
};

class Chooser {
 public:
  Chooser(const relighting::Recordings& recordings, const scene::Scene& scene, const render::RayCaster& caster,
          std::span<const std::size_t> surfaces)
      : recordings_(recordings), scene_(scene), caster_(caster), surfaces_(surfaces), curvatures_(scene) {}

  Sampled run(std::size_t pixels) {
    Sampled result;
    const std::size_t images = recordings_.images.size();
    const std::size_t cells = relighting::cells_each(images, least_groups);
    for (std::size_t g = 0; g < images; ++g) {
      part(of_image(g, std::max<std::size_t>(150, pixels / images)), cells, g, result);
    }
    result.first.push_back(result.pixels.size());
    number_blocks(result);
    return result;
  }

 private:
  std::optional<render::SurfacePoint> met(const scene::View& view, Vec2 pixel) const {
    const render::WorldRay ray = render::CameraRays(view).principal(pixel);
    return caster_.closest(ray.origin_m, ray.direction);
  }

  // Nothing where the pixel shows more than one thing.
  std::optional<SampledPixel> seen(std::size_t image, const scene::View& view, int x, int y) {
    const Vec2 middle{static_cast<double>(x), static_cast<double>(y)};
    const auto hit = met(view, middle);
    if (!hit) return {};
    for (const Vec2 off : {Vec2{-1.5, -1.5}, Vec2{1.5, -1.5}, Vec2{-1.5, 1.5}, Vec2{1.5, 1.5}}) {
      const auto beside = met(view, middle + off);
      if (!beside || beside->instance != hit->instance) return {};
    }
    SampledPixel pixel{.image = image, .x = x, .y = y, .surface = {}, .here = {}};
    const auto found = std::ranges::find(surfaces_, std::size_t{hit->surface});
    if (found == surfaces_.end()) return pixel;
    pixel.surface = static_cast<std::size_t>(found - surfaces_.begin());
    const scene::Place place = render::place_of(*hit, scene_.instances[hit->instance]);
    pixel.here = {place.position_m, place.normal, curvatures_.at(*hit)};
    const render::WorldRay ray = render::CameraRays(view).principal(middle);
    pixel.incidence_rad = std::acos(std::clamp(-dot(ray.direction, hit->normal), 0.0, 1.0));
    const auto all = caster_.crossings(hit->instance, ray.origin_m, ray.direction, render::far_away);
    for (std::size_t k = 0; k + 1 < all.size(); k += 2) pixel.path_m += norm(all[k + 1].position_m - all[k].position_m);
    return pixel;
  }

  std::vector<SampledPixel> of_image(std::size_t g, std::size_t wanted) {
    const relighting::Recording& image = recordings_.images[g];
    const scene::View& view = scene_.views[image.entry];
    const int width = image.picture.width, height = image.picture.height;
    std::vector<SampledPixel> objects, others;
    // Larger pictures are looked at in a coarser grid, each time somewhere else in its meshes.
    const int step = std::max(1, static_cast<int>(std::sqrt(width * static_cast<double>(height) / 60000)));
    Random random(seed, g);
    for (int top = 0; top < height; top += step)
      for (int left = 0; left < width; left += step) {
        const int x = left + static_cast<int>(random.below(static_cast<std::uint32_t>(step))),
                  y = top + static_cast<int>(random.below(static_cast<std::uint32_t>(step)));
        if (x >= width || y >= height ||
            !image.counts[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)])
          continue;
        const auto pixel = seen(g, view, x, y);
        if (pixel) (pixel->surface ? objects : others).push_back(*pixel);
      }
    const auto take = [&](std::vector<SampledPixel>& from, double share) {
      const auto count = std::min(from.size(), static_cast<std::size_t>(share * static_cast<double>(wanted)));
      for (std::size_t k = 0; k < count; ++k)
        std::swap(from[k], from[k + random.below(static_cast<std::uint32_t>(from.size() - k))]);
      from.resize(count);
    };
    take(objects, share_of_objects), take(others, 1 - share_of_objects);
    objects.insert(objects.end(), others.begin(), others.end());
    return objects;
  }

  void part(const std::vector<SampledPixel>& mine, std::size_t cells, std::size_t g, Sampled& result) const {
    std::vector<std::array<int, 2>> places;
    for (const SampledPixel& p : mine) places.push_back({p.x, p.y});
    const std::vector<std::vector<std::size_t>> parts = relighting::cells_of(places, cells);
    for (std::size_t k = 0; k < parts.size(); ++k) {
      result.first.push_back(result.pixels.size());
      const std::string& id = recordings_.images[g].id;
      result.groups.push_back(parts.size() > 1 ? id + format(", part %zu", k + 1) : id);
      for (const std::size_t p : parts[k]) result.pixels.push_back(mine[p]);
    }
  }

  static void number_blocks(Sampled& result) {
    std::uint32_t blocks = 0;
    for (std::size_t g = 0; g + 1 < result.first.size(); ++g) {
      std::map<std::array<int, 2>, std::uint32_t> tiles;
      for (std::size_t p = result.first[g]; p < result.first[g + 1]; ++p) {
        SampledPixel& pixel = result.pixels[p];
        const auto [at, fresh] = tiles.try_emplace({pixel.x / tile_px, pixel.y / tile_px}, blocks);
        blocks += fresh;
        pixel.block = at->second;
      }
    }
  }

  const relighting::Recordings& recordings_;
  const scene::Scene& scene_;
  const render::RayCaster& caster_;
  std::span<const std::size_t> surfaces_;
  Curvatures curvatures_;
};

}  // namespace

Sampled sampled(const relighting::Recordings& recordings, const scene::Scene& scene, const render::RayCaster& caster,
                std::span<const std::size_t> surfaces, std::size_t pixels) {
  return Chooser(recordings, scene, caster, surfaces).run(pixels);
}

}  // namespace gonio::explain::traced
