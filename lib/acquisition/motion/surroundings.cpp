// See way.h. Of all pairs, few are near: the rest is ruled out by bounds (body.h), the nearest by their bound first.
#include <algorithm>
#include <cmath>

#include "acquisition/motion/body.h"
#include "acquisition/motion/exact_distance.h"
#include "acquisition/motion/reach.h"
#include "acquisition/motion/way.h"
#include "base/random.h"

namespace gonio::acquisition {
namespace {

constexpr int postures = 1000;         // in which pairs of one arm are looked at
constexpr double nearly_every = 0.95;  // of them

struct WatchedPair {
  std::size_t a = 0, b = 0;
};

bool may_meet(const Body& a, const Body& b) {  // so that nobody watches them
  const auto fixed = [](const Body& body) { return body.arm < 0 || body.solid->link == 0; };
  if (fixed(a) && fixed(b)) return true;
  if (a.arm != b.arm) return false;
  if (a.solid->link == b.solid->link) return true;
  if (a.solid->carried || b.solid->carried) return false;
  return std::abs(a.solid->link - b.solid->link) == 1;
}

Joints random_posture(const LaboratoryArm& arm, Random& random) {
  Joints joints;
  for (const robot::JointLimit& limit : arm.limits)
    joints.push_back(random.uniform(std::isfinite(limit.lower_rad) ? limit.lower_rad : -pi,
                                    std::isfinite(limit.upper_rad) ? limit.upper_rad : pi));
  return joints;
}

}  // namespace

struct Surroundings::Parts {
  Laboratory laboratory;
  std::vector<Body> bodies;
  ExactDistances exact;
  std::vector<WatchedPair> pairs;
  std::vector<Clearance> left_out;
  std::map<std::string, std::vector<double>> reach;

  explicit Parts(const Laboratory& given) : laboratory(given), bodies(bodies_of(laboratory)), exact(bodies) {
    for (const auto& [name, arm] : laboratory.arms) reach[name] = reaches(arm);
    for (std::size_t a = 0; a < bodies.size(); ++a)
      for (std::size_t b = a + 1; b < bodies.size(); ++b)
        if (!may_meet(bodies[a], bodies[b])) pairs.push_back({a, b});
    int index = 0;
    for (const auto& [name, arm] : laboratory.arms) leave_out(arm, index++);
  }

  double lower_bound(const WatchedPair& pair, const std::vector<PlacedBody>& at) const {
    return std::max(ball_gap(bodies[pair.a], at[pair.a], bodies[pair.b], at[pair.b]),
                    plane_gap(bodies[pair.a], at[pair.a], bodies[pair.b], at[pair.b]));
  }
  double exactly(const WatchedPair& pair, const std::vector<PlacedBody>& at) const {
    return exact.between(pair.a, at[pair.a], pair.b, at[pair.b]);
  }
  Clearance named(const WatchedPair& pair, double distance_m) const {
    return {distance_m, bodies[pair.a].solid->name, bodies[pair.b].solid->name};
  }

  bool moved_by(const WatchedPair& pair, int index) const {  // and by no other arm
    const auto stands = [&](const Body& body) { return body.arm < 0 || body.solid->link == 0 || body.arm == index; };
    return stands(bodies[pair.a]) && stands(bodies[pair.b]);
  }
  // Two links apart: what they do to each other hangs on two joints, which the postures below fill.
  bool mere_neighbours(const WatchedPair& pair) const {
    const Body &a = bodies[pair.a], &b = bodies[pair.b];
    return a.arm == b.arm && !a.solid->carried && !b.solid->carried && std::abs(a.solid->link - b.solid->link) == 2;
  }

