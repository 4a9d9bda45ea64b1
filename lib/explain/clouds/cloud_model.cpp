// See cloud_model.h.
#include "explain/clouds/cloud_model.h"

#include <algorithm>
#include <cmath>

#include "geom/covariance.h"
#include "geom/rigid.h"
#include "mesh/clean/local_quadratic.h"
#include "scan/mechanisms/structured_light_edge.h"
#include "scan/mechanisms/structured_light_subsurface.h"

namespace gonio::explain {
namespace {

using Part = CloudRole::Part;
constexpr double least_cosine = 0.4;      // of the angle that either device looks at the surface by
constexpr double reach_px = 2;            // of derivatives along a shape
constexpr double step_m = 1e-6;           // along a ray, for its slope
constexpr double least_variance = 1e-16;  // m^2: a cloud that states none

Vec3 direction_to(const scan::Station& station, Vec3 point) {
  return normalized(station.rig_from_camera.translation_m - point);
}

std::optional<Vec2> seen_by(const scan::Station& station, Vec3 point) {
  return station.lens.project(inverse(station.rig_from_camera) * point);
}

}  // namespace

struct CloudModel::State {
  std::vector<scan::Station> stations;
  std::vector<double> shape;
  double gamma = 1, depth_m = 0, along_m = 0, albedo = 0, spread_px2 = 0, spot_px2 = 0, exit_depth_m = 0, scatter_m = 0;
  bool first_as_stated = true;
};

CloudModel::CloudModel(const CloudsInput& input)
    : input_(input),
      told_{scan::ToldPlace(input.sequence, scan::Axis::column), scan::ToldPlace(input.sequence, scan::Axis::row)} {
  for (std::size_t g = 0; g < input.views.size(); ++g) add_group(g);
  double columns = 0, rows = 0;
  for (const Side& side : sides_[0])
    for (const CloudRow& row : side.rows) columns += std::abs(row.along.x), rows += std::abs(row.along.y);
  if (rows > columns) telling_ = scan::Axis::row;
  light_themselves();
}

// Points that either side can speak of.
void CloudModel::add_group(std::size_t group) {
  const CloudView& view = input_.views[group];
  const CloudView* against = input_.against.empty() ? nullptr : &input_.against[group];
  Side own{&view, {}, {}}, other{against, {}, {}};
  for (std::size_t p = 0; p < view.points.size(); ++p) {
    const std::optional<CloudRow> row = row_of(view, p);
    const std::optional<CloudRow> beside = row && against != nullptr ? row_of(*against, p) : std::nullopt;
    if (!row || (against != nullptr && !beside)) continue;
    own.rows.push_back(*row);
    if (beside) other.rows.push_back(*beside);
  }
  sides_[0].push_back(std::move(own)), sides_[1].push_back(std::move(other));
}

void CloudModel::light_themselves() {
  if (!input_.projector) return;
  const std::vector<double> x = told_[0].periods(), y = told_[1].periods();
  for (Side& side : sides_[0]) {
    if (!side.view->shape.may_light_itself()) continue;
    std::vector<IndirectLight::Point> points;
    for (const CloudRow& row : side.rows)
      points.push_back({row.origin + row.depth_m * row.direction, row.normal, row.expected});
    side.indirect = IndirectLight(side.view->shape, points, input_.stations[1], x, y);
  }
}

double CloudModel::value_m(std::size_t group, std::size_t row) const {
  const auto off = [row](const Side& side) {
    const CloudRow& r = side.rows[row];
    return r.metre_per_px * dot(r.told - r.expected, r.along);
  };
  return off(sides_[0][group]) - (sides_[1][group].rows.empty() ? 0 : off(sides_[1][group]));
}

double CloudModel::sigma_m(std::size_t group, std::size_t row) const {
  const double own = sides_[0][group].rows[row].sigma_m;
  return sides_[1][group].rows.empty() ? own : std::hypot(own, sides_[1][group].rows[row].sigma_m);
}

std::optional<CloudRow> CloudModel::row_of(const CloudView& view, std::size_t point) const {
  const scan::ScanPoint& p = view.points[point];
  CloudRow row;
  row.pixel = p.pixel, row.point = point;
  const scan::Station &first = input_.stations[0], &second = input_.stations[1];
  const camera::Ray ray = first.lens.ray(p.pixel);
  row.origin = first.rig_from_camera * ray.origin_m, row.direction = first.rig_from_camera.rotate(ray.direction);
  const CloudShape& surface = view.patches.empty() ? view.shape : view.patches[point];
  const std::vector<double> unmoved(surface.freedoms().size(), 0.0);
  const auto met = surface.met(row.origin, row.direction, unmoved);
  if (!met) return std::nullopt;
  // The point on the ray of its own pixel, which of two cameras it passes at a distance of its noise.
  const double at = dot(p.position_m - row.origin, row.direction);
  const Vec3 here = row.origin + at * row.direction, shape = row.origin + met->distance_m * row.direction;
  const auto told = seen_by(second, here), expected = seen_by(second, shape),
             beside = seen_by(second, shape + step_m * row.direction);
  if (!told || !beside || !expected) return std::nullopt;
  // All but what was told is of the shape: a point's noise in what the physics does to it would be taken for physics.
  const Vec2 slope = (*beside - *expected) * (1 / step_m);
  row.px_per_metre = std::hypot(slope.x, slope.y);
  const double cosine = -dot(met->normal, row.direction), other = dot(met->normal, direction_to(second, shape));
  if (!(row.px_per_metre > 0) || cosine < least_cosine || other < least_cosine) return std::nullopt;
  row.told = *told, row.expected = *expected, row.along = slope * (1 / row.px_per_metre);
  row.metre_per_px = cosine / row.px_per_metre;
  row.sigma_m = std::sqrt(std::max(least_variance, variance_along(p.covariance, met->normal)));
  row.depth_m = met->distance_m, row.normal = met->normal, row.across = across(surface, row);
  if (input_.projector && view.patches.empty()) differentiate(surface, row);  // patches do not tell of curvature
  if (!view.bright.empty() && view.bright[point][12] > 0) {
    const equation::Neighbours& b = view.bright[point];
    row.bright = &b, row.slope = Vec2{b[13] - b[11], b[17] - b[7]} * (0.5 / b[12]);
  }
  row.incidence_rad = std::acos(std::min(1.0, other));
  return row;
}

// By where the rays of the pixel's neighbours go.
std::array<Vec2, 2> CloudModel::across(const CloudShape& shape, const CloudRow& row) const {
  const scan::Station& first = input_.stations[0];
  const std::vector<double> unmoved(shape.freedoms().size(), 0.0);
  std::array<Vec2, 2> found;
  for (std::size_t side = 0; side < 2; ++side) {
    const camera::Ray ray = first.lens.ray(row.pixel + (side == 0 ? Vec2{1, 0} : Vec2{0, 1}));
    const Vec3 origin = first.rig_from_camera * ray.origin_m, direction = first.rig_from_camera.rotate(ray.direction);
    const auto met = shape.met(origin, direction, unmoved);
    const auto seen = met ? seen_by(input_.stations[1], origin + met->distance_m * direction) : std::nullopt;
    if (seen) found[side] = *seen - row.expected;
  }
  return found;
}

// Irradiance and pixels as quadratics over the tangent plane, of pixels about.
void CloudModel::differentiate(const CloudShape& shape, CloudRow& row) const {
  const scan::Station &first = input_.stations[0], &second = input_.stations[1];
  const Vec3 middle = row.origin + row.depth_m * row.direction;
  const Basis tangent(row.normal);
  const double unit_m = 0.01 * row.depth_m;
  const std::vector<double> unmoved(shape.freedoms().size(), 0.0);
  mesh::LocalQuadratic light, told[2];
  for (const double y : {-reach_px, 0.0, reach_px})
    for (const double x : {-reach_px, 0.0, reach_px}) {
      const camera::Ray ray = first.lens.ray(row.pixel + Vec2{x, y});
      const Vec3 origin = first.rig_from_camera * ray.origin_m, direction = first.rig_from_camera.rotate(ray.direction);
      const auto met = shape.met(origin, direction, unmoved);
      if (!met) return;
      const Vec3 at = origin + met->distance_m * direction, to = second.rig_from_camera.translation_m - at;
      const auto pixel = seen_by(second, at);
      const double cosine = dot(met->normal, to) / norm(to);
      if (!pixel || !(cosine > 0)) return;
      const Vec3 place = tangent.to_local(at - middle) * (1 / unit_m);
      light.add(place.x, place.y, std::log(cosine / dot(to, to)));
      told[0].add(place.x, place.y, pixel->x), told[1].add(place.x, place.y, pixel->y);
    }
  const mesh::LocalQuadratic::Fit e = light.fit(), u[2] = {told[0].fit(), told[1].fit()};
  if (!e.good || !u[0].good || !u[1].good) return;
  row.lit = Vec2{e.c[1], e.c[2]} * (1 / unit_m);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const mesh::LocalQuadratic::Terms& c = u[axis].c;
    const double square = unit_m * unit_m;
    row.told_slope[axis] = Vec2{c[1], c[2]} * (1 / unit_m);
    row.told_bend[axis] = {2 * c[3] / square, c[4] / square, 2 * c[5] / square};
  }
}

