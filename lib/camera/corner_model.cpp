// Values first, as they are predicted; then derivatives stage by stage, by the chain rule from the pixel back to the
// board. Bias and rates act last and add.
#include "camera/corner_model.h"

#include <algorithm>
#include <cmath>

#include "camera/mechanisms/board_shape.h"
#include "camera/mechanisms/camera_flat_port.h"
#include "camera/mechanisms/camera_rolling_shutter.h"
#include "camera/mechanisms/lens_lateral_colour.h"
#include "camera/mechanisms/lens_non_central.h"

namespace gonio::camera {
namespace {

using C = CornerColumn;
using Values = std::array<double, C::count>;
constexpr int most_iterations = 50;
constexpr double settled_px = 1e-10;

constexpr std::array<std::string_view, C::shape - BoardColumn::warp> further_names = {
    "sag_x_m",     "sag_y_m",     "motion_x_m", "motion_y_m", "scale_x",    "scale_y",     "pupil_m",    "red_linear",
    "red_cubic",   "blue_linear", "blue_cubic", "bias_x_px",  "bias_y_px",  "focal_per_K", "x_px_per_K", "y_px_per_K",
    "focal_per_s", "x_px_per_s",  "y_px_per_s", "index",      "distance_m", "tilt_x_rad",  "tilt_y_rad", "relative"};

// f and c as the recording's temperature and time leave them.
struct Pinhole {
  double fx = 0, fy = 0, cx = 0, cy = 0;
};
Pinhole pinhole_of(const CornerModel& m) {
  const Values& v = m.values;
  const auto drift = [&](std::size_t k) {
    return v[C::by_temperature + k] * m.warmer_K + v[C::by_time + k] * m.later_s;
  };
  const double stretch = 1 + v[C::focal] + drift(0);
  return {v[0] * stretch, v[1] * stretch, v[2] + drift(1), v[3] + drift(2)};
}

equation::FlatPort port_of(const Values& v) {
  return {v[C::port], v[C::port + 1], v[C::port + 2], v[C::port + 3]};
}

// Height s of the entrance pupil for a point at p: s = pupil g(X, Y, Z - s), g = (X^2 + Y^2) / |.|^2 = sin^2 theta,
// with its derivatives.
struct Pupil {
  double s = 0, by_pupil = 0;
  Vec3 by_point;
};
Pupil pupil_of(double pupil_m, Vec3 p) {
  const double across2 = p.x * p.x + p.y * p.y;
  Pupil result;
  result.s = equation::lens_non_central_place(pupil_m, p);
  const double z = p.z - result.s, square = across2 + z * z;
  const double by_z = -2 * z * across2 / (square * square), by_x2 = z * z / (square * square);  // of g
  const double feedback = 1 / (1 + pupil_m * by_z);
  result.by_pupil = across2 / square * feedback;
  result.by_point = Vec3{2 * p.x * by_x2, 2 * p.y * by_x2, by_z} * (pupil_m * feedback);
  return result;
}

struct Stretch {  // of (x', y') by the channel's colour: 1 + linear + cubic r'^2
  double linear = 0, cubic = 0;
};
Stretch stretch_of(const Values& v, Colour colour) {
  if (colour == Colour::green) return {};
  const std::size_t first = C::colour + (colour == Colour::red ? 0 : 2);
  return {v[first], v[first + 1]};
}

Vec2 scaled(const Values& v, Vec2 at) {
  return {at.x * (1 + v[C::scale]), at.y * (1 + v[C::scale + 1])};
}

Vec3 print_of(const Values& v) {
  return {v[C::print], v[C::print + 1], v[C::print + 2]};
}

// Where a corner is on the board.
Vec3 on_board(const CornerModel& m, Vec2 printed_m) {
  static_assert(C::print - C::shape == equation::board_shape_terms.size());
  const Vec2 at = scaled(m.values, printed_m);
  const double* coefficients = &m.values[C::shape];
  const double height = board_height(m.extent, at, &m.values[BoardColumn::warp]);
  if (std::all_of(coefficients, coefficients + equation::board_shape_terms.size(), [](double c) { return c == 0; }))
    return Vec3{at.x, at.y, height} + print_of(m.values);
  const Vec2 from = printed_m - m.extent.middle_m;
  return Vec3{at.x, at.y, height} + print_of(m.values) +
         equation::board_shape(coefficients, from.x / m.extent.half_m.x, from.y / m.extent.half_m.y);
}

// The pixel for a board at rest at `pose`, without the bias.
bool project(const CornerModel& m, const BoardPose& pose, const CornerPlace& place, Vec2& pixel) {
  const Values& v = m.values;
  const Vec3 p = equation::camera_flat_port(port_of(v), pose * on_board(m, place.board_m));
  const std::array point{p.x, p.y, v[C::pupil] != 0 ? p.z - pupil_of(v[C::pupil], p).s : p.z};
  const double* lens = &v[BoardColumn::distortion];
  double x = 0, y = 0, xd = 0, yd = 0;
  if (!lay_on_plane(lens[LensTerm::fisheye], point.data(), &x, &y)) return false;
  distort(lens, x, y, &xd, &yd);
  const Stretch colour = stretch_of(v, place.colour);
  const double factor = equation::lens_lateral_colour(colour.linear, colour.cubic, xd * xd + yd * yd);
  const Pinhole k = pinhole_of(m);
  pixel = {k.fx * (xd * factor) + k.cx, k.fy * (yd * factor) + k.cy};
  return true;
}

BoardPose shifted(const CornerModel& m, double row) {
  BoardPose pose = m.pose;
  const double tau = equation::camera_rolling_shutter(row, m.height_px);
  pose.translation_m = pose.translation_m + Vec3{tau * m.values[C::motion], tau * m.values[C::motion + 1], 0};
  return pose;
}

bool moves(const CornerModel& m) {
  return m.values[C::motion] != 0 || m.values[C::motion + 1] != 0;
}

// The pixel without the bias; `pose` receives where the board stood when its row was read.
bool seen(const CornerModel& m, const CornerPlace& place, Vec2& pixel, BoardPose& pose) {
  pose = m.pose;
  if (!project(m, pose, place, pixel)) return false;
  if (!moves(m)) return true;
  for (int i = 0; i < most_iterations; ++i) {
    const double row = pixel.y;
    pose = shifted(m, row);
    if (!project(m, pose, place, pixel)) return false;
    if (std::abs(pixel.y - row) < settled_px) return true;
  }
  return false;
}

Vec2 bias_of(const Values& v, double turned_rad) {
  const Vec2 b{v[C::bias], v[C::bias + 1]};
  if (turned_rad == 0) return b;
  const double c = std::cos(turned_rad), s = std::sin(turned_rad);
  return {c * b.x - s * b.y, s * b.x + c * b.y};
}

// Columns of the camera for one axis: (x, y) the coloured place, `by` = d(x, y) / d(x', y').
struct Coloured {
  Vec2 place, plain;  // after and before the colour's stretch
  double r2 = 0;
  std::array<double, 4> by{};
};
Coloured coloured(const LensMap& map, const Stretch& colour) {
  Coloured c;
  c.plain = {map.x, map.y};
  c.r2 = map.x * map.x + map.y * map.y;
  const double factor = equation::lens_lateral_colour(colour.linear, colour.cubic, c.r2);
  c.place = c.plain * factor;
  c.by = {factor + 2 * colour.cubic * map.x * map.x, 2 * colour.cubic * map.x * map.y, 2 * colour.cubic * map.x * map.y,
          factor + 2 * colour.cubic * map.y * map.y};
  return c;
}

void camera_columns(const CornerModel& m, const CornerPlace& place, const Pinhole& k, const LensMap& map,
                    const Coloured& seen_at, std::size_t axis, std::array<double, C::count>& j) {
  const double f = axis == 0 ? k.fx : k.fy, base = m.values[axis], own = axis == 0 ? seen_at.place.x : seen_at.place.y;
  const double plain = axis == 0 ? seen_at.plain.x : seen_at.plain.y;
  j[axis] = own * (f / base);
  j[2 + axis] = 1;
  for (std::size_t i = 0; i < distortion_terms; ++i)
    j[BoardColumn::distortion + i] =
        f * (seen_at.by[2 * axis] * map.by_term[0][i] + seen_at.by[2 * axis + 1] * map.by_term[1][i]);
  if (place.colour != Colour::green) {
    const std::size_t first = C::colour + (place.colour == Colour::red ? 0 : 2);
    j[first] = f * plain;
    j[first + 1] = f * plain * seen_at.r2;
  }
  const std::array<double, 2> since = {m.warmer_K, m.later_s};
  for (std::size_t s = 0; s < 2; ++s) {
    j[C::by_temperature + 3 * s] = base * since[s] * own;
    j[C::by_temperature + 3 * s + 1 + axis] = since[s];
  }
  j[C::focal] = base * own;
  const double c = std::cos(place.turned_rad), s = std::sin(place.turned_rad);
  j[C::bias] = axis == 0 ? c : s;
  j[C::bias + 1] = axis == 0 ? -s : c;
}

// Everything but motion, of a board at rest at `pose`.
bool differentiate(const CornerModel& m, const BoardPose& pose, const CornerPlace& place, CornerJacobian& jacobian) {
  const Values& v = m.values;
  const Vec2 at = scaled(v, place.board_m), half = m.extent.half_m, from = at - m.extent.middle_m;
  const Mat3 r = matrix_of(pose.rotation);
  const Vec3 q = r * on_board(m, place.board_m);
  const equation::FlatPort port = port_of(v);
  const auto bent = equation::camera_flat_port_slopes(port, q + pose.translation_m);
  const Vec3 p = equation::camera_flat_port(port, q + pose.translation_m);
  const Pupil pupil = pupil_of(v[C::pupil], p);
  LensMap map;
  if (!lens_map_derivatives(&v[BoardColumn::distortion], p - Vec3{0, 0, pupil.s}, map)) return false;
  const Coloured seen_at = coloured(map, stretch_of(v, place.colour));
  const Pinhole k = pinhole_of(m);
  const double rise_x = 1 - from.x * from.x / (half.x * half.x), rise_y = 1 - from.y * from.y / (half.y * half.y);
  const Vec2 slope{-2 * v[BoardColumn::warp] * from.x / (half.x * half.x),
                   -2 * v[BoardColumn::warp + 1] * from.y / (half.y * half.y)};
  const Vec2 printed = place.board_m - m.extent.middle_m;
  const auto shape = equation::board_shape_basis(printed.x / half.x, printed.y / half.y);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    auto& j = jacobian[axis];
    camera_columns(m, place, k, map, seen_at, axis, j);
    const double f = axis == 0 ? k.fx : k.fy;
    const auto by = [&](std::size_t i) {
      return f * (seen_at.by[2 * axis] * map.by_direction[0][i] + seen_at.by[2 * axis + 1] * map.by_direction[1][i]);
    };
    const Vec3 by_seen = Vec3{by(0), by(1), by(2)} - pupil.by_point * by(2);
    const Vec3 g{dot(by_seen, bent.by_point[0]), dot(by_seen, bent.by_point[1]), dot(by_seen, bent.by_point[2])};
    for (std::size_t i = 0; i < 4; ++i) j[C::port + i] = dot(by_seen, bent.by_port[i]);
    const Vec3 turn = cross(q, g);  // g . (w x q) = w . (q x g)
    const double lift = g.x * r(0, 2) + g.y * r(1, 2) + g.z * r(2, 2);
    for (int i = 0; i < 3; ++i) {
      j[BoardColumn::rotation + static_cast<std::size_t>(i)] = turn[i];
      j[BoardColumn::translation + static_cast<std::size_t>(i)] = g[i];
    }
    j[BoardColumn::warp] = lift * rise_x;
    j[BoardColumn::warp + 1] = lift * rise_y;
    const double along_x = g.x * r(0, 0) + g.y * r(1, 0) + g.z * r(2, 0);
    const double along_y = g.x * r(0, 1) + g.y * r(1, 1) + g.z * r(2, 1);
    j[C::scale] = place.board_m.x * (along_x + lift * slope.x);
    j[C::scale + 1] = place.board_m.y * (along_y + lift * slope.y);
    const std::array<double, 3> along = {along_x, along_y, lift};
    for (std::size_t t = 0; t < shape.size(); ++t)
      j[C::shape + t] = along[static_cast<std::size_t>(equation::board_shape_terms[t].axis)] * shape[t];
    for (std::size_t i = 0; i < along.size(); ++i) j[C::print + i] = along[i];
    j[C::pupil] = -by(2) * pupil.by_pupil;
  }
  return true;
}

// With P the projection at the pose of the corner's own row and P,t its derivative by the shift, the row's equation
// differentiates to dv (1 - P_v,t . m / h) = dP_v + tau P_v,t . dm, du = dP_u + tau P_u,t . dm + (P_u,t . m / h) dv.
void add_motion(const CornerModel& m, double row, CornerJacobian& jacobian) {
  const double tau = equation::camera_rolling_shutter(row, m.height_px);
  std::array<double, 2> drift{};  // what one row later does to (u, v)
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double along_x = jacobian[axis][BoardColumn::translation],
                 along_y = jacobian[axis][BoardColumn::translation + 1];
    jacobian[axis][C::motion] = tau * along_x;
    jacobian[axis][C::motion + 1] = tau * along_y;
    drift[axis] = (along_x * m.values[C::motion] + along_y * m.values[C::motion + 1]) / m.height_px;
  }
  if (drift[0] == 0 && drift[1] == 0) return;
  for (std::size_t c = 0; c < C::count; ++c) {
    if (c == C::bias || c == C::bias + 1) continue;  // of the detector: the row is read where the light fell
    jacobian[1][c] /= 1 - drift[1];
    jacobian[0][c] += drift[0] * jacobian[1][c];
  }
}

}  // namespace

