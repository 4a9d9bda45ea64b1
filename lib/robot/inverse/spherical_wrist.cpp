// SphericalWrist of closed_forms.h: Elias & Wen 2025, "spherical" and "spherical, two parallel". The wrist's centre w,
// wanted at W, is moved by joints 1 to 3 alone:
//
//   R1' (W - o1) = o2 - o1 + R2 (o3 - o2 + R3 (w - o3))
//
// which is subproblem 5; where axes 2 and 3 are parallel its part along them holds q1 alone (subproblem 4), and the
// rest is a triangle in the plane across them. Then R4 R5 R6 = R3' R2' R1' G is a turn about three axes: subproblem 4
// of h4 . R5 h6, and subproblem 1 twice.
#include "robot/inverse/closed_form_parts.h"

namespace gonio::robot::closed_form {
namespace {

// The point nearest to three lines.
Vec3 meeting_of(const screws::Screws& s) {
  // Sum over lines of (1 - h h') (x - o) = 0, by Cramer's rule.
  std::array<Vec3, 3> rows{};
  Vec3 right;
  for (std::size_t i = 3; i < 6; ++i) {
    const Vec3 h = s.axis[i];
    const std::array<Vec3, 3> m = {Vec3{1, 0, 0} - h * h.x, Vec3{0, 1, 0} - h * h.y, Vec3{0, 0, 1} - h * h.z};
    for (std::size_t k = 0; k < 3; ++k) rows[k] += m[k];
    right += across(s.point_m[i], h);
  }
  const Vec3 c12 = cross(rows[1], rows[2]), c20 = cross(rows[2], rows[0]), c01 = cross(rows[0], rows[1]);
  return (c12 * right.x + c20 * right.y + c01 * right.z) / dot(rows[0], c12);
}

}  // namespace

std::optional<SphericalWrist> SphericalWrist::of(const screws::Screws& screws) {
  SphericalWrist arm;
  arm.s_ = screws;
  auto& s = arm.s_;
  if (norm(cross(s.axis[3], s.axis[4])) < no_turn || norm(cross(s.axis[4], s.axis[5])) < no_turn) return std::nullopt;
  const Vec3 w = meeting_of(s);
  for (std::size_t i = 3; i < 6; ++i)
    arm.departure_.gap_m = std::max(arm.departure_.gap_m, norm(across(w - s.point_m[i], s.axis[i])));
  if (arm.departure_.gap_m > near_gap * s.size_m) return std::nullopt;
  s.point_m[3] = s.point_m[4] = s.point_m[5] = w;
  std::array<Vec3, 2> pair = {s.axis[1], s.axis[2]};
  const double angle = align(pair);
  arm.upper_ = across(s.point_m[2] - s.point_m[1], pair[0]);
  arm.fore_ = across(w - s.point_m[2], pair[0]);
  const bool triangle = std::min(norm(arm.upper_), norm(arm.fore_)) > no_triangle * s.size_m;
  if (angle >= 0 && triangle && norm(cross(s.axis[0], pair[0])) > no_turn) {
    arm.parallel_ = true;
    arm.departure_.angle_rad = angle;
    s.axis[1] = pair[0], s.axis[2] = pair[1];
    arm.sense_ = dot(pair[0], pair[1]) > 0 ? 1 : -1;
  }
  return arm;
}

subproblem::Few<SphericalWrist::Arm, 4> SphericalWrist::arm_of(Vec3 wrist_m, const Hints& hints) const {
  const Vec3 target = wrist_m - s_.point_m[0], second = s_.point_m[1] - s_.point_m[0];
  subproblem::Few<Arm, 4> found;
  if (!parallel_) {
    for (const auto& t : subproblem::sp5(-second, target, s_.point_m[2] - s_.point_m[1], s_.point_m[3] - s_.point_m[2],
                                         -s_.axis[0], s_.axis[1], s_.axis[2]))
      found.add({{t.first_rad, t.second_rad, t.third_rad}, -1, false});
    return found;
  }
  const Vec3 h = s_.axis[1];
  subproblem::TwoTurns shoulder = subproblem::sp4(h, target, -s_.axis[0], dot(h, s_.point_m[3] - s_.point_m[0]));
  const bool on_axis = shoulder.lever < no_lever * s_.size_m;
  if (on_axis)
    shoulder.falling_rad = shoulder.rising_rad = hints.near_rad[0];
  else
    shoulder = spread(shoulder, hints.apart_rad);
  for (const bool right : {false, true}) {
    const double q1 = right ? shoulder.rising_rad : shoulder.falling_rad;
    const Vec3 reach = across(screws::turned(s_.axis[0], -q1) * target - second, h);
    const auto elbow = spread(subproblem::sp3(fore_, -upper_, h, norm(reach)), hints.apart_rad);
    const bool folded = norm(reach) < no_lever * s_.size_m;
    for (const bool down : {false, true}) {
      const double u3 = down == right ? elbow.rising_rad : elbow.falling_rad;
      const Vec3 straight = upper_ + screws::turned(h, u3) * fore_;
      const double q2 = folded ? hints.near_rad[1] : subproblem::sp1(straight, reach, h).angle_rad;
      found.add({{q1, q2, sense_ * u3}, right * right_bit + down * down_bit, on_axis || folded});
    }
  }
  return found;
}

void SphericalWrist::wrist(const screws::Pose& wanted, const Arm& arm, const Hints& hints, Candidates& answers) const {
  const auto& h = s_.axis;
  const Mat3 g = wanted.rotation * transposed(s_.zero.rotation);
  Mat3 turn = g;
  for (std::size_t i = 0; i < 3; ++i) turn = screws::turned(h[i], -arm.joints_rad[i]) * turn;
  const Vec3 seen = turn * h[5];
  auto bend = spread(subproblem::sp4(h[3], h[5], h[4], dot(h[3], seen)), hints.apart_rad);
  const bool in_line = norm(cross(h[3], seen)) < hints.in_line;
  if (in_line && hints.apart_rad == 0) bend = subproblem::sp4(h[3], h[5], h[4], dot(h[3], seen) > 0 ? 2 : -2);
  for (const bool flipped : {false, true}) {
    Candidate c{arm.joints_rad, arm.branch < 0 ? -1 : arm.branch + flipped * flip_bit, arm.undetermined || in_line};
    const double q5 = flipped ? bend.rising_rad : bend.falling_rad;
    const Mat3 r5 = screws::turned(h[4], q5);
    const double q4 = in_line ? hints.near_rad[3] : subproblem::sp1(r5 * h[5], seen, h[3]).angle_rad;
    c.joints_rad[3] = q4, c.joints_rad[4] = q5;
    c.joints_rad[5] = angle_about(h[5], transposed(screws::turned(h[3], q4) * r5) * turn);
    answers.add(c);
  }
}

Candidates SphericalWrist::solve(const screws::Pose& wanted, const Hints& hints) const {
  const Mat3 g = wanted.rotation * transposed(s_.zero.rotation);
  Candidates answers;
  for (const Arm& arm : arm_of(wanted.position_m + g * (s_.point_m[3] - s_.zero.position_m), hints))
    wrist(wanted, arm, hints, answers);
  return answers;
}

std::optional<SingularFactors> SphericalWrist::factors_at(const Joints& q) const {
  if (!parallel_) return std::nullopt;
  const auto& o = s_.point_m;
  const Mat3 r2 = screws::turned(s_.axis[1], q[1]), r3 = screws::turned(s_.axis[2], q[2]);
  const Vec3 h = s_.axis[1], way = o[1] - o[0] + r2 * (o[2] - o[1] + r3 * (o[3] - o[2]));
  return SingularFactors{dot(h, cross(s_.axis[0], way)),
                         dot(h, cross(upper_, r3 * fore_)) / (norm(upper_) * norm(fore_)),
                         -dot(s_.axis[3], screws::turned(s_.axis[4], q[4]) * cross(s_.axis[4], s_.axis[5]))};
}

}  // namespace gonio::robot::closed_form
