// See setting.h.
#include "alignment/setting.h"

#include <algorithm>
#include <cmath>

namespace gonio::alignment {
namespace {

// Motion of a point by the numbers of one freedom, one column per number; zero where it does not depend on them.
struct Motion {
  std::array<Vec3, 3> by{};
  void turn_about(Vec3 arm) { by = {cross({1, 0, 0}, arm), cross({0, 1, 0}, arm), cross({0, 0, 1}, arm)}; }
  void shift(double sign) { by = {Vec3{sign, 0, 0}, Vec3{0, sign, 0}, Vec3{0, 0, sign}}; }
};

Motion body_motion(const Body& body, const Freedom& freedom, Vec3 mesh_point, Vec3 world) {
  Motion m;
  if (freedom.block == Block::body_turn) m.turn_about(world - body.centre_m());
  if (freedom.block == Block::body_shift) m.shift(1);
  if (freedom.block == Block::body_scale) {
    const Vec3 d = body.scale * (mesh_point - body.shape->centre_m());
    if (freedom.uniform) {
      m.by[0] = body.world_from_object.rotate(d);
    } else {
      const Mat3 r = matrix_of(body.world_from_object.rotation);
      m.by = {r * Vec3{d.x, 0, 0}, r * Vec3{0, d.y, 0}, r * Vec3{0, 0, d.z}};
    }
  }
  return m;
}

bool of_body(Block block) {
  return block == Block::body_turn || block == Block::body_shift || block == Block::body_scale;
}
bool of_ground(Block block) {
  return block == Block::ground_tilt || block == Block::ground_shift;
}
// By how much the height of `point` over the ground changes with the ground's numbers.
std::array<double, 2> ground_heights(Block block, const GroundAxes& axes, Vec3 point) {
  // The normal turns by tilt[0] about t and by tilt[1] about b: n + tilt[0] (t x n) + tilt[1] (b x n) = n - tilt[0] b +
  // tilt[1] t.
  if (block == Block::ground_shift) return {-1, 0};
  return {-dot(axes.b, point - axes.pivot_m), dot(axes.t, point - axes.pivot_m)};
}

// The shadow and what it needs.
struct Shadow {
  double a = 0, b = 0;  // heights of lamp and point
  Vec3 at;
};
Shadow shadow_of(const Ground& ground, Vec3 lamp, Vec3 point) {
  Shadow s;
  s.a = ground.height_m(lamp), s.b = ground.height_m(point);
  s.at = (point * s.a - lamp * s.b) / (s.a - s.b);
  return s;
}

}  // namespace

std::size_t numbers_of(const std::vector<Freedom>& freedoms) {
  std::size_t n = 0;
  for (const Freedom& f : freedoms) n += f.size();
  return n;
}

GroundAxes ground_axes(const Setting& setting) {
  if (!setting.ground) return {};
  const Basis basis(setting.ground->normal);
  const Vec3 centre = setting.bodies.empty() ? Vec3{} : setting.bodies[0].centre_m();
  return {basis.t, basis.b, centre - setting.ground->normal * setting.ground->height_m(centre)};
}

Rigid<frame::World, frame::Object> carried_along(const Rigid<frame::World, frame::Object>& pose, const Ground& from,
                                                 const Ground& to, Vec3 pivot_m) {
  const Vec3 axis = cross(from.normal, to.normal);
  const double sine = norm(axis), angle = std::atan2(sine, dot(from.normal, to.normal));
  const Quaternion turn = quaternion_of_rotation_vector(sine > 0 ? axis * (angle / sine) : Vec3{});
  const Vec3 place = pivot_m + matrix_of(turn) * (pose.translation_m - pivot_m);
  return {normalized(turn * pose.rotation), place - to.normal * to.height_m(place)};
}

Setting moved(const Setting& setting, const std::vector<Freedom>& freedoms, const std::vector<double>& change) {
  Setting out = setting;
  std::size_t k = 0;
  const GroundAxes axes = ground_axes(setting);
  for (const Freedom& f : freedoms) {
    const Vec3 v = f.size() == 3 ? Vec3{change[k], change[k + 1], change[k + 2]} : Vec3{};
    if (f.block == Block::body_turn) {
      Body& body = out.bodies[f.which];
      const Vec3 centre = body.centre_m();
      body.world_from_object.rotation = normalized(quaternion_of_rotation_vector(v) * body.world_from_object.rotation);
      body.world_from_object.translation_m += centre - body.centre_m();
    } else if (f.block == Block::body_shift) {
      out.bodies[f.which].world_from_object.translation_m += v;
    } else if (f.block == Block::body_scale) {
      const Vec3 factor =
          f.uniform ? Vec3{1, 1, 1} * std::exp(change[k]) : Vec3{std::exp(v.x), std::exp(v.y), std::exp(v.z)};
      out.bodies[f.which].scale *= factor;
    } else if (f.block == Block::station_turn) {
      auto& pose = out.stations[f.which].world_from_camera;
      pose.rotation = normalized(quaternion_of_rotation_vector(v) * pose.rotation);
    } else if (f.block == Block::station_shift) {
      out.stations[f.which].world_from_camera.translation_m += v;
    } else if (f.block == Block::lens_focal) {
      out.lenses[f.which].fx_px *= std::exp(change[k]), out.lenses[f.which].fy_px *= std::exp(change[k]);
    } else if (f.block == Block::lamp_shift) {
      out.lamps_m[f.which] += v;
    } else if (f.block == Block::ground_tilt) {
      Ground& g = *out.ground;
      const double lift = g.height_m(axes.pivot_m);
      g.normal = normalized(g.normal - axes.b * change[k] + axes.t * change[k + 1]);
      g.offset_m = dot(g.normal, axes.pivot_m) - lift;
    } else {
      out.ground->offset_m += change[k];
    }
    k += f.size();
  }
  return out;
}

std::vector<double> change_between(const Setting& from, const Setting& to, const std::vector<Freedom>& freedoms) {
  std::vector<double> change;
  const auto add = [&](Vec3 v) { change.insert(change.end(), {v.x, v.y, v.z}); };
  const auto turn = [&](const Quaternion& a, const Quaternion& b) {
    add(rotation_vector_of(normalized(b * conjugate(a))));
  };
  const GroundAxes axes = ground_axes(from);
  for (const Freedom& f : freedoms) {
    const std::size_t w = f.which;
    if (f.block == Block::body_turn)
      turn(from.bodies[w].world_from_object.rotation, to.bodies[w].world_from_object.rotation);
    if (f.block == Block::body_shift) add(to.bodies[w].centre_m() - from.bodies[w].centre_m());
    if (f.block == Block::body_scale) {
      const Vec3 a = from.bodies[w].scale, b = to.bodies[w].scale;
      const Vec3 ratio{std::log(b.x / a.x), std::log(b.y / a.y), std::log(b.z / a.z)};
      if (f.uniform)
        change.push_back(mean(ratio));
      else
        add(ratio);
    }
    if (f.block == Block::station_turn)
      turn(from.stations[w].world_from_camera.rotation, to.stations[w].world_from_camera.rotation);
    if (f.block == Block::station_shift)
      add(to.stations[w].world_from_camera.translation_m - from.stations[w].world_from_camera.translation_m);
    if (f.block == Block::lens_focal) change.push_back(std::log(to.lenses[w].fx_px / from.lenses[w].fx_px));
    if (f.block == Block::lamp_shift) add(to.lamps_m[w] - from.lamps_m[w]);
    if (f.block == Block::ground_tilt)
      change.insert(change.end(), {-dot(axes.b, to.ground->normal), dot(axes.t, to.ground->normal)});
    if (f.block == Block::ground_shift) change.push_back(-to.ground->height_m(axes.pivot_m));
  }
  return change;
}

Projected project(const Setting& setting, std::size_t station, Vec3 world) {
  const Station& s = setting.stations[station];
  const Lens& lens = setting.lenses[s.lens];
  const Vec3 p = transposed(matrix_of(s.world_from_camera.rotation)) * (world - s.world_from_camera.translation_m);
  return {{lens.cx_px + lens.fx_px * p.x / p.z, lens.cy_px + lens.fy_px * p.y / p.z}, p.z};
}

Projected project_shadow(const Setting& setting, std::size_t station, std::size_t lamp, Vec3 world) {
  const Shadow s = shadow_of(*setting.ground, setting.lamps_m[lamp], world);
  if (!(s.a - s.b > 0)) return {{}, -1};
  Projected p = project(setting, station, s.at);
  p.weight *= s.a - s.b;
  return p;
}

void slopes_of(const Setting& setting, const std::vector<Freedom>& freedoms, const GroundAxes& axes,
               std::size_t station, std::size_t body, std::optional<std::size_t> lamp, Vec3 mesh_point, Vec2 normal,
               double* row) {
  const Station& s = setting.stations[station];
  const Lens& lens = setting.lenses[s.lens];
  const Body& b = setting.bodies[body];
  const Vec3 world = b.place_m(mesh_point);
  const Shadow shadow = lamp ? shadow_of(*setting.ground, setting.lamps_m[*lamp], world) : Shadow{1, 0, world};
  const Vec3 seen = shadow.at;
  const Mat3 rotation = matrix_of(s.world_from_camera.rotation);
  const Vec3 p = transposed(rotation) * (seen - s.world_from_camera.translation_m);
  // d(normal . pixel) / d(seen), in the world.
  const Vec3 in_camera{normal.x * lens.fx_px / p.z, normal.y * lens.fy_px / p.z,
                       -(normal.x * lens.fx_px * p.x + normal.y * lens.fy_px * p.y) / (p.z * p.z)};
  const Vec3 by_seen = rotation * in_camera;
  Vec3 by_world = by_seen, by_lamp{};
  const double span = shadow.a - shadow.b;
  if (lamp) {
    const Vec3 n = setting.ground->normal, to_lamp = seen - setting.lamps_m[*lamp];
    by_world = by_seen * (shadow.a / span) + n * (dot(by_seen, to_lamp) / span);
    by_lamp = by_seen * (-shadow.b / span) + n * (dot(by_seen, world - seen) / span);
  }
  std::size_t k = 0;
  for (const Freedom& f : freedoms) {
    const std::size_t count = f.size();
    for (std::size_t i = 0; i < count; ++i) row[k + i] = 0;
    Motion m;
    Vec3 by = by_world;
    if (of_body(f.block) && f.which == body) {
      m = body_motion(b, f, mesh_point, world);
    } else if (f.block == Block::station_turn && f.which == station) {
      m.turn_about(s.world_from_camera.translation_m - seen), by = by_seen;
    } else if (f.block == Block::station_shift && f.which == station) {
      m.shift(-1), by = by_seen;
    } else if (f.block == Block::lamp_shift && lamp && f.which == *lamp) {
      m.shift(1), by = by_lamp;
    } else if (f.block == Block::lens_focal && f.which == s.lens) {
      row[k] = (normal.x * lens.fx_px * p.x + normal.y * lens.fy_px * p.y) / p.z;
    } else if (of_ground(f.block) && lamp) {
      const Vec3 at = setting.lamps_m[*lamp];
      const auto da = ground_heights(f.block, axes, at), db = ground_heights(f.block, axes, world);
      for (std::size_t i = 0; i < count; ++i)
        row[k + i] = (da[i] * dot(by_seen, world - seen) - db[i] * dot(by_seen, at - seen)) / span;
    }
    if (!of_ground(f.block) && f.block != Block::lens_focal)
      for (std::size_t i = 0; i < count; ++i) row[k + i] = dot(by, m.by[i]);
    k += count;
  }
}

double height_of(const Setting& setting, std::size_t body, Vec3 mesh_point) {
  return setting.ground->height_m(setting.bodies[body].place_m(mesh_point));
}

void height_slopes(const Setting& setting, const std::vector<Freedom>& freedoms, const GroundAxes& axes,
                   std::size_t body, Vec3 mesh_point, double* row) {
  const Body& b = setting.bodies[body];
  const Vec3 world = b.place_m(mesh_point);
  std::size_t k = 0;
  for (const Freedom& f : freedoms) {
    for (std::size_t i = 0; i < f.size(); ++i) row[k + i] = 0;
    if (of_body(f.block) && f.which == body) {
      const Motion m = body_motion(b, f, mesh_point, world);
      for (std::size_t i = 0; i < f.size(); ++i) row[k + i] = dot(setting.ground->normal, m.by[i]);
    }
    if (of_ground(f.block)) {
      const auto d = ground_heights(f.block, axes, world);
      for (std::size_t i = 0; i < f.size(); ++i) row[k + i] = d[i];
    }
    k += f.size();
  }
}

}  // namespace gonio::alignment
