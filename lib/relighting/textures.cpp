// See textures.h.
#include "relighting/textures.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace gonio::relighting {
namespace {

using render::SurfacePoint;

const scene::Texture* albedo_texture(const scene::Surface& surface) {
  const auto found = std::ranges::find(surface.textures, "albedo", &scene::Texture::name);
  return found == surface.textures.end() ? nullptr : &*found;
}

bool has_textures(const scene::Scene& scene) {
  return std::ranges::any_of(scene.appearance.surfaces,
                             [](const scene::Surface& s) { return albedo_texture(s) != nullptr; });
}

// A printed edge lies within a tenth of a pixel of where a calibrated camera sees it. A step that crosses a pixel has a
// spread of half its height, and moves the pixel by its height for a pixel.
constexpr double place_error_px = 0.1;

// What the rays of a square about a pixel's middle meet.
template <class Visit>
void look_about(const render::RayCaster& caster, const View& view, int x, int y, double half_px, int rays,
                const Visit& visit) {
  for (int j = 0; j < rays; ++j)
    for (int i = 0; i < rays; ++i) {
      const Vec2 at{x + half_px * (2.0 * i / (rays - 1) - 1), y + half_px * (2.0 * j / (rays - 1) - 1)};
      const camera::Ray ray = view.model.ray(at);
      visit(caster.closest(view.world_from_camera * ray.origin_m, view.world_from_camera.rotate(ray.direction)));
    }
}

Rgb mean_texel(const io::Image& picture) {
  const std::size_t channels = picture.channels.size();
  Rgb sum;
  for (std::size_t i = 0; i < picture.pixels(); ++i) {
    const float* texel = picture.data.data() + i * channels;
    sum += channels < 3 ? Rgb{texel[0], texel[0], texel[0]} : Rgb{texel[0], texel[1], texel[2]};
  }
  return sum / static_cast<double>(std::max<std::size_t>(1, picture.pixels()));
}

}  // namespace

void settle_textures(const scene::Scene& scene, SceneLayout& layout) {
  for (std::size_t s = 0; s < layout.surfaces.size(); ++s) {
    const scene::Texture* texture = albedo_texture(scene.appearance.surfaces[s]);
    if (texture == nullptr) continue;
    SurfaceState& state = layout.start.surfaces[s];
    state.values.v[parameter_index(*state.model, "albedo")] = mean_texel(*texture->picture);
  }
}

bool is_even(const scene::Scene& scene, const render::RayCaster& caster, const View& view, int x, int y) {
  if (!has_textures(scene)) return true;
  std::optional<std::uint32_t> instance;
  Rgb least{1, 1, 1}, most;
  bool textured = false, one = true, sky = false;
  look_about(caster, view, x, y, even_margin_px, 5, [&](const std::optional<SurfacePoint>& met) {
    if (!met) {
      sky = true;
      return;
    }
    one = one && instance.value_or(met->instance) == met->instance;
    instance = met->instance;
    const scene::Texture* texture = albedo_texture(scene.appearance.surfaces[met->surface]);
    if (texture == nullptr) return;
    const Rgb here = texture->at(met->uv);
    least = textured ? Rgb{std::min(least.x, here.x), std::min(least.y, here.y), std::min(least.z, here.z)} : here;
    most = textured ? Rgb{std::max(most.x, here.x), std::max(most.y, here.y), std::max(most.z, here.z)} : here;
    textured = true;
  });
  return !textured || (one && !sky && max_component(most - least) <= even_change);
}

Tints::Tints(const scene::Scene& scene) : scene_(scene) {
  if (!has_textures(scene)) return;
  for (const scene::Surface& surface : scene.appearance.surfaces) {
    const scene::Texture* texture = albedo_texture(surface);
    means_.push_back(texture != nullptr ? mean_texel(*texture->picture) : Rgb{});
  }
}

void Tints::apply(const render::RayCaster& caster, const View& view, ViewCache& cache, int rays) const {
  if (means_.empty()) return;
  for (const Pixel& pixel : cache.pixels)
    for (std::size_t f = pixel.first_facet; f < pixel.first_facet + pixel.facets; ++f) {
      const std::uint32_t surface = cache.facets[f].surface;
      const scene::Texture* texture = albedo_texture(scene_.appearance.surfaces[surface]);
      if (texture == nullptr) continue;
      Rgb sum, square;
      double n = 0;
      look_about(caster, view, pixel.x, pixel.y, 0.5, rays, [&](const std::optional<SurfacePoint>& met) {
        if (!met || met->surface != surface) return;
        const Rgb texel = texture->at(met->uv);
        sum += texel, square += texel * texel;
        n += 1;
      });
      if (n == 0) continue;
      const Rgb mean = means_[surface], here = sum / n;
      const auto over = [](double value, double usual) { return usual > 0 ? value / usual : 1; };
      cache.facets[f].tint = {over(here.x, mean.x), over(here.y, mean.y), over(here.z, mean.z)};
      const double spread = std::sqrt(std::max(0.0, max_component(square / n - here * here)));
      cache.facets[f].tint_sigma = static_cast<float>(place_error_px * 2 * spread / max_component(mean));
    }
}

}  // namespace gonio::relighting
