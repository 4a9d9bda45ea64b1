#include "render/media.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace gonio::render {
namespace {

std::optional<surface::Medium> interior(const scene::Scene& scene, const scene::Instance& instance) {
  const scene::Surface& surface = scene.appearance.surfaces[instance.surface];
  return surface.model->transmits() ? surface.model->interior(surface.values) : std::nullopt;
}

Rgb index_of(const surface::Medium* medium) {
  return medium ? medium->eta : Rgb{1, 1, 1};
}

}  // namespace

void Inside::enter(std::uint32_t rank) {
  if (count_ == entries_.size()) return;
  std::uint32_t place = count_++;
  for (; place > 0 && entries_[place - 1] > rank; --place) entries_[place] = entries_[place - 1];
  entries_[place] = rank;
}

void Inside::leave(std::uint32_t rank) {
  std::uint32_t place = 0;
  while (place < count_ && entries_[place] != rank) ++place;
  if (place == count_) return;
  for (--count_; place < count_; ++place) entries_[place] = entries_[place + 1];
}

Rgb transmittance(const surface::Medium& medium, double distance_m) {
  const auto one = [&](double sigma) { return sigma > 0 ? std::exp(-sigma * distance_m) : 1; };
  const Rgb sigma = medium.sigma_a_per_m + medium.sigma_s_per_m;
  return {one(sigma.x), one(sigma.y), one(sigma.z)};
}

Media::Media(const scene::Scene& scene, const RayCaster& caster) : caster_(caster) {
  const auto& all = scene.instances;
  for (std::uint32_t i = 0; i < all.size(); ++i)
    if (interior(scene, all[i])) instances_.push_back(i);
  std::ranges::stable_sort(instances_, [&](auto a, auto b) { return all[a].priority > all[b].priority; });
  rank_.assign(all.size(), none);
  for (std::uint32_t rank = 0; rank < instances_.size(); ++rank) {
    rank_[instances_[rank]] = rank;
    media_.push_back(*interior(scene, all[instances_[rank]]));
    may_pass_ = may_pass_ || media_.back().eta == Rgb{1, 1, 1};
  }
  may_pass_ = may_pass_ || media_.size() > 1;
}

Crossing Media::crossing(const Inside& inside, const SurfacePoint& point) const {
  Crossing result{.here = at(inside), .beyond = nullptr, .inside_beyond = inside};
  const std::uint32_t rank = rank_[point.instance];
  if (rank == none) {  // a thin sheet, or nothing passes
    result.beyond = result.here;
    return result;
  }
  if (point.outside)
    result.inside_beyond.enter(rank);
  else
    result.inside_beyond.leave(rank);
  result.beyond = at(result.inside_beyond);
  const Rgb here = index_of(result.here), beyond = index_of(result.beyond);
  result.eta = {beyond.x / here.x, beyond.y / here.y, beyond.z / here.z};
  result.passes = result.here == result.beyond || here == beyond;
  return result;
}

Inside Media::around(Vec3 position_m) const {
  // Directions without symmetry, so that no two run along an edge of the same mesh.
  const std::array<Vec3, 3> directions = {normalized(Vec3{0.31, 0.19, 0.93}), normalized(Vec3{-0.73, 0.58, -0.36}),
                                          normalized(Vec3{0.41, -0.85, -0.33})};
  Inside inside;
  for (std::uint32_t rank = 0; rank < media_.size(); ++rank) {
    const auto met_from_inside = [&](Vec3 direction) {
      const auto found = caster_.crossings(instances_[rank], position_m, direction, far_away);
      return !found.empty() && !found.front().outside;
    };
    if (std::ranges::count_if(directions, met_from_inside) >= 2) inside.enter(rank);
  }
  return inside;
}

Rgb Media::clear(const SurfacePoint* from, Vec3 origin_m, const Inside& inside, Vec3 direction,
                 double distance_m) const {
  if (may_pass()) return walk(from, origin_m, inside, direction, distance_m);
  if (from ? caster_.occluded(*from, direction, distance_m) : caster_.blocked(origin_m, direction, distance_m))
    return {};
  const surface::Medium* medium = at(inside);
  return medium ? transmittance(*medium, distance_m) : Rgb{1, 1, 1};
}

Rgb Media::walk(const SurfacePoint* from, Vec3 origin_m, Inside inside, Vec3 direction, double distance_m) const {
  if (from && !(dot(from->geometric_normal, direction) > 0)) return {};
  Rgb share{1, 1, 1};
  auto met = from ? caster_.closest_from(*from, direction) : caster_.closest(origin_m, direction);
  for (double left = distance_m;;) {
    const double step = met ? std::min(met->distance_m, left) : left;
    if (const surface::Medium* medium = at(inside)) share *= transmittance(*medium, step);
    if (!met || !(met->distance_m < left)) return share;
    if (!(max_component(share) > 0)) return {};
    const Crossing crossing = this->crossing(inside, *met);
    if (!crossing.passes) return {};
    left -= step;
    inside = crossing.inside_beyond;
    met = caster_.closest_from(beyond(*met), direction);
  }
}

}  // namespace gonio::render
