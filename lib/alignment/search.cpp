// See search.h.
#include "alignment/search.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"

namespace gonio::alignment {
namespace {

// `count` directions spread over the sphere (Fibonacci lattice: Swinbank & Purser 2006).
std::vector<Vec3> directions(int count) {
  std::vector<Vec3> out;
  const double golden = pi * (3 - std::sqrt(5.0));
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, r = std::sqrt(std::max(0.0, 1 - z * z));
    out.push_back({r * std::cos(golden * i), r * std::sin(golden * i), z});
  }
  return out;
}

// A rotation that takes unit `from` to unit `to`.
Quaternion turn_to(Vec3 from, Vec3 to) {
  const Vec3 axis = cross(from, to);
  const double c = dot(from, to);
  if (c < -1 + 1e-12) {
    const Basis basis(from);
    return {0, basis.t.x, basis.t.y, basis.t.z};
  }
  return normalized(Quaternion{1 + c, axis.x, axis.y, axis.z});
}

struct Look {  // of a region: where, how large, along what axis
  double area = 0, angle = 0, elongation = 0;
  Vec2 middle;
  std::array<double, 7> hu{};
};
Look look_of(const Moments& m, Vec2 origin) {
  Look l;
  l.area = m.m00;
  if (!(l.area > 0)) return l;
  l.middle = origin + Vec2{m.m10 / m.m00, m.m01 / m.m00};
  const Moments c = about_middle(m);
  l.angle = 0.5 * std::atan2(2 * c.m11, c.m20 - c.m02);
  l.elongation = std::hypot(c.m20 - c.m02, 2 * c.m11) / (c.m20 + c.m02);
  l.hu = hu_invariants(c);
  return l;
}

double apart(const std::array<double, 7>& a, const std::array<double, 7>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < 6; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

// Poses of the body in the frame of the station that sees it best.
class Poses {
 public:
  Poses(const Setting& stated, std::size_t body, std::size_t station, bool move_station)
      : stated_(stated), body_(body), station_(station), move_station_(move_station) {
    const Station& s = stated.stations[station];
    lens_ = stated.lenses[s.lens];
  }
  // The setting in which the body's centre lies on the ray of `pixel` at `distance_m`, its mesh turned by
  // `camera_from_mesh`.
  Setting at(const Quaternion& camera_from_mesh, Vec2 pixel, double distance_m) const {
    const Vec3 ray = normalized(Vec3{(pixel.x - lens_.cx_px) / lens_.fx_px, (pixel.y - lens_.cy_px) / lens_.fy_px, 1});
    Rigid<frame::Camera, frame::Object> pose{camera_from_mesh, {}};
    pose.translation_m = ray * distance_m - pose * stated_.bodies[body_].shape->centre_m();
    Setting out = stated_;
    if (move_station_)
      out.stations[station_].world_from_camera = stated_.bodies[body_].world_from_object * inverse(pose);
    else
      out.bodies[body_].world_from_object = stated_.stations[station_].world_from_camera * pose;
    return out;
  }
  Vec3 ray(Vec2 pixel) const {
    return normalized(Vec3{(pixel.x - lens_.cx_px) / lens_.fx_px, (pixel.y - lens_.cy_px) / lens_.fy_px, 1});
  }
  double focal_px() const { return std::sqrt(lens_.fx_px * lens_.fy_px); }
  Look look(const Setting& s, Vec2 origin) const {
    const ModelRim rim(s, {station_, body_, {}});
    return rim.exists() ? look_of(moments_of(rim.pieces(), origin), origin) : Look{};
  }

 private:
  Setting stated_;
  std::size_t body_, station_;
  bool move_station_;
  Lens lens_;
};

struct Attitude {
  Quaternion camera_from_mesh;
  Vec2 aim;  // pixel of the body's centre
  double distance_m = 0, apart = 0;
};

// The body's centre and distance so that area and middle are those that were seen; two rounds, as perspective bends
// both.
bool settle(const Poses& poses, const Look& seen, double radius_m, Attitude& a) {
  a.aim = seen.middle;
  a.distance_m = poses.focal_px() * radius_m * std::sqrt(pi / seen.area);
  for (int round = 0; round < 3; ++round) {
    const Look l = poses.look(poses.at(a.camera_from_mesh, a.aim, a.distance_m), seen.middle);
    if (!(l.area > 0)) return false;
    a.distance_m *= std::sqrt(l.area / seen.area);
    a.aim = a.aim + (seen.middle - l.middle);
  }
  return true;
}

double turn_between(const Quaternion& a, const Quaternion& b) {
  return norm(rotation_vector_of(normalized(a * conjugate(b))));
}

// Sorted by cost, those that are like a better one left out.
std::vector<Start> distinct(std::vector<Start> starts, std::size_t body, bool move_station) {
  std::sort(starts.begin(), starts.end(), [](const Start& a, const Start& b) { return a.cost < b.cost; });
  std::vector<Start> out;
  const auto relative = [&](const Setting& s) {
    return move_station ? s.stations[0].world_from_camera.rotation : s.bodies[body].world_from_object.rotation;
  };
  for (Start& s : starts) {
    if (!std::isfinite(s.cost)) continue;
    const auto known = std::find_if(out.begin(), out.end(), [&](const Start& o) {
      return turn_between(relative(o.setting), relative(s.setting)) < 0.08;
    });
    if (known == out.end())
      out.push_back(std::move(s));
    else
      known->paths.insert(known->paths.end(), s.paths.begin(), s.paths.end());
  }
  return out;
}

Question only(const Question& question, const std::function<bool(const Sighting&)>& keep) {
  Question q = question;
  std::erase_if(q.sightings, [&](const Sighting& s) { return !keep(s); });
  return q;
}

// Starts let down towards where they lead, by the rough shape, and judged by it; `fine` takes its place then.
void let_down(std::vector<Start>& starts, Question question, const RimCost& cost, const SearchWish& wish,
              std::size_t body, const Shape* fine) {
  const auto stage = [&](double reach_share, double width_share, int every, int most_steps) {
    return Stage{.reach_px = wish.reach_px * reach_share,
                 .width_px = wish.reach_px / width_share,
                 .both_ways = true,
                 .every = every,
                 .most_steps = most_steps,
                 .small_fall = 1e-3};
  };
  const std::vector<Stage> stages{stage(1, 4, 4, 15), stage(0.5, 12, 3, 10)};
  const Stage judge{.reach_px = wish.reach_px / 4, .width_px = 2, .both_ways = true, .every = 2};
  question.contacts.clear();
  for (Start& s : starts) {
    question.stated = s.setting;
    FitPath path;
    s.setting = settle_rims(s.setting, question, stages, wish.record ? &path : nullptr);
    if (wish.record) s.paths.push_back(std::move(path.rms_px));
    s.setting.bodies[body].shape = fine;
    s.cost = cost.of(s.setting, judge);
  }
}

}  // namespace

Moments about_middle(const Moments& m) {
  const double x = m.m10 / m.m00, y = m.m01 / m.m00;
  Moments c;
  c.m00 = m.m00;
  c.m20 = m.m20 - x * m.m10, c.m02 = m.m02 - y * m.m01, c.m11 = m.m11 - x * m.m01;
  c.m30 = m.m30 - 3 * x * m.m20 + 2 * x * x * m.m10, c.m03 = m.m03 - 3 * y * m.m02 + 2 * y * y * m.m01;
  c.m21 = m.m21 - 2 * x * m.m11 - y * m.m20 + 2 * x * x * m.m01;
  c.m12 = m.m12 - 2 * y * m.m11 - x * m.m02 + 2 * y * y * m.m10;
  return c;
}

std::array<double, 7> hu_invariants(const Moments& c) {
  const double two = c.m00 * c.m00, three = std::pow(c.m00, 2.5);
  const double n20 = c.m20 / two, n02 = c.m02 / two, n11 = c.m11 / two;
  const double n30 = c.m30 / three, n21 = c.m21 / three, n12 = c.m12 / three, n03 = c.m03 / three;
  const double p = n30 + n12, q = n21 + n03, u = n30 - 3 * n12, v = 3 * n21 - n03;
  // Roots that bring all to the scale of a length squared, so that none drowns the others.
  const auto root = [](double x, double power) { return std::copysign(std::pow(std::abs(x), 1 / power), x); };
  return {n20 + n02,
          root((n20 - n02) * (n20 - n02) + 4 * n11 * n11, 2),
          root(u * u + v * v, 2),
          root(p * p + q * q, 2),
          root(u * p * (p * p - 3 * q * q) + v * q * (3 * p * p - q * q), 4),
          root((n20 - n02) * (p * p - q * q) + 4 * n11 * p * q, 3),
          root(v * p * (p * p - 3 * q * q) - u * q * (3 * p * p - q * q), 4)};
}

Moments moments_of_points(const std::vector<RimPoint>& points, Vec2 origin) {
  std::vector<RimPiece> pieces;
  for (std::size_t i = 0, end = 0; i < points.size(); i = end) {
    for (end = i; end < points.size() && points[end].loop == points[i].loop;) ++end;
    for (std::size_t k = i; k < end; ++k)
      pieces.push_back({0, 0, 1, points[k].pixel, points[k + 1 < end ? k + 1 : i].pixel});
  }
  return moments_of(pieces, origin);
}

std::vector<Start> search_body(const Setting& stated, const Question& question, std::size_t body,
                               const SearchWish& wish) {
  // Photographs from one place show one rim: the first will do.
  std::vector<RimSubject> known;
  const Question q = only(question, [&](const Sighting& s) {
    const bool fresh = std::find(known.begin(), known.end(), s.subject) == known.end();
    known.push_back(s.subject);
    return s.subject.body == body && !s.subject.lamp && fresh;
  });
  const RimCost cost(q);
  const Sighting* best = nullptr;
  for (const Sighting& s : q.sightings)
    if (!best || s.points.size() > best->points.size()) best = &s;
  if (!best) throw Error(Exit::data, "outlines", "have no rim of the object", "give a mask of it");
  const Vec2 origin = best->points.empty() ? Vec2{} : best->points.front().pixel;
  const Look seen = look_of(moments_of_points(best->points, origin), origin);
  if (!(seen.area > 4)) throw Error(Exit::data, "outlines", "have no rim that closes around the object");

  const Shape& fine = *stated.bodies[body].shape;
  const Shape rough = fine.triangles() > 6000 ? fine.rough(24) : fine;
  Setting base = stated;
  base.bodies[body].shape = &rough;
  const Poses poses(base, body, best->subject.station, wish.move_station);

  const std::vector<Vec3> from = directions(wish.directions);
  std::vector<Attitude> attitudes(from.size());
  const Vec3 ray = poses.ray(seen.middle);
  std::vector<double> angles(from.size(), 0);
  parallel_for(0, from.size(), [&](std::size_t i) {
    Attitude& a = attitudes[i];
    a.camera_from_mesh = turn_to(from[i], -ray);
    a.apart = HUGE_VAL;
    if (!settle(poses, seen, rough.radius_m(), a)) return;
    const Look l = poses.look(poses.at(a.camera_from_mesh, a.aim, a.distance_m), seen.middle);
    a.apart = apart(l.hu, seen.hu), angles[i] = l.angle;
  });
  std::vector<std::size_t> order(from.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return attitudes[a].apart < attitudes[b].apart; });
  order.resize(std::min(order.size(), static_cast<std::size_t>(wish.compared)));

