// Arms with a closed form. Each is made from an arm's screws where they come near enough to its geometry, and solves
// the arm that has that geometry exactly: the given one, or (a calibrated arm) the one beside it.
//
// Factors that make branches (inverse_kinematics.h), all at joints q, with v the way from axis 1 to the wrist's centre
// w and h the parallel axes' direction, seen from link 1, a the way from axis 2 to axis 3, b from axis 3 to axis 4 (w):
//   shoulder  h . (h1 x v)        elbow  h . (a x R3 b), times the shoulder's        wrist  -d/dq5 of h(4) . R5 h6
// They are the factors of det J: all three are derivatives of the equations that are solved for q1, q3, q5.
#pragma once
#include <optional>

#include "robot/inverse/screws.h"
#include "robot/inverse/subproblems.h"

namespace gonio::robot::closed_form {

struct Candidate {
  Joints joints_rad{};
  int branch = -1;
  bool undetermined = false;  // a joint was free and took what it has in `near`
};
using Candidates = subproblem::Few<Candidate, 8>;

// How far an arm may be from a geometry to be solved through it: beyond what calibrations measure (UR: 0.008 rad,
// 0.2 mm; hundredths of the arm's size for arms of other makers).
inline constexpr double near_angle_rad = 0.03, near_gap = 0.02;  // rad; of size_m

struct Departure {  // of the true axes from those solved
  double angle_rad = 0, gap_m = 0;
};

// What a pose is solved with beside it.
struct Hints {
  Joints near_rad{};
  double apart_rad = 0;  // two branches start at least so far from where they meet: for Newton's method on another arm
  // The wrist's axes count as in line below this sine, one joint as free: rounding alone moves it.
  double in_line = 1e-10;
};

class ThreeParallel {  // axes 2, 3, 4
 public:
  static std::optional<ThreeParallel> of(const screws::Screws& screws);
  Candidates solve(const screws::Pose& wanted, const Hints& hints) const;
  std::optional<SingularFactors> factors_at(const Joints& joints_rad) const;  // none where axes 5 and 6 do not meet
  Departure departure() const { return departure_; }
  bool has_branches() const { return meet_; }

 private:
  struct Outer {
    double q1 = 0, q5 = 0;
    int branch = 0;
    bool undetermined = false;
  };
  subproblem::Few<Outer, 4> outer(const screws::Pose& wanted, const Hints& hints) const;
  void inner(const screws::Pose& wanted, const Outer& outer, const Hints& hints, Candidates& answers) const;
  screws::Screws s_;
  Vec3 h_, upper_, fore_;                 // a, b: across h
  std::array<double, 3> sense_{1, 1, 1};  // of axes 2, 3, 4 along h
  bool meet_ = false;                     // axes 5 and 6, in point 5 (= 6)
  Departure departure_;
};

class SphericalWrist {  // axes 4, 5, 6 meet
 public:
  static std::optional<SphericalWrist> of(const screws::Screws& screws);
  Candidates solve(const screws::Pose& wanted, const Hints& hints) const;
  std::optional<SingularFactors> factors_at(
      const Joints& joints_rad) const;  // none where axes 2 and 3 are not parallel
  Departure departure() const { return departure_; }
  bool has_branches() const { return parallel_; }

 private:
  struct Arm {
    Joints joints_rad{};
    int branch = 0;
    bool undetermined = false;
  };
  subproblem::Few<Arm, 4> arm_of(Vec3 wrist_m, const Hints& hints) const;
  void wrist(const screws::Pose& wanted, const Arm& arm, const Hints& hints, Candidates& answers) const;
  screws::Screws s_;
  Vec3 upper_, fore_;      // across h where axes 2 and 3 are parallel
  double sense_ = 1;       // of axis 3 along axis 2
  bool parallel_ = false;  // axes 2 and 3
  Departure departure_;
};

}  // namespace gonio::robot::closed_form
