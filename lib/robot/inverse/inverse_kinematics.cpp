// See inverse_kinematics.h: which closed form, from which end, and what becomes of its answers.
#include "robot/inverse/inverse_kinematics.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "robot/inverse/closed_form_parts.h"
#include "robot/inverse/general.h"
#include "robot/inverse/refine.h"
#include "robot/inverse/screws.h"

namespace gonio::robot {
namespace {

constexpr double same_rad = 1e-6;             // two answers are one
constexpr double good_enough = 1e-12;         // m, rad: closed forms that come so near are not refined
constexpr double rounding_at_meeting = 1e-6;  // m, rad
constexpr double exactly_so = 1e-10;          // rad, and of the arm's size: rounding of the rows that describe it
constexpr int newton_steps = 30, few_steps = 10, descent_steps = 200;

bool is_same(const Joints& a, const Joints& b, double limit_rad) {
  for (std::size_t i = 0; i < 6; ++i)
    if (std::abs(screws::wrapped(a[i] - b[i])) > limit_rad) return false;
  return true;
}

class Answers {
 public:
  template <class Test>
  bool any(const Test& test) const {
    return std::any_of(kept_.begin(), kept_.end(), test);
  }
  int size() const { return static_cast<int>(kept_.size()); }
  void keep(const JointAnswer& answer, double same_within_rad) {
    for (JointAnswer& known : kept_)
      if (is_same(known.joints_rad, answer.joints_rad, same_within_rad)) {
        known.branch = std::min(known.branch, answer.branch);
        return;
      }
    kept_.push_back(answer);
  }
  std::vector<JointAnswer> by_branch() {
    std::sort(kept_.begin(), kept_.end(), [](const JointAnswer& a, const JointAnswer& b) {
      return a.branch != b.branch ? a.branch < b.branch : a.joints_rad < b.joints_rad;
    });
    return kept_;
  }
  std::vector<JointAnswer> by_error(double size_m) {
    by_branch();
    // In steps of 1e-9: errors that differ by rounding leave the order as it is.
    const auto cost = [&](const JointAnswer& a) {
      return std::llround((a.position_error_m / size_m + a.rotation_error_rad) * 1e9);
    };
    std::stable_sort(kept_.begin(), kept_.end(),
                     [&](const JointAnswer& a, const JointAnswer& b) { return cost(a) < cost(b); });
    return kept_;
  }

 private:
  std::vector<JointAnswer> kept_;
};

Joints in_reverse(const Joints& joints) {
  Joints other;
  std::reverse_copy(joints.begin(), joints.end(), other.begin());
  return other;
}

}  // namespace

struct InverseKinematics::Parts {
  screws::Screws arm, solved;  // `solved`: the same, or seen from the flange
  bool from_flange = false;
  std::optional<closed_form::ThreeParallel> parallel;
  std::optional<closed_form::SphericalWrist> spherical;
  bool departs = false;                      // the closed form solves the arm beside the true one
  double apart_rad = 0;                      // closed_form::Hints
  std::optional<general::AllRoots> general;  // without a closed form, and where the one beside loses answers

  std::optional<general::AllRoots>
      backwards;  // the same from the flange: special geometry may keep what the other loses

