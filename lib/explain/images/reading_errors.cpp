// See reading_errors.h. Without shadows, a mesh that is meant otherwise is the mesh as it is, met by rays that are
// taken back: nothing is built anew for it.
#include "explain/images/reading_errors.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "geom/mat3_inverse.h"
#include "relighting/shading.h"
#include "relighting/textures.h"

namespace gonio::explain::images {
namespace {

constexpr std::size_t all_pixels = 3000, fewest_of_view = 60, most_of_view = 300;
constexpr std::size_t fewest_of_picture = 40;  // else nothing is said of it
constexpr int descent_sweeps = 60;
constexpr CacheOptions coarse{.samples = 3, .paths = 0, .patches = 1, .penumbrae = false};

double squared(double x) {
  return x * x;
}

// Least squares with factors that are not negative: what stays of y'y. `gram`, `right`: of the normal equations.
double least_square_left(const std::vector<double>& gram, const std::vector<double>& right, double square) {
  const std::size_t n = right.size();
  std::vector<double> factor(n);
  double left = square;
  for (int sweep = 0; sweep < descent_sweeps; ++sweep) {
    for (std::size_t k = 0; k < n; ++k) {
      if (!(gram[k * n + k] > 0)) continue;
      double pull = right[k];
      for (std::size_t j = 0; j < n; ++j) pull -= gram[k * n + j] * factor[j];
      factor[k] = std::max(0.0, factor[k] + pull / gram[k * n + k]);
    }
    double now = square;
    for (std::size_t k = 0; k < n; ++k) {
      now -= 2 * factor[k] * right[k];
      for (std::size_t j = 0; j < n; ++j) now += factor[k] * factor[j] * gram[k * n + j];
    }
    if (left - now < 1e-6 * square) return std::max(0.0, now);
    left = now;
  }
  return std::max(0.0, left);
}

double unexplained(const std::vector<Rgb>& values, const std::vector<std::vector<Rgb>>& parts) {
  const std::size_t n = parts.size();
  double left = 0;
  for (int c = 0; c < 3; ++c) {
    std::vector<double> gram(n * n), right(n);
    double square = 0;
    for (const Rgb& v : values) square += v[c] * v[c];
    for (std::size_t k = 0; k < n; ++k) {
      for (std::size_t i = 0; i < values.size(); ++i) right[k] += parts[k][i][c] * values[i][c];
      for (std::size_t j = 0; j <= k; ++j) {
        for (std::size_t i = 0; i < values.size(); ++i) gram[k * n + j] += parts[k][i][c] * parts[j][i][c];
        gram[j * n + k] = gram[k * n + j];
      }
    }
    left += least_square_left(gram, right, square);
  }
  return left;
}

// Where a pixel of the view is in the file.
std::size_t in_file(const Recording& image, const Reading& reading, std::array<int, 2> at) {
  const int width = image.picture.width, height = image.picture.height;
  const int x = reading.left_right ? width - 1 - at[0] : at[0], y = reading.upside_down ? height - 1 - at[1] : at[1];
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
}

// Irradiance from a small lamp of unit intensity that nothing hides.
double unhidden(const LightSource& lamp, Vec3 position_m, Vec3 normal) {
  if (lamp.directional) return std::max(0.0, dot(normal, lamp.direction));
  const Vec3 to_lamp = lamp.position_m - position_m;
  const double square = dot(to_lamp, to_lamp);
  return square > 0 ? std::max(0.0, dot(normal, to_lamp)) / (square * std::sqrt(square)) : 0;
}

// A ray in the world, as the mesh would be met by it that is as the file has it.
struct Back {
  Mat3 linear;
  Vec3 shift_m;
};
Back taken_back(const scene::Instance& instance, const Mat3& meant_from_file) {
  const Mat3 rotation = matrix_of(instance.world_from_object.rotation);
  const Mat3 linear = rotation * inverse(meant_from_file) * transposed(rotation);
  const Vec3 origin_m = instance.world_from_object.translation_m;
  return {linear, origin_m - linear * origin_m};
}

}  // namespace

struct ReadingErrors::Sight {
  std::uint32_t surface = 0;
  Vec3 position_m, normal;
};

// Each mesh alone, and what is none.
struct ReadingErrors::Casters {
  std::vector<std::size_t> of_mesh;
  std::vector<render::RayCaster> alone;
  std::vector<std::uint32_t> surface;  // of each
  std::unique_ptr<render::RayCaster> rest;

