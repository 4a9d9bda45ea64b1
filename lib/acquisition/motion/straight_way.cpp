// See way.h. The line is walked in steps that are halved until the joints' straight line between its ends keeps the
// tool on the line: the joints at the far end are the answer of the inverse kinematics nearest to those at the near
// end.
#include <algorithm>
#include <cmath>

#include "acquisition/motion/line.h"
#include "acquisition/motion/way.h"
#include "base/error.h"
#include "base/text.h"
#include "robot/inverse/inverse_kinematics.h"
#include "robot/inverse/singularity.h"
#include "robot/inverse/turns.h"

namespace gonio::acquisition {
namespace {

using Flange = Rigid<frame::World, frame::Tool>;

constexpr double largest_step = 1.0 / 16, smallest_step = 1e-6;  // of the line
constexpr double flip_rad = 0.25;                                // no joint turns by more in a step

class StraightLine {
 public:
  StraightLine(const Laboratory& laboratory, const LaboratoryArm& arm, const Joints& start, const Flange& end,
               double deviation_m)
      : laboratory_(laboratory), arm_(arm), inverse_(arm.links, arm.name), deviation_m_(deviation_m) {
    std::copy(start.begin(), start.end(), now_.begin());
    begin_ = world_from_tool(arm, start);
    shift_m_ = end.translation_m - begin_.translation_m;
    turn_rad_ = rotation_vector_of(normalized(end.rotation * conjugate(begin_.rotation)));
  }

  // The joints at every step but the first; nothing, and why_, where it ends before the line does.
  bool walk(std::vector<Joints>& states) {
    double done = 0, step = largest_step;
    while (done < 1) {
      const double next = 1 - done < 1.5 * step ? 1 : done + step;
      const std::optional<robot::Joints> joints = joints_at(next);
      if (joints && follows(*joints, done, next)) {
        now_ = *joints;
        states.emplace_back(now_.begin(), now_.end());
        done = next;
        step = std::min(1.5 * step, largest_step);
        continue;
      }
      step = std::min(step, next - done) / 2;
      if (step < smallest_step) {
        why_ = (why_.empty() ? "a joint would flip" : why_) + format(" at %.1f %% of the line", 100 * done);
        return false;
      }
    }
    return true;
  }
  const std::string& why() const { return why_; }

 private:
  Flange at(double share) const {
    return {normalized(quaternion_of_rotation_vector(turn_rad_ * share) * begin_.rotation),
            begin_.translation_m + shift_m_ * share};
  }

  std::optional<robot::Joints> joints_at(double share) {
    const auto answers = inverse_.solve(wanted_of_links(arm_, at(share)), now_);
    std::optional<robot::Joints> best;
    double best_turn = std::numeric_limits<double>::infinity();
    why_ = answers.empty() || !answers.front().exact ? "out of reach" : "";
    for (const robot::JointAnswer& answer : answers) {
      if (!answer.exact) continue;
      // As far as limits go later: the nearest turns decide which answer goes on with the line.
      const std::vector<robot::JointLimit> none(6);
      const robot::Joints turned = robot::with_turns(answer.joints_rad, now_, none).value_or(answer.joints_rad);
      double turn = 0;
      for (std::size_t i = 0; i < 6; ++i) turn = std::max(turn, std::fabs(turned[i] - now_[i]));
      if (turn < best_turn) best = turned, best_turn = turn;
    }
    if (!best) return best;
    if (best_turn > flip_rad) {
      why_ = "a joint would flip";
      return std::nullopt;
    }
    why_ = broken_limit(arm_, {best->begin(), best->end()});
    const double singular = robot::smallest_singular_m(arm_.links, *best, singular_length_m);
    if (why_.empty() && singular < laboratory_.smallest_singular_m)
      why_ = format("smallest singular value %.4f m, limit %.4f m", singular, laboratory_.smallest_singular_m);
    return why_.empty() ? best : std::nullopt;
  }

  // Whether the joints' straight line from now_ keeps the flange within the deviation, where the line is from `done` to
  // `next`. A cubic deviates most near its thirds or its middle.
  bool follows(const robot::Joints& joints, double done, double next) const {
    const double length = norm(shift_m_);
    for (const double t : {0.2, 0.35, 0.5, 0.65, 0.8}) {
      Joints mixed(6);
      for (std::size_t i = 0; i < 6; ++i) mixed[i] = now_[i] + t * (joints[i] - now_[i]);
      const Flange is = world_from_tool(arm_, mixed);
      const Vec3 off = is.translation_m - begin_.translation_m;
      const double along = length > 0 ? dot(off, shift_m_) / (length * length) : 0;
      if (norm(off - shift_m_ * along) > 0.9 * deviation_m_) return false;
      // What it carries does not swing either: the rotation is that of the place on the line.
      const double share = length > 0 ? std::clamp(along, done, next) : done + t * (next - done);
      const Quaternion turn = normalized(is.rotation * conjugate(at(share).rotation));
      if (norm(rotation_vector_of(turn)) * singular_length_m > 10 * deviation_m_) return false;
    }
    return true;
  }

  const Laboratory& laboratory_;
  const LaboratoryArm& arm_;
  robot::InverseKinematics inverse_;
  double deviation_m_;
  robot::Joints now_{};
  Flange begin_{};
  Vec3 shift_m_{}, turn_rad_{};
  std::string why_;
};

}  // namespace

std::optional<Way> straight_way(const Laboratory& laboratory, const State& from, const std::string& arm,
                                const Flange& to, double deviation_m, std::string* why) {
  const auto found = laboratory.arms.find(arm);
  if (found == laboratory.arms.end()) throw Error(Exit::data, arm, "is no arm of the laboratory");
  const Joints& start = joints_of(found->second, from);
  std::vector<Joints> states;
  std::string reason = broken_limit(found->second, start);
  if (reason.empty()) {
    StraightLine line(laboratory, found->second, start, to, deviation_m);
    if (!line.walk(states)) reason = line.why();
  }
  if (!reason.empty()) {
    if (why != nullptr) *why = arm + ": " + reason;
    return std::nullopt;
  }
  Way way{between(laboratory, from, from, 0)};
  for (Joints& joints : states) {
    way.push_back(way.back());
    way.back()[arm] = std::move(joints);
  }
  return way;
}

}  // namespace gonio::acquisition