  // Turns about the ray: the principal axes agree both ways round; where the region is nearly round, all of a dozen.
  std::vector<Start> starts;
  std::vector<std::pair<std::size_t, double>> turns;
  for (const std::size_t i : order) {
    if (!std::isfinite(attitudes[i].apart)) continue;
    const bool round = seen.elongation < 0.15;
    for (int k = 0; k < (round ? 12 : 2); ++k)
      turns.push_back({i, seen.angle - angles[i] + k * 2 * pi / (round ? 12 : 2)});
  }
  starts.resize(turns.size());
  const Stage compare{.reach_px = wish.reach_px, .width_px = wish.reach_px / 4, .both_ways = true, .every = 4};
  parallel_for(0, turns.size(), [&](std::size_t i) {
    Attitude a = attitudes[turns[i].first];
    a.camera_from_mesh = normalized(quaternion_of_rotation_vector(ray * turns[i].second) * a.camera_from_mesh);
    starts[i].cost = HUGE_VAL;
    if (!settle(poses, seen, rough.radius_m(), a)) return;
    starts[i].setting = poses.at(a.camera_from_mesh, a.aim, a.distance_m);
    starts[i].cost = cost.of(starts[i].setting, compare);
  });
  starts = distinct(std::move(starts), body, wish.move_station);
  starts.resize(std::min(starts.size(), static_cast<std::size_t>(wish.refined)));