  explicit Casters(const scene::Scene& scene) {
    std::vector<scene::Instance> others;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
      const scene::Instance& instance = scene.instances[i];
      if (!std::holds_alternative<std::shared_ptr<const mesh::Mesh>>(instance.shape)) {
        others.push_back(instance);
        continue;
      }
      of_mesh.push_back(i);
      alone.emplace_back(std::span(&instance, 1));
      surface.push_back(static_cast<std::uint32_t>(instance.surface));
    }
    if (!others.empty()) rest = std::make_unique<render::RayCaster>(others);
  }

  // `back`: one for each mesh. What is seen of nothing has the surface `sky`.
  Sight sight(Vec3 origin_m, Vec3 direction, const std::vector<Back>& back, std::uint32_t sky) const {
    double nearest_m = render::far_away;
    Sight seen{sky, {}, {}};
    if (rest != nullptr)
      if (const auto met = rest->closest(origin_m, direction))
        nearest_m = met->distance_m, seen = {met->surface, met->position_m, met->normal};
    for (std::size_t k = 0; k < alone.size(); ++k) {
      const Vec3 along = back[k].linear * direction;
      const double length = norm(along);
      const auto met = alone[k].closest(back[k].linear * origin_m + back[k].shift_m, along / length);
      if (!met || met->distance_m / length >= nearest_m) continue;
      nearest_m = met->distance_m / length;
      seen = {surface[k], origin_m + direction * nearest_m, normalized(transposed(back[k].linear) * met->normal)};
    }
    return seen;
  }
};

ReadingErrors::ReadingErrors(const scene::Scene& scene, const ImageModel& model) : scene_(scene), model_(model) {
  const std::size_t of_view = std::clamp(all_pixels / model.views(), fewest_of_view, most_of_view);
  for (std::size_t v = 0; v < model.views(); ++v) {
    const std::vector<Pixel>& pixels = model.cache(v).pixels;
    places_.emplace_back(), chosen_.emplace_back();
    const std::size_t step = std::max<std::size_t>(1, pixels.size() / of_view);
    for (std::size_t p = 0; p < pixels.size(); p += step) {
      places_.back().push_back(static_cast<std::uint32_t>(p));
      chosen_.back().push_back({pixels[p].x, pixels[p].y});
    }
  }
}

ReadingErrors::~ReadingErrors() = default;

std::vector<double> ReadingErrors::errors(const Reading& reading, const PartsOf& parts_of) const {
  const std::vector<Recording>& images = model_.recordings().images;
  std::vector<double> errors(images.size());
  parallel_for(0, images.size(), [&](std::size_t i) {
    const Recording& image = images[i];
    std::vector<std::uint32_t> kept;
    std::vector<Rgb> values;
    double square = 0, noise2 = 0;
    for (std::size_t k = 0; k < chosen_[image.view].size(); ++k) {
      const std::size_t at = in_file(image, reading, chosen_[image.view][k]);
      if (!image.counts[at]) continue;
      kept.push_back(static_cast<std::uint32_t>(k));
      const float* const v = &image.picture.data[3 * at];
      values.push_back({v[0], v[1], v[2]});
      square += dot(values.back(), values.back());
      for (std::size_t c = 0; c < 3; ++c) noise2 += squared(noise_sigma(image, v[c], 3 * at + c));
    }
    if (kept.size() < fewest_of_picture || !(square > 0)) return;
    errors[i] = std::sqrt(std::max(0.0, unexplained(values, parts_of(i, kept)) - noise2) / square);
  });
  return errors;
}

ReadingErrors::Parts ReadingErrors::lit_parts(const ViewCache& cache, std::span<const float> sums, std::size_t image,
                                              std::span<const std::uint32_t> places) const {
  const SceneState state = model_.edited(model_.layout().start, image);
  const std::size_t surfaces = state.surfaces.size();
  const std::vector<Rgb> direct = model_.direct_from(cache, sums, state, image, places);
  Parts parts(2 * surfaces + 1, std::vector<Rgb>(places.size()));
  std::size_t slot = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Pixel& pixel = cache.pixels[places[i]];
    parts[2 * surfaces][i] = Rgb{1, 1, 1} * double{pixel.sky};
    for (std::size_t f = pixel.first_facet; f < pixel.first_facet + pixel.facets; ++f, ++slot) {
      const Facet& facet = cache.facets[f];
      parts[surfaces + facet.surface][i] = facet.tint * double{facet.weight};
      if (!state.surfaces[facet.surface].model->transmits()) parts[facet.surface][i] = direct[slot];
    }
  }
  return parts;
}

