// surface.spatial-variation: one stain on each surface that a single object bears. Its search starts where a stain
// takes most from the rough residual: over sights as middles and some widths, the fall of the squares when one depth is
// fitted to all images, each with a level of its own; then again about the best of them. Residuals beyond a few of
// their own widths (edges of shadows, gloss) count as that much.
#include <algorithm>
#include <array>
#include <cmath>

#include "relighting/image_model.h"
#include "relighting/rough.h"
#include "relighting/uses.h"
#include "stats/intervals.h"
#include "surface/stain.h"

namespace gonio::mechanism {
const Mechanism& surface_spatial_variation();
}

namespace gonio::relighting::terms {
namespace {

constexpr std::size_t most_middles = 150, most_refined = 60, most_seen = 10000;
constexpr std::array<double, 5> widths = {0.015, 0.03, 0.06, 0.12, 0.24};  // of the object's extent
constexpr std::array<double, 3> finer_widths = {0.7, 1, 1.4};              // of the best of them
constexpr double most_sigmas = 3;                                          // of a residual, robustly taken

struct Spot {
  Vec3 middle_m;
  double width_m = 0, depth = 0, gain = 0;
};
struct Seen {
  std::size_t image;
  Vec3 position_m;
  double relative;
};

// Evenly, to as many as a start needs.
void thin(std::vector<Seen>& seen) {
  const std::size_t step = 1 + seen.size() / most_seen;
  for (std::size_t k = 0; k * step < seen.size(); ++k) seen[k] = seen[k * step];
  seen.resize((seen.size() + step - 1) / step);
}

// No residual further from its image's median than `most_sigmas`.
void clip(std::vector<Seen>& seen, std::size_t images) {
  for (std::size_t i = 0; i < images; ++i) {
    std::vector<double> own;
    for (const Seen& s : seen)
      if (s.image == i) own.push_back(s.relative);
    if (own.empty()) continue;
    const double middle = stats::median(own), reach = most_sigmas * stats::robust_sigma(own);
    for (Seen& s : seen)
      if (s.image == i) s.relative = std::clamp(s.relative - middle, -reach, reach);
  }
}

// By least squares: depth = sum g r / sum g^2, g the stain's shape less its mean in the image; the fall is the
// numerator squared over the denominator.
Spot judged(const std::vector<Seen>& seen, std::size_t images, Vec3 middle, double width) {
  std::vector<double> shape(seen.size()), level(images), residual(images), count(images);
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const Vec3 d = seen[k].position_m - middle;
    shape[k] = std::exp(-0.5 * dot(d, d) / (width * width));
    level[seen[k].image] += shape[k], residual[seen[k].image] += seen[k].relative, count[seen[k].image] += 1;
  }
  double product = 0, square = 0;
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const std::size_t i = seen[k].image;
    const double g = shape[k] - level[i] / count[i];
    product += g * (seen[k].relative - residual[i] / count[i]), square += g * g;
  }
  if (!(square > 3)) return {};  // some few sights alone
  return {middle, width, product / square, product * product / square};
}

Spot best_spot(const std::vector<Seen>& seen, std::size_t images, double extent) {
  Spot best;
  const auto look = [&](Vec3 middle, double width) {
    if (const Spot spot = judged(seen, images, middle, width); spot.gain > best.gain) best = spot;
  };
  const std::size_t stride = std::max<std::size_t>(1, seen.size() / most_middles);
  for (std::size_t i = 0; i < seen.size(); i += stride)
    for (const double share : widths) look(seen[i].position_m, share * extent);
  if (!(best.gain > 0)) return best;
  const Spot rough = best;
  std::vector<std::size_t> near;
  for (std::size_t i = 0; i < seen.size(); ++i)
    if (norm(seen[i].position_m - rough.middle_m) < 1.5 * rough.width_m) near.push_back(i);
  const std::size_t step = std::max<std::size_t>(1, near.size() / most_refined);
  for (std::size_t k = 0; k < near.size(); k += step)
    for (const double factor : finer_widths) look(seen[near[k]].position_m, factor * rough.width_m);
  return best;
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
    thin(seen);
    const double extent = norm(upper - lower);
    clip(seen, s.recordings.images.size());
    const Spot best = best_spot(seen, s.recordings.images.size(), extent);
    if (!(best.gain > 0)) continue;
    Use use = target_use(mechanism::surface_spatial_variation(), {s.layout.surfaces[k]}, {k}, false);
    const double start[5] = {best.middle_m.x, best.middle_m.y, best.middle_m.z, best.width_m,
                             std::clamp(best.depth, -0.5, 0.5)};
    for (std::size_t i = 0; i < 5; ++i) use.numbers[i].start = start[i];
    for (std::size_t i = 0; i < 3; ++i) {
      use.numbers[i].neutral = use.numbers[i].start;  // without a depth no place counts
      use.numbers[i].lower = use.numbers[i].start - extent;
      use.numbers[i].upper = use.numbers[i].start + extent;
    }
    use.numbers[3].neutral = use.numbers[3].start;
    use.numbers[3].lower = 0.005 * extent;
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