  Question rough_question = q;
  rough_question.freedoms = wish.move_station
                                ? std::vector<Freedom>{{Block::station_turn, best->subject.station},
                                                       {Block::station_shift, best->subject.station}}
                                : std::vector<Freedom>{{Block::body_turn, body}, {Block::body_shift, body}};
  let_down(starts, rough_question, cost, wish, body, &fine);
  return distinct(std::move(starts), body, wish.move_station);
}

std::vector<Start> search_lamp(const Setting& setting, const Question& question, std::size_t lamp,
                               const SearchWish& wish) {
  Question q = only(question, [&](const Sighting& s) { return s.subject.lamp == lamp; });
  if (q.sightings.empty()) return {{setting, 0}};
  const RimCost cost(q);
  const std::size_t body = q.sightings.front().subject.body;
  const Body& b = setting.bodies[body];
  const Shape rough = b.shape->triangles() > 6000 ? b.shape->rough(24) : *b.shape;
  Setting base = setting;
  base.bodies[body].shape = &rough;
  const double radius = rough.radius_m() * std::max({b.scale.x, b.scale.y, b.scale.z});
  const Vec3 centre = b.centre_m(), up = setting.ground->normal;
  const Basis axes(up);
  std::vector<Vec3> places;
  for (const Vec3 d : directions(300))
    for (const double distance : {2.0, 4.0, 10.0})
      if (d.z > 0.15) places.push_back(centre + axes.to_world(d) * (distance * radius));
  std::vector<Start> starts(places.size());
  const Stage compare{.reach_px = wish.reach_px, .width_px = wish.reach_px / 4, .both_ways = true, .every = 4};
  parallel_for(0, places.size(), [&](std::size_t i) {
    starts[i].setting = base;
    starts[i].setting.lamps_m[lamp] = places[i];
    starts[i].cost = cost.of(starts[i].setting, compare);
  });
  std::sort(starts.begin(), starts.end(), [](const Start& x, const Start& y) { return x.cost < y.cost; });
  std::erase_if(starts, [](const Start& s) { return !std::isfinite(s.cost); });
  starts.resize(std::min<std::size_t>(starts.size(), 5));
  q.freedoms = {{Block::lamp_shift, lamp}};
  let_down(starts, q, cost, wish, body, b.shape);
  std::sort(starts.begin(), starts.end(), [](const Start& x, const Start& y) { return x.cost < y.cost; });
  return starts;
}

}  // namespace gonio::alignment
