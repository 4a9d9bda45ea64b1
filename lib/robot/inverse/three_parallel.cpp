// ThreeParallel of closed_forms.h: Elias & Wen 2025, "three parallel" and "three parallel, two intersecting". With h
// the direction of axes 2, 3, 4, G the turn of the flange since all joints were zero, and o6 in its place P:
//
//   along h:  h . R1' (P - o1) - h . R5 (o6 - o5) = h . (o5 - o1)          (2, 3, 4 move nothing along h)
//             h . R1' G h6 = h . R5 h6
//
// Where axes 5 and 6 meet, o5 = o6 and the first holds q1 alone (subproblem 4), the second then q5; else both together
// are subproblem 6. What is left is a triangle in the plane across h.
#include "robot/inverse/closed_form_parts.h"

namespace gonio::robot::closed_form {

using screws::turned;
using subproblem::TwoTurns;

std::optional<ThreeParallel> ThreeParallel::of(const screws::Screws& screws) {
  ThreeParallel arm;
  arm.s_ = screws;
  auto& s = arm.s_;
  const double angle = align(std::span(s.axis).subspan(1, 3));
  if (angle < 0) return std::nullopt;
  arm.departure_.angle_rad = angle;
  arm.h_ = s.axis[1];
  for (std::size_t i = 0; i < 3; ++i) arm.sense_[i] = dot(s.axis[1 + i], arm.h_) > 0 ? 1 : -1;
  arm.upper_ = across(s.point_m[2] - s.point_m[1], arm.h_);
  arm.fore_ = across(s.point_m[3] - s.point_m[2], arm.h_);
  if (std::min(norm(arm.upper_), norm(arm.fore_)) < no_triangle * s.size_m) return std::nullopt;
  // Nothing turns the hand across h but axes 1 and 5, and the wrist about its own axis but 6.
  if (norm(cross(s.axis[0], arm.h_)) < no_turn || norm(cross(s.axis[4], arm.h_)) < no_turn ||
      norm(cross(s.axis[4], s.axis[5])) < no_turn)
    return std::nullopt;
  const Vec3 h5 = s.axis[4], h6 = s.axis[5], normal = cross(h5, h6), apart = s.point_m[5] - s.point_m[4];
  const double gap = std::abs(dot(apart, normalized(normal)));
  if (gap <= near_gap * s.size_m) {
    arm.meet_ = true;
    arm.departure_.gap_m = gap;
    const Vec3 on5 = s.point_m[4] + h5 * (dot(cross(apart, h6), normal) / dot(normal, normal));
    const Vec3 on6 = s.point_m[5] + h6 * (dot(cross(apart, h5), normal) / dot(normal, normal));
    s.point_m[4] = s.point_m[5] = (on5 + on6) / 2;
  }
  return arm;
}

subproblem::Few<ThreeParallel::Outer, 4> ThreeParallel::outer(const screws::Pose& wanted, const Hints& hints) const {
  const Mat3 g = wanted.rotation * transposed(s_.zero.rotation);
  const Vec3 from_first = wanted.position_m + g * (s_.point_m[5] - s_.zero.position_m) - s_.point_m[0];
  const Vec3 h1 = s_.axis[0], h5 = s_.axis[4], h6 = s_.axis[5];
  const double along = dot(h_, s_.point_m[4] - s_.point_m[0]);
  subproblem::Few<Outer, 4> found;
  if (!meet_) {
    const subproblem::Arm6 place{h_, -h1, from_first}, offset{-h_, h5, s_.point_m[5] - s_.point_m[4]};
    for (const auto& pair : subproblem::sp6({place, offset, {h_, -h1, g * h6}, {-h_, h5, h6}}, along, 0))
      found.add({pair.first_rad, pair.second_rad, 0, false});
    return found;
  }
  TwoTurns shoulder = subproblem::sp4(h_, from_first, -h1, along);
  const bool on_axis = shoulder.lever < no_lever * s_.size_m;
  shoulder = on_axis ? TwoTurns{hints.near_rad[0], hints.near_rad[0], 0, 0} : spread(shoulder, hints.apart_rad);
  for (const bool right : {false, true}) {
    const double q1 = right ? shoulder.rising_rad : shoulder.falling_rad;
    const Mat3 back = turned(h1, -q1);
    const TwoTurns wrist = spread(subproblem::sp4(h_, h6, h5, dot(h_, back * (g * h6))), hints.apart_rad);
    found.add({q1, wrist.falling_rad, right * right_bit, on_axis});
    found.add({q1, wrist.rising_rad, right * right_bit + flip_bit, on_axis});
  }
  return found;
}

void ThreeParallel::inner(const screws::Pose& wanted, const Outer& o, const Hints& hints, Candidates& answers) const {
  const Mat3 g = wanted.rotation * transposed(s_.zero.rotation);
  const Vec3 h6 = s_.axis[5];
  const Mat3 back1 = turned(s_.axis[0], -o.q1);
  Mat3 turn5 = turned(s_.axis[4], o.q5);
  Candidate c;
  c.branch = o.branch;
  c.undetermined = o.undetermined;
  c.joints_rad[0] = o.q1, c.joints_rad[4] = o.q5;
  // R6' R5' h = G' R1 h; where axis 6 is along h only the sum of the turns about both is known.
  const Vec3 seen = transposed(back1 * g) * h_;
  if (norm(cross(seen, h6)) < hints.in_line) {
    c.undetermined = true;
    const TwoTurns meeting = subproblem::sp4(h_, h6, s_.axis[4], dot(seen, h6) > 0 ? 2 : -2);
    if (hints.apart_rad == 0) c.joints_rad[4] = meeting.falling_rad, turn5 = turned(s_.axis[4], meeting.falling_rad);
    c.joints_rad[5] = hints.near_rad[5];
  } else {
    c.joints_rad[5] = subproblem::sp1(transposed(turn5) * h_, seen, -h6).angle_rad;
  }
  const double sum = angle_about(h_, back1 * g * transposed(turn5 * turned(h6, c.joints_rad[5])));
  // The plane across h: a turned by q2, b by q2 + q3 reach from axis 2 to axis 4.
  const Vec3 target = wanted.position_m + g * (s_.point_m[5] - s_.zero.position_m) - s_.point_m[0];
  const Vec3 hand = s_.point_m[4] - s_.point_m[3] + turn5 * (s_.point_m[5] - s_.point_m[4]);
  const Vec3 reach = across(back1 * target - (s_.point_m[1] - s_.point_m[0]) - turned(h_, sum) * hand, h_);
  const TwoTurns elbow = spread(subproblem::sp3(fore_, -upper_, h_, norm(reach)), hints.apart_rad);
  for (const bool down : {false, true}) {
    const bool rising = ((o.branch & right_bit) != 0) == down;
    const double u3 = rising ? elbow.rising_rad : elbow.falling_rad;
    Candidate full = c;
    const Vec3 straight = upper_ + turned(h_, u3) * fore_;
    const bool folded = norm(reach) < no_lever * s_.size_m;
    full.undetermined |= folded;
    const double u2 = folded ? sense_[0] * hints.near_rad[1] : subproblem::sp1(straight, reach, h_).angle_rad;
    full.joints_rad[1] = sense_[0] * u2, full.joints_rad[2] = sense_[1] * u3;
    full.joints_rad[3] = sense_[2] * (sum - u2 - u3);
    full.branch = meet_ ? o.branch + down * down_bit : -1;
    answers.add(full);
  }
}

Candidates ThreeParallel::solve(const screws::Pose& wanted, const Hints& hints) const {
  Candidates answers;
  for (const Outer& o : outer(wanted, hints)) inner(wanted, o, hints, answers);
  return answers;
}

std::optional<SingularFactors> ThreeParallel::factors_at(const Joints& q) const {
  if (!meet_) return std::nullopt;
  const Mat3 r2 = turned(s_.axis[1], q[1]), r23 = r2 * turned(s_.axis[2], q[2]), r24 = r23 * turned(s_.axis[3], q[3]);
  const auto& o = s_.point_m;
  const Vec3 way = o[1] - o[0] + r2 * (o[2] - o[1]) + r23 * (o[3] - o[2]) + r24 * (o[4] - o[3]);
  const double lengths = norm(upper_) * norm(fore_);
  return SingularFactors{dot(h_, cross(s_.axis[0], way)),
                         dot(h_, cross(upper_, turned(s_.axis[2], q[2]) * fore_)) / lengths,
                         -dot(h_, turned(s_.axis[4], q[4]) * cross(s_.axis[4], s_.axis[5]))};
}

}  // namespace gonio::robot::closed_form