CloudModel::State CloudModel::state_of(std::span<const CloudRole> roles, std::span<const double> values,
                                       std::size_t side, std::size_t group) const {
  const CloudView& view = *sides_[side][group].view;
  State s{input_.stations, std::vector<double>(view.shape.freedoms().size(), 0.0)};
  camera::Intrinsics lens[2] = {s.stations[0].lens.intrinsics(), s.stations[1].lens.intrinsics()};
  const camera::Intrinsics stated[2] = {lens[0], lens[1]};
  std::array<double, 6> pose{};
  for (std::size_t p = 0; p < roles.size(); ++p) {
    const CloudRole& r = roles[p];
    const double v = values[p], change = r.by_time ? v * view.later_s : v * view.warmer_K;
    camera::Intrinsics& own = lens[r.device];
    switch (r.part) {
      case Part::shape:
        if (side == 0 && r.group == group) s.shape[r.index] = v;
        break;
      case Part::along:
        if (r.index == view.cloud) s.along_m = v;
        break;
      case Part::pose: pose[r.index] += v; break;
      case Part::drift: pose[r.index] += change; break;
      case Part::lens: own.distortion[r.index] += v; break;
      case Part::focal: own.fx_px *= 1 + v, own.fy_px *= 1 + v; break;
      case Part::principal: (r.index == 0 ? own.cx_px : own.cy_px) += v; break;
      case Part::thermal:
        if (r.index == 0)
          own.fx_px *= 1 + change, own.fy_px *= 1 + change;
        else
          (r.index == 1 ? own.cx_px : own.cy_px) += change;
        break;
      case Part::gamma: s.gamma = v; break;
      case Part::depth: s.depth_m = v; break;
      case Part::albedo: s.albedo = v; break;
      case Part::spread: s.spread_px2 = v; break;
      case Part::spot: s.spot_px2 = v; break;
      case Part::exit_depth: s.exit_depth_m = v; break;
      case Part::scatter: s.scatter_m = v; break;
    }
  }
  for (std::size_t d = 0; d < 2; ++d)
    if (!(lens[d] == stated[d])) s.stations[d].lens = s.stations[d].lens.with(lens[d]);
  s.first_as_stated = lens[0] == stated[0];
  Rigid<frame::Camera, frame::Camera> moved;
  moved.translation_m = {pose[0], pose[1], pose[2]};
  moved.rotation = quaternion_of_rotation_vector({pose[3], pose[4], pose[5]});
  if (pose != std::array<double, 6>{}) s.stations[1].rig_from_camera = s.stations[1].rig_from_camera * moved;
  return s;
}

