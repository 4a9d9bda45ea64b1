#include "render/subsurface_walk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "surface/hemisphere.h"

namespace gonio::render {
namespace {

constexpr double side_lines = 0.6;  // along tangents, on average

double mean_density(const surface::Subsurface& beneath, double distance_m) {
  double mean = 0;
  for (int band = 0; band < 3; ++band) mean += beneath.distance_density(band, distance_m) / 3;
  return mean;
}

// How far to look along an axis, at a distance on the plane: farther than t with the chance 1 / sqrt(1 + (t / c)^2).
class Span {
 public:
  explicit Span(double density) : scale_m_(std::sqrt(2 / (pi * density))) {}
  double half_m(double u) const { return scale_m_ * std::sqrt(1 / (u * u) - 1); }
  double chance(double t) const { return 1 / std::sqrt(1 + t * t / (scale_m_ * scale_m_)); }

 private:
  double scale_m_;
};

struct Line {
  Vec3 origin_m, along;
  double length_m = 0;
};
struct Candidate {
  const Line* line = nullptr;
  LineMark mark;
  double per_area = 0;  // had it been the only one
  double appeal = 0;    // density at the straight distance
};

class EntrySearch {
 public:
  EntrySearch(const RayCaster& caster, const surface::Subsurface& beneath, const SurfacePoint& exit)
      : caster_(caster), beneath_(beneath), exit_(exit), axes_(exit.geometric_normal) {
    marks_.reserve(8);
    candidates_.reserve(8);
  }

  void look(Line& line, Vec3 axis, Vec2 disc, Vec2 rest) {
    const double distance_m = beneath_.sample_distance(std::min(2, static_cast<int>(3 * rest.x)), disc.x);
    const double phi = 2 * pi * disc.y, reach_m = beneath_.reach_m();
    const Basis basis(axis);
    const Span span(mean_density(beneath_, distance_m));
    const double half_m =
        std::min(span.half_m(rest.y), std::sqrt(std::max(0.0, (reach_m - distance_m) * (reach_m + distance_m))));
    const Vec3 foot = (basis.t * std::cos(phi) + basis.b * std::sin(phi)) * distance_m;
    line = {exit_.position_m + foot + axis * half_m, -axis, 2 * half_m};
    marks_.clear();
    caster_.mark(exit_.instance, line.origin_m, line.along, line.length_m, marks_);
    for (const LineMark& mark : marks_) {
      const double height_m = half_m - mark.distance_m;
      const Vec3 arm = foot + axis * height_m;
      const double appeal = mean_density(beneath_, norm(arm));
      const double density = density_per_area(arm, mark.geometric_normal) * span.chance(height_m);
      if (appeal > 0 && density > 0) candidates_.push_back({&line, mark, 1 / density, appeal});
    }
  }
  Vec3 axis(int k) const { return k == 0 ? axes_.n : k == 1 ? axes_.t : axes_.b; }

  std::optional<EntryPoint> choose(double u) const {
    double sum = 0;
    for (const Candidate& c : candidates_) sum += c.per_area * c.appeal;
    double left = u * sum;
    for (const Candidate& c : candidates_) {
      left -= c.per_area * c.appeal;
      if (left > 0 && &c != &candidates_.back()) continue;
      const Line& line = *c.line;
      const SurfacePoint met = caster_.marked(exit_.instance, line.origin_m, line.along, line.length_m, c.mark);
      return EntryPoint{on_side_of(exit_, met), sum / c.appeal};
    }
    return {};
  }

 private:
  double density_per_area(Vec3 arm, Vec3 normal) const {
    double density = 0;
    for (int k = 0; k < 3; ++k) {
      const double distance_m = norm(arm - axis(k) * dot(arm, axis(k)));
      const double lines = k == 0 ? 1 : side_lines / 2;
      density += lines * std::abs(dot(normal, axis(k))) * mean_density(beneath_, distance_m);
    }
    return density;
  }

  const RayCaster& caster_;
  const surface::Subsurface& beneath_;
  const SurfacePoint& exit_;
  Basis axes_;
  std::vector<LineMark> marks_;
  std::vector<Candidate> candidates_;
};

}  // namespace

SurfacePoint on_side_of(const SurfacePoint& exit, const SurfacePoint& point) {
  return point.outside == exit.outside ? point : beyond(point);
}

std::optional<EntryPoint> draw_entry(const RayCaster& caster, const surface::Subsurface& beneath,
                                     const SurfacePoint& exit, Sampler& sampler) {
  EntrySearch search(caster, beneath, exit);
  std::array<Line, 2> lines;
  const Vec2 choice = sampler.two(), disc = sampler.two(), rest = sampler.two();
  search.look(lines[0], search.axis(0), disc, rest);
  if (choice.x < side_lines) {
    const Vec2 side_disc = sampler.two(), side_rest = sampler.two();
    search.look(lines[1], search.axis(choice.x < side_lines / 2 ? 1 : 2), side_disc, side_rest);
  }
  return search.choose(choice.y);
}

Rgb EntryModel::evaluate(const surface::Values& values, Vec3, Vec3 wi) const {
  if (wi.z <= 0) return {};
  const surface::Entrance entrance = beneath_.enter(values, wi, facet_);
  const surface::SubsurfaceEntry entry{entry_.point.position_m, entry_.point.normal, frame_.to_world(entrance.onwards)};
  return beneath_.evaluate(entry, exit_.position_m, exit_.normal) * (entrance.share * entry_.per_area);
}

surface::Sample EntryModel::sample(const surface::Values& values, Vec3 wo, Vec2 u, double) const {
  const Vec3 wi = surface::cosine_direction(u);
  if (wi.z <= 0) return {};
  return {wi, evaluate(values, wo, wi) * pi, surface::cosine_density(wi)};
}

double EntryModel::pdf(const surface::Values&, Vec3, Vec3 wi) const {
  return surface::cosine_density(wi);
}

}  // namespace gonio::render