std::vector<double> ReadingErrors::grey() const {
  return errors({}, [](std::size_t, std::span<const std::uint32_t> kept) {
    return Parts{std::vector<Rgb>(kept.size(), Rgb{1, 1, 1})};
  });
}

std::vector<double> ReadingErrors::as_given() const {
  std::vector<std::vector<float>> sums;
  for (std::size_t v = 0; v < model_.views(); ++v) sums.push_back(facet_sums(model_.cache(v)));
  return errors({}, [&](std::size_t image, std::span<const std::uint32_t> kept) {
    const std::size_t view = model_.recordings().images[image].view;
    std::vector<std::uint32_t> places;
    for (const std::uint32_t k : kept) places.push_back(places_[view][k]);
    return lit_parts(model_.cache(view), sums[view], image, places);
  });
}

std::vector<ReadingErrors::Sight> ReadingErrors::looked_at(const View& view,
                                                           const std::vector<std::array<int, 2>>& pixels,
                                                           const Reading& reading) const {
  std::vector<Back> back;
  for (const std::size_t i : casters_->of_mesh)
    back.push_back(std::ranges::find(reading.instances, i) == reading.instances.end()
                       ? Back{}
                       : taken_back(scene_.instances[i], reading.meant_from_file));
  const auto sky = static_cast<std::uint32_t>(model_.layout().start.surfaces.size());
  std::vector<Sight> seen(pixels.size());
  const auto look = [&](std::size_t k) {
    const camera::Ray ray = view.model.ray({static_cast<double>(pixels[k][0]), static_cast<double>(pixels[k][1])});
    seen[k] =
        casters_->sight(view.world_from_camera * ray.origin_m, view.world_from_camera.rotate(ray.direction), back, sky);
  };
  parallel_for(0, pixels.size(), look, 32);
  return seen;
}

std::vector<double> ReadingErrors::unshadowed(const Reading& reading) const {
  if (casters_ == nullptr) casters_ = std::make_unique<const Casters>(scene_);
  const SceneState& state = model_.layout().start;
  const std::size_t surfaces = state.surfaces.size();
  std::vector<LightSource> lamps;
  for (const LightSource& lamp : model_.layout().lights) lamps.push_back(meant(lamp, reading));
  std::vector<std::vector<Sight>> seen;  // [view]
  for (std::size_t v = 0; v < model_.views(); ++v)
    seen.push_back(looked_at(meant(model_.recordings().views[v], reading), chosen_[v], reading));
  return errors(reading, [&](std::size_t image, std::span<const std::uint32_t> kept) {
    const Recording& recording = model_.recordings().images[image];
    Parts parts(2 * surfaces + 1, std::vector<Rgb>(kept.size()));
    for (std::size_t i = 0; i < kept.size(); ++i) {
      const Sight& sight = seen[recording.view][kept[i]];
      parts[surfaces + sight.surface][i] = {1, 1, 1};
      if (sight.surface == surfaces) continue;
      for (const std::size_t l : recording.lights)
        parts[sight.surface][i] += state.lights[l].intensity * unhidden(lamps[l], sight.position_m, sight.normal);
    }
    return parts;
  });
}

std::vector<double> ReadingErrors::lit(const Reading& reading) const {
  scene::Scene other = scene_;
  other.instances = meant(scene_, reading);
  const render::RayCaster caster(other.instances);
  std::vector<LightSource> lamps;
  for (const LightSource& lamp : model_.layout().lights) lamps.push_back(meant(lamp, reading));
  const Tints tints(other);
  std::vector<ViewCache> caches;
  std::vector<std::vector<float>> sums;
  for (std::size_t v = 0; v < model_.views(); ++v) {
    const View view = meant(model_.recordings().views[v], reading);
    caches.push_back(build_cache(caster, view, lamps, model_.monomials(), chosen_[v], coarse));
    tints.apply(caster, view, caches.back(), coarse.samples);
    sums.push_back(facet_sums(caches.back()));
  }
  return errors(reading, [&](std::size_t image, std::span<const std::uint32_t> kept) {
    const std::size_t view = model_.recordings().images[image].view;
    return lit_parts(caches[view], sums[view], image, kept);
  });
}

}  // namespace gonio::explain::images