double CloudModel::rad_per_px(std::size_t axis, double periods) const {
  return 2 * pi * periods / input_.sequence.size(axis == 0 ? scan::Axis::column : scan::Axis::row);
}

// Radians per pixel of the first camera.
Vec2 CloudModel::phase_slope(const CloudRow& row, std::size_t axis, double periods) const {
  const double each = rad_per_px(axis, periods);
  return axis == 0 ? Vec2{row.across[0].x, row.across[1].x} * each : Vec2{row.across[0].y, row.across[1].y} * each;
}

// Of the second device, along its x (0) or y, by a pixel of the first.
double CloudModel::covered(const CloudRow& row, std::size_t axis) {
  return axis == 0 ? std::max(std::abs(row.across[0].x), std::abs(row.across[1].x))
                   : std::max(std::abs(row.across[0].y), std::abs(row.across[1].y));
}

// Radians, by light that scatters beneath the surface.
double CloudModel::scattered(const CloudRow& row, std::size_t axis, double periods, double spread_m) const {
  const double each = rad_per_px(axis, periods);
  std::array<double, 3> bend = row.told_bend[axis];
  for (double& b : bend) b *= each;
  return equation::structured_light_spread(row.lit, row.told_slope[axis] * each, bend, spread_m);
}

// What other walls, a blur and scattering add, in pixels of the axis.
double CloudModel::turned_px(const State& s, const Side& side, std::size_t row, std::size_t axis) const {
  const CloudRow& r = side.rows[row];
  const bool walls = s.albedo != 0 && side.indirect.any(), blur = s.spread_px2 != 0 && r.bright != nullptr,
             scatters = s.scatter_m != 0;
  if (!walls && !blur && !scatters) return 0;
  const std::vector<double> periods = told_[axis].periods();
  std::vector<double> turns(periods.size());
  for (std::size_t k = 0; k < turns.size(); ++k) {
    const Vec2 slope = phase_slope(r, axis, periods[k]);
    turns[k] = walls ? side.indirect.turn(row, axis, k, s.albedo) : 0;
    if (scatters) turns[k] += scattered(r, axis, periods[k], s.scatter_m);
    if (blur) turns[k] += equation::structured_light_edge(*r.bright, slope, s.spread_px2);
  }
  return told_[axis].mean_of_turns(turns, {s.gamma, 0, covered(r, axis), s.spot_px2});
}

