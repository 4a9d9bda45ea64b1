// See way_check.h.
#include "acquisition/way_check.h"

#include <algorithm>
#include <cmath>

#include "acquisition/solid_geometry.h"

namespace gonio::tests {
namespace {

using acquisition::Joints;
using acquisition::Laboratory;
using acquisition::Solid;
using acquisition::State;

struct Checked {
  const Solid* solid;
  std::vector<Vec3> points;  // own coordinates
  double radius_m = 0;
};

struct At {
  Mat3 rotation;
  Vec3 origin_m;
  Vec3 world(Vec3 p) const { return rotation * p + origin_m; }
  Vec3 local(Vec3 p) const { return transposed(rotation) * (p - origin_m); }
};

std::vector<At> places(const Laboratory& laboratory, const std::vector<Checked>& solids, const State& state) {
  std::map<std::string, std::vector<robot::LinkFrame>> frames;
  for (const auto& [name, arm] : laboratory.arms) frames[name] = robot::link_frames(arm.links, joints_of(arm, state));
  std::vector<At> at;
  for (const Checked& c : solids) {
    Rigid<frame::World, frame::Object> place = c.solid->placed;
    if (!c.solid->arm.empty()) {
      const robot::LinkFrame& f = frames[c.solid->arm][static_cast<std::size_t>(c.solid->link)];
      const Rigid<frame::Base, frame::World> link{quaternion_of(f.rotation), f.origin_m};
      const auto moved = laboratory.arms.at(c.solid->arm).world_from_base * (link * place);
      place = {moved.rotation, moved.translation_m};
    }
    at.push_back({matrix_of(place.rotation), place.translation_m});
  }
  return at;
}

bool may_meet(const Solid& a, const Solid& b) {
  const auto still = [](const Solid& s) { return s.arm.empty() || s.link == 0; };
  if (still(a) && still(b)) return true;
  if (a.arm != b.arm) return false;
  return a.link == b.link || (std::abs(a.link - b.link) == 1 && !a.carried && !b.carried);
}

}  // namespace

WayCheck check_way(const Laboratory& laboratory, const acquisition::Way& way, double step_m, double spacing_m) {
  std::vector<Checked> solids;
  const auto add = [&](const Solid& s) {
    if (s.shape == Solid::Shape::mesh) return;
    Checked c{&s, surface_points(s, spacing_m)};
    if (c.points.size() > 3000 && s.arm.empty()) c.points.clear();  // a table: arms' points in it tell
    c.radius_m = s.shape == Solid::Shape::box ? norm(s.sides_m) / 2 : 0;
    for (const Vec3& p : c.points) c.radius_m = std::max(c.radius_m, norm(p));
    solids.push_back(std::move(c));
  };
  for (const auto& [name, arm] : laboratory.arms)
    for (const Solid& s : arm.solids) add(s);
  for (const Solid& s : laboratory.obstacles) add(s);

  WayCheck check;
  const auto look = [&](const std::vector<At>& at) {
    ++check.steps;
    for (std::size_t a = 0; a < solids.size(); ++a)
      for (std::size_t b = 0; b < solids.size(); ++b) {
        if (a == b || may_meet(*solids[a].solid, *solids[b].solid)) continue;
        const double apart = norm(at[a].origin_m - at[b].origin_m) - solids[a].radius_m - solids[b].radius_m;
        if (apart > std::min(check.nearest_m, 0.03)) continue;
        const double reach = solids[b].radius_m + 0.03;
        for (const Vec3& p : solids[a].points) {
          const Vec3 off = at[a].world(p) - at[b].origin_m;
          if (dot(off, off) > reach * reach) continue;
          const double d = signed_distance(*solids[b].solid, at[b].local(at[a].world(p)));
          if (d < check.nearest_m)
            check.nearest_m = d, check.first = solids[a].solid->name, check.second = solids[b].solid->name;
        }
      }
  };
  for (std::size_t i = 0; i + 1 < way.size(); ++i) {
    const auto mixed = [&](double t) {
      State state;
      for (const auto& [name, arm] : laboratory.arms) {
        const Joints &from = joints_of(arm, way[i]), &to = joints_of(arm, way[i + 1]);
        for (std::size_t k = 0; k < from.size(); ++k) state[name].push_back(from[k] + t * (to[k] - from[k]));
      }
      return places(laboratory, solids, state);
    };
    // The fastest point, looked for on sixteen stretches of the line.
    double fastest = 0;
    std::vector<At> before = mixed(0);
    for (int k = 1; k <= 16; ++k) {
      const std::vector<At> now = mixed(k / 16.0);
      double moved = 0;
      for (std::size_t s = 0; s < solids.size(); ++s)
        for (std::size_t p = 0; p < solids[s].points.size(); p += 7)
          moved = std::max(moved, norm(now[s].world(solids[s].points[p]) - before[s].world(solids[s].points[p])));
      fastest = std::max(fastest, 16 * moved);
      before = now;
    }
    const int steps = std::max(1, static_cast<int>(std::ceil(fastest / step_m)));
    for (int k = i == 0 ? 0 : 1; k <= steps; ++k) look(mixed(double(k) / steps));
  }
  return check;
}

}  // namespace gonio::tests