  bool take(const screws::Screws& s, bool reverse);
  std::vector<JointAnswer> candidates(const screws::Pose& wanted, const closed_form::Hints& hints) const;
  std::vector<JointAnswer> all_round(const screws::Pose& wanted) const;
  bool is_plausible(const JointAnswer& start, const screws::Pose& wanted) const;
  bool is_delicate(const std::optional<SingularFactors>& factors) const;
  std::vector<JointAnswer> roots(const screws::Pose& wanted) const;
  JointAnswer led(const JointAnswer& start, const screws::Pose& wanted, int steps) const;
};

bool InverseKinematics::Parts::take(const screws::Screws& s, bool reverse) {
  parallel = closed_form::ThreeParallel::of(s);
  if (!parallel) spherical = closed_form::SphericalWrist::of(s);
  if (!parallel && !spherical) return false;
  solved = s, from_flange = reverse;
  const closed_form::Departure by = parallel ? parallel->departure() : spherical->departure();
  const double relative = std::max(by.angle_rad, by.gap_m / s.size_m);
  departs = relative > exactly_so;
  // Where two branches meet, a small change of the arm moves them by its root.
  if (departs) {
    apart_rad = std::clamp(std::sqrt(relative), 1e-3, 0.2);
    general.emplace(arm);
  }
  return true;
}

std::vector<JointAnswer> InverseKinematics::Parts::candidates(const screws::Pose& wanted,
                                                              const closed_form::Hints& hints) const {
  std::vector<JointAnswer> answers;
  if (!parallel && !spherical) return roots(wanted);
  const screws::Pose pose = from_flange ? screws::inverse(wanted) : wanted;
  for (const auto& c : parallel ? parallel->solve(pose, hints) : spherical->solve(pose, hints)) {
    const Joints joints = from_flange ? in_reverse(c.joints_rad) : c.joints_rad;
    answers.push_back({joints, from_flange ? -1 : c.branch, 0, 0, false, c.undetermined && !departs});
  }
  return answers;
}

// Of the arm beside the true one: within what the two may differ by. A stretched elbow opens by the root of what is
// missing, a wrist by as much as its axes are off.
bool InverseKinematics::Parts::is_plausible(const JointAnswer& start, const screws::Pose& wanted) const {
  const screws::Refined at = screws::measured(arm, wanted, start.joints_rad);
  return at.position_error_m < 4 * apart_rad * apart_rad * arm.size_m && at.rotation_error_rad < 2 * apart_rad;
}

// So near to a singular posture that the true arm may have other answers than the one beside it.
bool InverseKinematics::Parts::is_delicate(const std::optional<SingularFactors>& factors) const {
  const double off = apart_rad * apart_rad;
  return factors && (std::abs(factors->wrist) < 8 * off || std::abs(factors->elbow) < 2 * apart_rad ||
                     std::abs(factors->shoulder_m) < 8 * off * arm.size_m);
}

// Where the wrist's axes come into line the arm beside the true one does not tell how joints 4 and 6 share their turn:
// they start all round. Where elbow or shoulder stretch, from further apart.
std::vector<JointAnswer> InverseKinematics::Parts::all_round(const screws::Pose& wanted) const {
  constexpr int count = 8;
  std::vector<JointAnswer> all;
  for (int i = 0; i < count; ++i) {
    const double turn = 2 * pi * i / count - pi;
    const closed_form::Hints hints{{0, 0, 0, turn, 0, turn}, apart_rad * (1 + i) / count * 2, 3 * apart_rad};
    for (const JointAnswer& start : candidates(wanted, hints)) all.push_back(start);
  }
  return all;
}

std::vector<JointAnswer> InverseKinematics::Parts::roots(const screws::Pose& wanted) const {
  std::vector<JointAnswer> all;
  for (const Joints& joints : general->starts(wanted)) all.push_back({joints, -1, 0, 0, false, false});
  if (backwards)
    for (const Joints& joints : backwards->starts(screws::inverse(wanted)))
      all.push_back({in_reverse(joints), -1, 0, 0, false, false});
  return all;
}

JointAnswer InverseKinematics::Parts::led(const JointAnswer& start, const screws::Pose& wanted, int steps) const {
  screws::Refined there = screws::measured(arm, wanted, start.joints_rad);
  const auto miss = [](const screws::Refined& r) { return std::max(r.position_error_m, r.rotation_error_rad); };
  // A closed form that misses an arm that it fits is out of reach, beyond what rounding does where branches meet:
  // Newton's method would find another branch's answer.
  const bool within = departs || general || miss(there) < rounding_at_meeting;
  if (steps > 0 && within && miss(there) > good_enough) {
    const screws::Refined better = screws::refined(arm, wanted, start.joints_rad, steps);
    // Of an arm that its closed form fits, answers out of reach stay as the subproblems have them: continuous.
    if (departs || general || miss(better) <= exact_limit) there = better;
  }
  JointAnswer answer = start;
  for (std::size_t i = 0; i < 6; ++i) answer.joints_rad[i] = screws::wrapped(there.joints_rad[i]);
  answer.position_error_m = there.position_error_m, answer.rotation_error_rad = there.rotation_error_rad;
  answer.exact = miss(there) <= exact_limit;
  return answer;
}

InverseKinematics::InverseKinematics(std::span<const Link> links, const std::string& place) {
  if (links.size() != 6)
    throw Error(Exit::data, place, "has " + std::to_string(links.size()) + " joints, inverse kinematics are for 6");
  for (const Link& l : links)
    if (!std::isfinite(l.a_m + l.d_m + l.alpha_rad + l.theta_rad))
      throw Error(Exit::data, place, "a link's numbers are not finite");
  auto parts = std::make_unique<Parts>();
  parts->arm = screws::screws_of(links);
  if (!parts->take(parts->arm, false) && !parts->take(screws::reversed(parts->arm), true))
    parts->general.emplace(parts->arm), parts->backwards.emplace(screws::reversed(parts->arm));
  parts_ = std::move(parts);
}
InverseKinematics::~InverseKinematics() = default;
InverseKinematics::InverseKinematics(InverseKinematics&&) noexcept = default;
InverseKinematics& InverseKinematics::operator=(InverseKinematics&&) noexcept = default;

Family InverseKinematics::family() const {
  return parts_->parallel ? Family::three_parallel : parts_->spherical ? Family::spherical_wrist : Family::general;
}

bool InverseKinematics::has_branches() const {
  if (parts_->from_flange || family() == Family::general) return false;
  return parts_->parallel ? parts_->parallel->has_branches() : parts_->spherical->has_branches();
}

std::optional<SingularFactors> InverseKinematics::factors_at(const Joints& joints_rad) const {
  if (!has_branches()) return std::nullopt;
  return parts_->parallel ? parts_->parallel->factors_at(joints_rad) : parts_->spherical->factors_at(joints_rad);
}

int InverseKinematics::branch_of(const Joints& joints_rad) const {
  const std::optional<SingularFactors> factors = factors_at(joints_rad);
  if (!factors) return -1;
  const bool right = factors->shoulder_m<0, rising = factors->elbow> 0;
  return right * closed_form::right_bit + (rising == right) * closed_form::down_bit +
         (factors->wrist < 0) * closed_form::flip_bit;
}

std::vector<JointAnswer> InverseKinematics::solve(const Rigid<frame::Base, frame::Tool>& base_from_tool,
                                                  const Joints& near_rad) const {
  const screws::Pose wanted = screws::pose_of(base_from_tool);
  const Parts& p = *parts_;
  const std::vector<JointAnswer> starts =
      p.candidates(wanted, {p.from_flange ? in_reverse(near_rad) : near_rad, p.apart_rad});
  Answers answers;
  int expected = 0;
  const auto lead = [&](const JointAnswer& start, int steps) {
    JointAnswer answer = p.led(start, wanted, steps);
    // Newton's method may cross to another branch where two meet.
    if (p.departs && answer.exact && (answer.branch < 0 || !is_same(answer.joints_rad, start.joints_rad, p.apart_rad)))
      answer.branch = branch_of(answer.joints_rad);
    if (answer.exact) answers.keep(answer, same_rad);
  };
  for (const JointAnswer& start : starts) {
    lead(start, newton_steps);
    expected += p.departs && p.is_plausible(start, wanted);
  }
  // Of a calibrated arm, near singular postures: 8 answers that the arm beside it has may be 10, and some that it has
  // may not be there. Answers come in pairs: an odd count lacks one.
  const auto complete = [&] { return answers.size() >= expected && answers.size() % 2 == 0; };
  if (p.departs &&
      (!complete() || answers.any([&](const JointAnswer& a) { return p.is_delicate(factors_at(a.joints_rad)); })))
    for (const JointAnswer& start : p.roots(wanted)) lead(start, newton_steps);
  if (p.departs && !complete())
    for (const JointAnswer& start : p.all_round(wanted)) lead(start, few_steps);
  if (answers.size() > 0) return answers.by_branch();
  const bool descend = p.departs || p.general;
  for (const JointAnswer& start : starts)
    answers.keep(p.led(start, wanted, descend ? descent_steps : 0), descend ? 1e-3 : same_rad);
  return answers.by_error(p.arm.size_m);
}

std::string name_of(Family family) {
  return family == Family::three_parallel    ? "three parallel axes"
         : family == Family::spherical_wrist ? "spherical wrist"
                                             : "general";
}

std::string branch_name(int branch) {
  if (branch < 0 || branch > 7) return "no named branch";
  return std::string(branch & 4 ? "shoulder right" : "shoulder left") + (branch & 2 ? ", elbow down" : ", elbow up") +
         (branch & 1 ? ", wrist flipped" : ", wrist not flipped");
}

}  // namespace gonio::robot