std::optional<Vec2> CloudModel::pixel_told(const State& s, const Side& side, std::size_t number) const {
  const CloudRow& row = side.rows[number];
  const CloudShape& shape = side.view->patches.empty() ? side.view->shape : side.view->patches[row.point];
  Vec3 origin = row.origin, direction = row.direction;
  if (!s.first_as_stated) {
    const camera::Ray ray = s.stations[0].lens.ray(row.pixel);
    origin = s.stations[0].rig_from_camera * ray.origin_m;
    direction = s.stations[0].rig_from_camera.rotate(ray.direction);
  }
  const auto met = shape.met(origin, direction, s.shape);
  if (!met) return std::nullopt;
  Vec3 at = origin + met->distance_m * direction;
  if (s.depth_m != 0 || s.exit_depth_m != 0)
    at += equation::structured_light_subsurface(met->normal, -direction, direction_to(s.stations[1], at), s.depth_m,
                                                s.exit_depth_m);
  std::optional<Vec2> pixel = seen_by(s.stations[1], at);
  if (!pixel || !input_.projector) return pixel;
  if (s.gamma == 1 && s.along_m == 0 && s.albedo == 0 && s.spread_px2 == 0 && s.scatter_m == 0) return pixel;
  // A surface that goes by `along_m` along the camera's axis meets the ray farther by n . axis / n . ray of it.
  const Vec3 axis = s.stations[0].rig_from_camera.rotate({0, 0, 1});
  const double farther = s.along_m * dot(met->normal, axis) / dot(met->normal, direction);
  const Vec2 moves = row.along * (row.px_per_metre * farther);
  pixel->x = told_[0](pixel->x, {s.gamma, moves.x, covered(row, 0), s.spot_px2});
  pixel->y = told_[1](pixel->y, {s.gamma, moves.y, covered(row, 1), s.spot_px2});
  pixel->x += turned_px(s, side, number, 0), pixel->y += turned_px(s, side, number, 1);
  return pixel;
}

void CloudModel::predict(std::span<const CloudRole> roles, std::span<const double> values, std::size_t group,
                         std::span<double> prediction) const {
  std::ranges::fill(prediction, 0.0);
  for (std::size_t s = 0; s < 2; ++s) {
    const Side& side = sides_[s][group];
    if (side.rows.empty()) continue;
    const State state = state_of(roles, values, s, group);
    for (std::size_t i = 0; i < side.rows.size(); ++i) {
      const CloudRow& row = side.rows[i];
      const auto pixel = pixel_told(state, side, i);
      if (pixel) prediction[i] += (s == 0 ? 1 : -1) * row.metre_per_px * dot(*pixel - row.expected, row.along);
    }
  }
}

}  // namespace gonio::explain
