// Times of motions (way.h). Along a way the joints' common speed w, in rad/s of the length of the joint vector, is
// bounded by every joint's speed and the tools', and at the states between lines by what the change of direction asks
// of every joint's acceleration; w^2 then grows and falls by at most 2 a per rad of the way, forwards and backwards
// (Bobrow, Dubowsky & Gibson 1985, on a path of straight pieces). Where a way bends, half of every joint's acceleration
// is kept for the bend.
#include <algorithm>
#include <cmath>
#include <limits>

#include "acquisition/motion/way.h"

namespace gonio::acquisition {
namespace {

constexpr double corner_rad = 0.2;
constexpr double without_limit = std::numeric_limits<double>::infinity();

struct Piece {
  double length_rad = 0;
  std::vector<double> direction;  // unit, all joints of all arms
  double speed = without_limit, acceleration = without_limit;
  double end_speed = 0;  // at its end
};

// From speed v0 to v1 over a length, not beyond `speed`.
double piece_time(double length, double v0, double v1, double speed, double acceleration) {
  const double peak = std::sqrt(acceleration * length + (v0 * v0 + v1 * v1) / 2);
  if (peak <= speed) return (2 * peak - v0 - v1) / acceleration;
  const double bent = (2 * speed * speed - v0 * v0 - v1 * v1) / (2 * acceleration);
  return (2 * speed - v0 - v1) / acceleration + (length - bent) / speed;
}

// Of the flange, per rad of joint motion along `direction`; the largest of nine places on the piece.
double flange_rate(const LaboratoryArm& arm, const Joints& from, const Joints& to, double length_rad) {
  double largest = 0;
  for (int k = 0; k <= 8; ++k) {
    Joints joints(from);
    for (std::size_t i = 0; i < joints.size(); ++i) joints[i] += k / 8.0 * (to[i] - from[i]);
    const std::vector<robot::Motion> motions = robot::joint_motions(arm.links, joints);
    const Vec3 beyond = robot::flange(arm.links, joints).rotate(arm.last_from_tool.translation_m);
    Vec3 rate{};
    for (std::size_t i = 0; i < joints.size(); ++i)
      rate += (motions[i].shift_m + cross(motions[i].turn_rad, beyond)) * ((to[i] - from[i]) / length_rad);
    largest = std::max(largest, norm(rate));
  }
  return largest;
}

Piece piece_of(const Laboratory& laboratory, const State& from, const State& to) {
  Piece piece;
  double square = 0;
  for (const auto& [name, arm] : laboratory.arms) {
    const Joints &a = joints_of(arm, from), &b = joints_of(arm, to);
    for (std::size_t i = 0; i < a.size(); ++i) {
      piece.direction.push_back(b[i] - a[i]);
      square += (b[i] - a[i]) * (b[i] - a[i]);
    }
  }
  piece.length_rad = std::sqrt(square);
  if (!(piece.length_rad > 0)) return piece;
  for (double& d : piece.direction) d /= piece.length_rad;
  std::size_t j = 0;
  for (const auto& [name, arm] : laboratory.arms) {
    for (const robot::JointLimit& limit : arm.limits) {
      const double share = std::fabs(piece.direction[j++]);
      if (!(share > 0)) continue;
      piece.speed = std::min(piece.speed, limit.speed_rad_per_s / share);
      piece.acceleration = std::min(piece.acceleration, limit.acceleration_rad_per_s2 / share);
    }
    const double rate = flange_rate(arm, joints_of(arm, from), joints_of(arm, to), piece.length_rad);
    if (rate > 0) piece.speed = std::min(piece.speed, laboratory.speed_m_per_s / rate);
  }
  return piece;
}

std::vector<double> accelerations(const Laboratory& laboratory) {
  std::vector<double> all;
  for (const auto& [name, arm] : laboratory.arms)
    for (const robot::JointLimit& limit : arm.limits) all.push_back(limit.acceleration_rad_per_s2);
  return all;
}

// At the end of `a`, where `b` begins: 0 at a corner.
double speed_through(const Piece& a, const Piece& b, const std::vector<double>& accelerations) {
  double square = 0, speed = std::min(a.speed, b.speed);
  for (std::size_t j = 0; j < a.direction.size(); ++j) {
    const double turn = b.direction[j] - a.direction[j];
    square += turn * turn;
    // The direction turns over half of either piece, (la + lb) / (2 w) seconds.
    if (std::fabs(turn) > 1e-12)
      speed = std::min(speed, std::sqrt(accelerations[j] / 2 * (a.length_rad + b.length_rad) / (2 * std::fabs(turn))));
  }
  return std::sqrt(square) > corner_rad ? 0 : speed;
}

}  // namespace

double trapezoid_time(double distance, double speed, double acceleration) {
  const double way = std::fabs(distance);
  return way > 0 ? piece_time(way, 0, 0, speed, acceleration) : 0;
}

double line_time(const LaboratoryArm& arm, const Joints& from, const Joints& to) {
  double speed = without_limit, acceleration = without_limit;  // of the share of the line that is done
  for (std::size_t i = 0; i < from.size(); ++i) {
    const double turn = std::fabs(to[i] - from[i]);
    if (!(turn > 0)) continue;
    speed = std::min(speed, arm.limits[i].speed_rad_per_s / turn);
    acceleration = std::min(acceleration, arm.limits[i].acceleration_rad_per_s2 / turn);
  }
  return speed < without_limit ? trapezoid_time(1, speed, acceleration) : 0;
}

double way_time(const Laboratory& laboratory, const Way& way) {
  std::vector<Piece> pieces;
  for (std::size_t i = 0; i + 1 < way.size(); ++i)
    if (Piece piece = piece_of(laboratory, way[i], way[i + 1]); piece.length_rad > 0)
      pieces.push_back(std::move(piece));
  const std::vector<double> limits = accelerations(laboratory);
  std::vector<bool> bends(pieces.size() + 1);
  for (std::size_t i = 0; i + 1 < pieces.size(); ++i) {
    pieces[i].end_speed = speed_through(pieces[i], pieces[i + 1], limits);
    bends[i + 1] = pieces[i].end_speed > 0 && pieces[i].end_speed < std::min(pieces[i].speed, pieces[i + 1].speed);
  }
  for (std::size_t i = 0; i < pieces.size(); ++i)
    if (bends[i] || bends[i + 1]) pieces[i].acceleration /= 2;
  double before = 0;
  for (Piece& piece : pieces) {
    before = piece.end_speed =
        std::min(piece.end_speed, std::sqrt(before * before + 2 * piece.acceleration * piece.length_rad));
  }
  for (std::size_t i = pieces.size(); i-- > 1;) {
    const double end = pieces[i].end_speed;
    pieces[i - 1].end_speed =
        std::min(pieces[i - 1].end_speed, std::sqrt(end * end + 2 * pieces[i].acceleration * pieces[i].length_rad));
  }
  double time = 0, start = 0;
  for (const Piece& piece : pieces) {
    time += piece_time(piece.length_rad, start, piece.end_speed, piece.speed, piece.acceleration);
    start = piece.end_speed;
  }
  return time;
}

}  // namespace gonio::acquisition
