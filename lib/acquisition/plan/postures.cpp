#include "acquisition/plan/postures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "acquisition/motion/line.h"
#include "acquisition/motion/way.h"
#include "base/text.h"
#include "robot/inverse/inverse_kinematics.h"
#include "robot/inverse/turns.h"

namespace gonio::acquisition {
namespace {

constexpr std::size_t turns_of_one = 4;  // of one answer of the inverse kinematics, nearest to home first

// What stops candidates: how many of a kind, and how the first of them says it.
struct Stopped {
  struct Kind {
    std::size_t count = 0;
    std::string words;  // empty: to be asked of `joints`
    Joints joints;
  };
  std::map<std::string, Kind> by_kind;
  void add(const std::string& kind, const std::string& words, const Joints& joints) {
    Kind& k = by_kind[kind];
    if (k.count++ == 0) k.words = words, k.joints = joints;
  }
  std::string elsewhere;  // the first of other branches than home's
  const Kind* most() const {
    const Kind* worst = nullptr;
    for (const auto& [kind, k] : by_kind)
      if (worst == nullptr || k.count > worst->count) worst = &k;
    return worst;
  }
  std::size_t all() const {
    std::size_t sum = 0;
    for (const auto& [kind, k] : by_kind) sum += k.count;
    return sum;
  }
};

struct Posture {
  Joints joints;
  double far = 0;  // from home: length of the joints' difference, so that a joint that is free stays near home too
};

}  // namespace

struct PostureSearch::Parts {
  Laboratory alone;  // this arm and what stands
  const LaboratoryArm* arm;
  robot::InverseKinematics inverse;
  robot::Joints home;
  int home_branch = -1;  // -1: the arm's branches have no names
  std::unique_ptr<Surroundings> surroundings;

  Parts(const Laboratory& laboratory, const std::string& name)
      : alone(laboratory), arm(nullptr), inverse(laboratory.arms.at(name).links, name), home{} {
    std::erase_if(alone.arms, [&](const auto& entry) { return entry.first != name; });
    arm = &alone.arms.at(name);
    std::copy_n(arm->home.begin(), home.size(), home.begin());
    if (inverse.has_branches()) home_branch = inverse.branch_of(home);
    surroundings = std::make_unique<Surroundings>(alone);
  }

  void add_turns(const robot::JointAnswer& answer, std::vector<Posture>& found, Stopped& stopped) const {
    const std::vector<robot::Joints> turned = robot::all_turns(answer.joints_rad, home, arm->limits);
    if (turned.empty()) {
      const Joints joints(answer.joints_rad.begin(), answer.joints_rad.end());
      stopped.add("limit", broken_limit(*arm, joints), joints);
    }
    for (std::size_t k = 0; k < std::min(turned.size(), turns_of_one); ++k) {
      Posture p{{turned[k].begin(), turned[k].end()}, 0};
      for (std::size_t j = 0; j < home.size(); ++j) p.far = std::hypot(p.far, turned[k][j] - home[j]);
      found.push_back(std::move(p));
    }
  }

  bool good(const Joints& joints, Stopped& stopped) const {
    const State state{{arm->name, joints}};
    const double singular = smallest_singular(alone, state);
    if (const std::string broken = broken_at(alone, state, singular); !broken.empty()) {
      stopped.add(singular < alone.smallest_singular_m ? "singular" : "limit", broken, joints);
      return false;
    }
    if (surroundings->free(state, alone.margin_m)) return true;
    stopped.add("touches", "", joints);
    return false;
  }

  std::string words(const Stopped& stopped) const {
    const Stopped::Kind* most = stopped.most();
    if (most == nullptr) return stopped.elsewhere;
    std::string text = most->words;
    if (text.empty()) {
      const Clearance c = surroundings->clearance({{arm->name, most->joints}}, alone.margin_m + 1e-6);
      text = format("%s comes within %.3g m of %s, limit %.3g m", c.first.c_str(), c.distance_m, c.second.c_str(),
                    alone.margin_m);
    }
    return text + (stopped.all() > 1 ? format(" (%zu of %zu postures)", most->count, stopped.all()) : "");
  }
};

PostureSearch::PostureSearch(const Laboratory& laboratory, const std::string& arm)
    : parts_(std::make_unique<const Parts>(laboratory, arm)) {}
PostureSearch::~PostureSearch() = default;

Postures PostureSearch::find(const std::vector<Rigid<frame::World, frame::Tool>>& tools, std::size_t most) const {
  const Parts& p = *parts_;
  std::vector<Posture> found;
  Stopped stopped;
  double least_error = std::numeric_limits<double>::infinity();
  for (const auto& tool : tools) {
    const std::vector<robot::JointAnswer> answers = p.inverse.solve(inverse(p.arm->world_from_base) * tool, p.home);
    for (const robot::JointAnswer& answer : answers) {
      if (!answer.exact)
        least_error = std::min(least_error, answer.position_error_m);
      else if (p.home_branch < 0 || answer.branch == p.home_branch)
        p.add_turns(answer, found, stopped);
      else if (stopped.elsewhere.empty())
        stopped.elsewhere = format("%s reaches it only with %s, and between there and home (%s) lie singular postures",
                                   p.arm->name.c_str(), robot::branch_name(answer.branch).c_str(),
                                   robot::branch_name(p.home_branch).c_str());
    }
  }
  if (found.empty() && std::isfinite(least_error) && stopped.by_kind.empty() && stopped.elsewhere.empty())
    return {{}, format("out of reach of %s, whose flange ends %.3g m short", p.arm->name.c_str(), least_error)};
  std::ranges::stable_sort(found, {}, &Posture::far);
  Postures postures;
  for (const Posture& posture : found) {
    if (postures.all.size() == most) break;
    if (p.good(posture.joints, stopped)) postures.all.push_back(posture.joints);
  }
  if (postures.all.empty()) postures.why = p.words(stopped);
  return postures;
}

}  // namespace gonio::acquisition
