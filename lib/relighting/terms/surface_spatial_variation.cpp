// surface.spatial-variation: one stain on each surface that a single object bears. Its search starts where the rough
// residual is most alike in all images: over sights as middles and a few widths, the mean residual inside less that
// outside, image by image, in standard errors over the images.
#include <algorithm>
#include <cmath>

#include "relighting/image_model.h"
#include "relighting/rough.h"
#include "relighting/uses.h"
#include "surface/stain.h"

namespace gonio::mechanism {
const Mechanism& surface_spatial_variation();
}

namespace gonio::relighting::terms {
namespace {

constexpr std::size_t most_middles = 150;
constexpr std::array<double, 3> widths = {0.08, 0.16, 0.3};  // of the object's extent

struct Spot {
  Vec3 middle_m;
  double width_m = 0, depth = 0, score = 0;
};
struct Seen {
  std::size_t image;
  Vec3 position_m;
  double relative;
};

// Residual inside less outside, as a t over the images that see both.
Spot judged(const std::vector<Seen>& seen, std::size_t images, Vec3 middle, double width) {
  std::vector<double> in(images), n_in(images), out(images), n_out(images);
  for (const Seen& s : seen) {
    const Vec3 d = s.position_m - middle;
    const bool inside = dot(d, d) < width * width;
    (inside ? in : out)[s.image] += s.relative;
    (inside ? n_in : n_out)[s.image] += 1;
  }
  double sum = 0, square = 0, n = 0;
  for (std::size_t i = 0; i < images; ++i) {
    if (n_in[i] < 3 || n_out[i] < 3) continue;
    const double change = in[i] / n_in[i] - out[i] / n_out[i];
    sum += change, square += change * change, n += 1;
  }
  if (n < 2) return {};
  const double mean = sum / n, variance = std::max(square / n - mean * mean, 1e-6) / (n - 1);
  return {middle, width, mean, std::abs(mean) / std::sqrt(variance + 1e-4)};
}

std::vector<Use> candidates(const Setting& s) {
  const RoughResidual rough = rough_residual(s);
  std::vector<Use> uses;
  for (std::size_t k = 0; k < s.layout.surfaces.size(); ++k) {
    const auto bears = [&](const scene::Instance& i) { return i.surface == k; };
    const auto object = std::find_if(s.scene.instances.begin(), s.scene.instances.end(), bears);
    if (std::count_if(s.scene.instances.begin(), s.scene.instances.end(), bears) != 1 ||
        !has_parameter(*s.layout.start.surfaces[k].model, "albedo") ||
        switched_on(s.document, mechanism::surface_spatial_variation().id, s.layout.surfaces[k]))
      continue;
    const auto object_from_world = inverse(object->world_from_object);
    std::vector<Seen> seen;
    Vec3 lower{1e30, 1e30, 1e30}, upper = -lower;
    for (const RoughResidual::Sight& sight : rough.sights) {
      if (sight.surface != k) continue;
      const ViewCache& cache = s.model.cache(s.recordings.images[sight.image].view);
      const Vec3 p = object_from_world * cache.patches[cache.facets[sight.facet].first_patch].position_m;
      seen.push_back({sight.image, p, std::clamp(sight.relative, -1.0, 1.0)});
      lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
      upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
    }
    if (seen.size() < 50) continue;
    const double extent = norm(upper - lower);
    Spot best;
    const std::size_t stride = std::max<std::size_t>(1, seen.size() / most_middles);
    for (std::size_t i = 0; i < seen.size(); i += stride)
      for (const double share : widths) {
        const Spot spot = judged(seen, s.recordings.images.size(), seen[i].position_m, share * extent);
        if (spot.score > best.score) best = spot;
      }
    if (!(best.score > 0)) continue;
    Use use = target_use(mechanism::surface_spatial_variation(), {s.layout.surfaces[k]}, {k}, false);
    const double start[5] = {best.middle_m.x, best.middle_m.y, best.middle_m.z, 0.7 * best.width_m,
                             std::clamp(best.depth, -0.5, 0.5)};
    for (std::size_t i = 0; i < 5; ++i) use.numbers[i].start = start[i];
    for (std::size_t i = 0; i < 3; ++i) {
      use.numbers[i].neutral = use.numbers[i].start;  // without a depth no place counts
      use.numbers[i].lower = use.numbers[i].start - extent;
      use.numbers[i].upper = use.numbers[i].start + extent;
    }
    use.numbers[3].neutral = use.numbers[3].start;
    use.numbers[3].lower = 0.02 * extent;
    use.numbers[3].upper = extent;
    uses.push_back(use);
  }
  return uses;
}

struct Frames final : Prepared {
  Rigid<frame::Object, frame::World> object_from_world;
};
std::shared_ptr<const Prepared> prepare(const Setting& s, const Use& use) {
  auto result = std::make_shared<Frames>();
  for (const scene::Instance& i : s.scene.instances)
    if (i.surface == use.targets[0]) result->object_from_world = inverse(i.world_from_object);
  return result;
}

void shade(const Use& use, const Frame& frame, Shading& shading) {
  const std::span<const double> a = use.amounts(frame.state);
  const auto& pose = static_cast<const Frames&>(*use.prepared).object_from_world;
  const Mat3 rotation = matrix_of(pose.rotation);
  std::size_t slot = 0;
  for (const std::uint32_t p : frame.picked)
    for (std::size_t k = 0; k < frame.cache.pixels[p].facets; ++k, ++slot) {
      const Facet& facet = frame.cache.facets[frame.cache.pixels[p].first_facet + k];
      if (facet.surface != use.targets[0]) continue;
      const Vec3 place = rotation * frame.cache.patches[facet.first_patch].position_m + pose.translation_m;
      const double factor = surface::stain(place, {a[0], a[1], a[2]}, a[3], a[4]);
      for (std::size_t j = 0; j < shading.lights; ++j)
        shading.direct[slot * shading.lights + j].base = shading.direct[slot * shading.lights + j].base * factor;
      shading.indirect[slot].base = shading.indirect[slot].base * factor;
    }
}

}  // namespace

const Term& surface_spatial_variation() {
  static const Term term{
      .mechanism = mechanism::surface_spatial_variation,
      .reach = Reach::shade,
      .order = 10,
      .candidates = candidates,
      .prepare = prepare,
      .shade = shade,
  };
  return term;
}

}  // namespace gonio::relighting::terms