std::optional<std::size_t> corner_column(std::string_view parameter) {
  const auto place = [&](const auto& names, std::size_t first) -> std::optional<std::size_t> {
    const auto found = std::find(names.begin(), names.end(), parameter);
    if (found == names.end()) return {};
    return first + static_cast<std::size_t>(found - names.begin());
  };
  if (const auto p = place(pinhole_names, BoardColumn::intrinsics)) return p;
  if (const auto p = place(distortion_names, BoardColumn::distortion)) return p;
  if (const auto p = place(further_names, BoardColumn::warp)) return p;
  const auto& terms = equation::board_shape_terms;
  const auto found = std::ranges::find(terms, parameter, &equation::BoardShapeTerm::name);
  if (found == terms.end()) return {};
  return C::shape + static_cast<std::size_t>(found - terms.begin());
}

bool predict(const CornerModel& model, const CornerPlace& place, Vec2& pixel) {
  BoardPose pose;
  if (!seen(model, place, pixel, pose)) return false;
  if (model.values[C::bias] != 0 || model.values[C::bias + 1] != 0)
    pixel = pixel + bias_of(model.values, place.turned_rad);
  return true;
}

bool predict(const CornerModel& model, const CornerPlace& place, Vec2& pixel, CornerJacobian& jacobian) {
  jacobian = {};
  BoardPose pose;
  if (!seen(model, place, pixel, pose)) return false;
  if (!differentiate(model, moves(model) ? shifted(model, pixel.y) : pose, place, jacobian)) return false;
  add_motion(model, pixel.y, jacobian);
  pixel = pixel + bias_of(model.values, place.turned_rad);
  return true;
}

}  // namespace gonio::camera