  void leave_out(const LaboratoryArm& arm, int index) {
    std::vector<WatchedPair> own;
    for (const WatchedPair& pair : pairs)
      if (moved_by(pair, index)) own.push_back(pair);
    std::vector<int> near(own.size()), touching(own.size());
    std::vector<double> smallest(own.size(), std::numeric_limits<double>::infinity());
    Random random(1, static_cast<std::uint64_t>(index));
    for (int k = 0; k < postures; ++k) {
      const std::vector<PlacedBody> at = placed(laboratory, bodies, {{arm.name, random_posture(arm, random)}});
      for (std::size_t i = 0; i < own.size(); ++i) {
        const bool ever_far = near[i] < k - static_cast<int>((1 - nearly_every) * postures);
        if (ever_far && (touching[i] > 0 || !mere_neighbours(own[i]))) continue;  // it is watched
        const double bound = lower_bound(own[i], at);
        const double distance = bound > laboratory.margin_m ? bound : exactly(own[i], at);
        smallest[i] = std::min(smallest[i], distance);
        if (distance <= laboratory.margin_m) ++near[i];
        if (distance <= 0) ++touching[i];
      }
    }
    for (std::size_t i = 0; i < own.size(); ++i) {
      const bool never = touching[i] == 0 && mere_neighbours(own[i]);
      if (near[i] < nearly_every * postures && !never) continue;
      left_out.push_back(named(own[i], smallest[i]));
      std::erase_if(pairs, [&](const WatchedPair& p) { return p.a == own[i].a && p.b == own[i].b; });
    }
  }
};

Surroundings::Surroundings(const Laboratory& laboratory) : parts_(std::make_unique<const Parts>(laboratory)) {}
Surroundings::~Surroundings() = default;

Clearance Surroundings::clearance(const State& state, double enough_m) const {
  const Parts& p = *parts_;
  const std::vector<PlacedBody> at = placed(p.laboratory, p.bodies, state);
  struct Bounded {
    double least_m;
    std::size_t pair;
  };
  std::vector<Bounded> near;
  Clearance best{enough_m, "", ""};
  for (std::size_t i = 0; i < p.pairs.size(); ++i) {
    const WatchedPair& pair = p.pairs[i];
    if (ball_gap(p.bodies[pair.a], at[pair.a], p.bodies[pair.b], at[pair.b]) >= enough_m) continue;
    const double least = p.lower_bound(pair, at);
    if (least < enough_m) near.push_back({least, i});
  }
  std::sort(near.begin(), near.end(), [](const Bounded& x, const Bounded& y) {
    return x.least_m != y.least_m ? x.least_m < y.least_m : x.pair < y.pair;
  });
  for (const Bounded& candidate : near) {
    if (candidate.least_m >= best.distance_m || best.distance_m <= 0) break;
    const double distance = p.exactly(p.pairs[candidate.pair], at);
    if (distance < best.distance_m) best = p.named(p.pairs[candidate.pair], distance);
  }
  return best;
}

bool Surroundings::free(const State& state, double margin_m) const {
  const Parts& p = *parts_;
  const std::vector<PlacedBody> at = placed(p.laboratory, p.bodies, state);
  for (const WatchedPair& pair : p.pairs) {
    if (ball_gap(p.bodies[pair.a], at[pair.a], p.bodies[pair.b], at[pair.b]) > margin_m) continue;
    if (plane_gap(p.bodies[pair.a], at[pair.a], p.bodies[pair.b], at[pair.b]) > margin_m) continue;
    if (p.exactly(pair, at) <= margin_m) return false;
  }
  return true;
}

const std::vector<Clearance>& Surroundings::left_out() const {
  return parts_->left_out;
}

double Surroundings::change_m(const State& from, const State& to) const {
  double sum = 0;
  for (const auto& [name, arm] : parts_->laboratory.arms) {
    const Joints &a = joints_of(arm, from), &b = joints_of(arm, to);
    const std::vector<double>& reach = parts_->reach.at(name);
    for (std::size_t i = 0; i < a.size(); ++i) sum += std::fabs(b[i] - a[i]) * reach[i];
  }
  return sum;
}

}  // namespace gonio::acquisition
