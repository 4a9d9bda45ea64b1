// Inverse kinematics of arms with six revolute joints: every set of joint angles that puts the flange at a pose, and a
// number for each, its branch, that stays the same as the pose moves.
//
//   const InverseKinematics inverse(known_arm("ur5e", place).links);
//   for (const JointAnswer& a : inverse.solve(base_from_tool)) ... a.joints_rad, branch_name(a.branch)
//
// Closed forms by subproblems (Elias & Wen, "IK-Geo: Unified robot inverse kinematics using subproblem decomposition",
// Mechanism and Machine Theory 209, 2025; Paden 1986, Kahan 1983) for arms whose axes 2, 3, 4 are parallel (Universal
// Robots) or whose last three axes meet (ABB IRB 1600), or the same read from flange to base. Any other geometry: all
// 16 roots of one equation in the tangent of half of joint 3 (Raghavan & Roth, J. Mech. Design 115, 1993; Manocha &
// Canny, IEEE Trans. Robotics and Automation 10, 1994). A calibrated arm is no longer exactly parallel anywhere: it is
// solved as the nearest arm that is, and each answer is then led to the true one by Newton's method on exact
// derivatives. Beside its singular postures (a wrist within a degree or so of straight) it may have 10 or 12 answers,
// which the general method looks for; two of them may then carry the same branch, and one in some 10,000 poses lacks
// one.
//
// Out of reach (no exact answer): the least-squares ones of the subproblems, arm stretched towards the target, whose
// angles go over continuously into the exact ones as the target comes into reach. Angles lie in (-pi, pi]; turns and
// joint limits: turns.h. No collisions, no choice among the answers.
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geom/rigid.h"
#include "robot/kinematics.h"

namespace gonio::robot {

enum class Family { three_parallel, spherical_wrist, general };
std::string name_of(Family family);

using Joints = std::array<double, 6>;  // rad

struct JointAnswer {
  Joints joints_rad{};                                  // each in (-pi, pi]
  int branch = -1;                                      // 0..7, see branch_name; -1: the arm has no named branches
  double position_error_m = 0, rotation_error_rad = 0;  // what is left between the flange there and the pose
  bool exact = false;         // both below InverseKinematics::exact_limit; else a least-squares answer: out of reach
  bool undetermined = false;  // a joint is free here (two axes in line): it stands where `near` has it
};

// The Jacobian's determinant is their product and a constant. Each vanishes at one kind of singular posture, and its
// sign is one bit of the branch.
struct SingularFactors {
  double shoulder_m = 0;  // of the wrist's centre from the plane of axis 1 and axis 2's direction
  double elbow = 0;       // sine of the angle at the elbow: 0 stretched or folded
  double wrist = 0;       // sine between axis 6 and axis 4 (spherical), or the parallel axes
};

class InverseKinematics {
 public:
  static constexpr double exact_limit = 1e-9;  // m, rad

  // Error(data) at `place` unless there are six links and all their numbers are finite.
  explicit InverseKinematics(std::span<const Link> links, const std::string& place = "robot");
  ~InverseKinematics();
  InverseKinematics(InverseKinematics&&) noexcept;
  InverseKinematics& operator=(InverseKinematics&&) noexcept;

  Family family() const;
  bool has_branches() const;  // answers carry numbers 0..7

  // All exact answers, by branch and, where branches have no names, by joint angles; where there is none, the
  // least-squares ones, best first. Two answers that agree to 1e-6 rad are one. `near_rad`: what joints take that the
  // pose leaves free, in a singular posture (zero unless given): with the previous answer of a path, the joints do not
  // jump there.
  std::vector<JointAnswer> solve(const Rigid<frame::Base, frame::Tool>& base_from_tool,
                                 const Joints& near_rad = {}) const;

  // The branch that joints stand in, -1 where the arm has no named branches. At a singular posture two branches meet:
  // either may be returned.
  int branch_of(const Joints& joints_rad) const;
  // What makes the branches, with signs; none where they have no names.
  std::optional<SingularFactors> factors_at(const Joints& joints_rad) const;

 private:
  struct Parts;
  std::unique_ptr<const Parts> parts_;
};

// "shoulder left, elbow up, wrist flipped": bits 4, 2, 1 of the number. They are signs of SingularFactors, so that none
// changes unless joints pass through a singular posture.
//   shoulder  left (0): axis 2 points to the left, seen from axis 1 towards the wrist's centre; right (4)
//   elbow     up (0): the elbow lies on the side of axis 1's direction, seen from the line from shoulder to wrist; down
//   wrist     not flipped (0): turning joint 5 forwards takes axis 6 further from axis 4 (spherical wrist) or from the
//             parallel axes
std::string branch_name(int branch);

}  // namespace gonio::robot
