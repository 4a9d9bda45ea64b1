// See model_rim.h.
#include "alignment/model_rim.h"

#include <algorithm>
#include <cmath>

namespace gonio::alignment {
namespace {

// Where the mesh sees what looks at it, in its own frame.
Vec3 in_mesh(const Body& body, Vec3 world) {
  const Vec3 c = body.shape->centre_m(), d = inverse(body.world_from_object) * world - c;
  return c + Vec3{d.x / body.scale.x, d.y / body.scale.y, d.z / body.scale.z};
}

}  // namespace

ModelRim::ModelRim(const Setting& setting, const RimSubject& subject) : shape_(setting.bodies[subject.body].shape) {
  const Body& body = setting.bodies[subject.body];
  const Vec3 camera = setting.stations[subject.station].world_from_camera.translation_m;
  const Vec3 eye = subject.lamp ? setting.lamps_m[*subject.lamp] : camera;
  if (subject.lamp && !(setting.ground->height_m(camera) > 0 && setting.ground->height_m(eye) > 0)) {
    exists_ = false;
    return;
  }
  // Camera axes run right and down: what faces the camera turns the other way round there, and so does what faces the
  // lamp on a ground that is seen from the lamp's side.
  thread_local std::vector<std::uint8_t> faces;
  thread_local std::vector<std::pair<std::uint32_t, Projected>> known;
  shape_->rim_edges(in_mesh(body, eye), true, faces, edges_);
  thread_local std::vector<std::uint32_t> slot;
  thread_local std::vector<std::uint32_t> used;
  slot.resize(std::max(slot.size(), shape_->positions_m().size()), ~0U);
  known.clear(), used.clear();
  const auto seen = [&](std::uint32_t v) {
    if (slot[v] == ~0U) {
      const Vec3 world = body.place_m(shape_->positions_m()[v]);
      slot[v] = static_cast<std::uint32_t>(known.size()), used.push_back(v);
      known.push_back({v, subject.lamp ? project_shadow(setting, subject.station, *subject.lamp, world)
                                       : project(setting, subject.station, world)});
    }
    return known[slot[v]].second;
  };
  segments_.reserve(edges_.size()), weights_.reserve(2 * edges_.size());
  for (const RimEdge& e : edges_) {
    const Projected a = seen(e.a), b = seen(e.b);
    if (!(a.weight > 0 && b.weight > 0)) exists_ = false;
    segments_.push_back({a.pixel, b.pixel, e.jump});
    weights_.push_back(a.weight), weights_.push_back(b.weight);
  }
  for (const std::uint32_t v : used) slot[v] = ~0U;
  if (!exists_) return;
  pieces_ = rim_of(segments_);
  std::vector<Box> boxes;
  for (const RimPiece& p : pieces_) {
    length_ += norm(p.to - p.from);
    boxes.push_back({{std::min(p.from.x, p.to.x), std::min(p.from.y, p.to.y)},
                     {std::max(p.from.x, p.to.x), std::max(p.from.y, p.to.y)}});
  }
  if (!pieces_.empty()) cells_ = CellIndex(boxes, std::max(1.0, 4 * length_ / static_cast<double>(pieces_.size())));
}

RimPlace ModelRim::place_on(const RimPiece& piece, double share) const {
  const Vec2 way = piece.to - piece.from;
  const double length = norm(way), s = piece.start + share * (piece.end - piece.start);
  const double to_a = (1 - s) / weights_[2 * piece.segment], to_b = s / weights_[2 * piece.segment + 1];
  const double t = to_b / (to_a + to_b);
  const RimEdge& edge = edges_[piece.segment];
  const auto& at = shape_->positions_m();
  return {piece.from + way * share, {way.y / length, -way.x / length}, at[edge.a] * (1 - t) + at[edge.b] * t, 0};
}

std::vector<RimPlace> ModelRim::places(double spacing_px) const {
  constexpr double most = 20000;  // a rim that is longer is no picture's
  spacing_px = std::max(spacing_px, length_ / most);
  std::vector<RimPlace> out;
  for (const RimPiece& piece : pieces_) {
    const auto count = static_cast<int>(std::lround(norm(piece.to - piece.from) / spacing_px));
    for (int i = 0; i < count; ++i) out.push_back(place_on(piece, (i + 0.5) / count));
  }
  return out;
}

std::optional<RimPlace> ModelRim::nearest(Vec2 pixel, Vec2 outward, double reach_px) const {
  if (pieces_.empty()) return {};
  double best = reach_px * reach_px, best_share = 0;
  const RimPiece* found = nullptr;
  cells_.outwards(pixel, best, [&](std::uint32_t i) {
    const RimPiece& p = pieces_[i];
    const Vec2 way = p.to - p.from;
    const double length2 = dot(way, way);
    if (!(length2 > 0 && (way.y * outward.x - way.x * outward.y) > 0.5 * std::sqrt(length2))) return;
    const double share = std::clamp(dot(pixel - p.from, way) / length2, 0.0, 1.0);
    const Vec2 off = pixel - (p.from + way * share);
    if (dot(off, off) < best) best = dot(off, off), best_share = share, found = &p;
  });
  if (!found) return {};
  RimPlace place = place_on(*found, best_share);
  const Vec2 off = pixel - place.pixel;
  const double side = dot(off, place.outward);
  place.distance_px = std::copysign(std::sqrt(best), side);
  // At a corner the nearest place is one point over a wedge of directions: the normal is the direction itself.
  if ((best_share == 0 || best_share == 1) && best > 1e-6) {
    const Vec2 along = off * (1 / place.distance_px);
    if (dot(along, place.outward) > 0.5)
      place.outward = along;
    else
      place.distance_px = side;
  }
  return place;
}

}  // namespace gonio::alignment
