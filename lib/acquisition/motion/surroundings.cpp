// See way.h. Of all pairs, few are near: the rest is ruled out by bounds (body.h), the nearest by their bound first.
#include <algorithm>
#include <cmath>

#include "acquisition/motion/body.h"
#include "acquisition/motion/exact_distance.h"
#include "acquisition/motion/line.h"
#include "acquisition/motion/reach.h"
#include "acquisition/motion/way.h"
#include "base/random.h"

namespace gonio::acquisition {
namespace {

constexpr int postures = 1000;         // in which pairs of one arm are looked at
constexpr double nearly_every = 0.95;  // of them
constexpr double often_close = 0.2;    // what is close so often and never touches is a joint's two housings

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
  std::vector<std::vector<double>> reach;  // of every body, by joint; empty: it stands

  explicit Parts(const Laboratory& given) : laboratory(given), bodies(bodies_of(laboratory)), exact(bodies) {
    for (const auto& [name, arm] : laboratory.arms)
      for (std::vector<double>& of_solid : reaches(arm)) reach.push_back(std::move(of_solid));
    reach.resize(bodies.size());
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

  void note_left_out(const Clearance& pair) {
    for (Clearance& known : left_out)
      if (known.first == pair.first && known.second == pair.second) {
        known.distance_m = std::min(known.distance_m, pair.distance_m);
        return;
      }
    left_out.push_back(pair);
  }

  void leave_out(const LaboratoryArm& arm, int index) {
    std::vector<WatchedPair> own;
    for (const WatchedPair& pair : pairs)
      if (moved_by(pair, index)) own.push_back(pair);
    std::vector<int> near(own.size()), close(own.size()), touching(own.size());
    std::vector<double> smallest(own.size(), std::numeric_limits<double>::infinity());
    Random random(1, static_cast<std::uint64_t>(index));
    for (int k = 0; k < postures; ++k) {
      const std::vector<PlacedBody> at = placed(laboratory, bodies, {{arm.name, random_posture(arm, random)}});
      for (std::size_t i = 0; i < own.size(); ++i) {
        const bool ever_far = near[i] < k - static_cast<int>((1 - nearly_every) * postures);
        if (ever_far && (touching[i] > 0 || !mere_neighbours(own[i]))) continue;  // it is watched
        const double bound = lower_bound(own[i], at);
        const double distance = bound > 1.5 * laboratory.margin_m ? bound : exactly(own[i], at);
        smallest[i] = std::min(smallest[i], distance);
        if (distance <= laboratory.margin_m) ++near[i];
        if (distance <= 1.5 * laboratory.margin_m) ++close[i];
        if (distance <= 0) ++touching[i];
      }
    }
    for (std::size_t i = 0; i < own.size(); ++i) {
      const bool never = touching[i] == 0 && close[i] > often_close * postures && mere_neighbours(own[i]);
      if (near[i] < nearly_every * postures && !never) continue;
      note_left_out(named(own[i], smallest[i]));
      std::erase_if(pairs, [&](const WatchedPair& p) { return p.a == own[i].a && p.b == own[i].b; });
    }
  }
};

namespace {

struct TravellingPair {
  WatchedPair pair;
  double travel_m = 0;  // how much the distance of the two changes at most, all along the line
};

}  // namespace

// Conservative advancement (Mirtich 1996) by halving: of a stretch, its middle is looked at; pairs that cannot come
// near on either side of it are done with, the others are looked at in both halves.
struct Surroundings::LineLook {
  const Parts& p;
  const State &from, &to;
  double stop_m, allowance_m;
  std::vector<std::vector<double>> turns;  // by arm and joint
  Nearest nearest;

  double travel(const WatchedPair& pair) const {
    const Body &a = p.bodies[pair.a], &b = p.bodies[pair.b];
    const auto moved = [&](std::size_t body, int first_joint) {
      double sum = 0;
      if (p.bodies[body].arm < 0) return sum;
      const std::vector<double>& joints = turns[static_cast<std::size_t>(p.bodies[body].arm)];
      for (auto j = static_cast<std::size_t>(first_joint); j < joints.size(); ++j) sum += joints[j] * p.reach[body][j];
      return sum;
    };
    if (a.arm != b.arm) return moved(pair.a, 0) + moved(pair.b, 0);
    // Seen from the inner one, only joints beyond it move the outer one.
    return a.solid->link < b.solid->link ? moved(pair.b, a.solid->link) : moved(pair.a, b.solid->link);
  }

  void halve(double t0, double t1, const std::vector<TravellingPair>& pairs) {
    const double middle = (t0 + t1) / 2, share = (t1 - t0) / 2;
    const std::vector<PlacedBody> at =
        placed(p.laboratory, p.bodies, acquisition::between(p.laboratory, from, to, middle));
    std::vector<std::pair<double, const TravellingPair*>> near;  // with a bound of their distance in the middle
    for (const TravellingPair& t : pairs) {
      if (harmless(ball_gap(p.bodies[t.pair.a], at[t.pair.a], p.bodies[t.pair.b], at[t.pair.b]), share * t.travel_m))
        continue;
      const double bound = p.lower_bound(t.pair, at);
      if (!harmless(bound, share * t.travel_m)) near.emplace_back(bound, &t);
    }
    std::sort(near.begin(), near.end(), [](const auto& x, const auto& y) {
      return x.first != y.first ? x.first < y.first : x.second < y.second;
    });
    std::vector<TravellingPair> left;
    for (const auto& [bound, t] : near) {
      if (harmless(bound, share * t->travel_m)) continue;
      const double distance = p.exactly(t->pair, at);
      if (distance < nearest.clearance.distance_m) nearest = {p.named(t->pair, distance), middle};
      if (nearest.clearance.distance_m <= 0 || nearest.clearance.distance_m < stop_m) return;
      if (!harmless(distance, share * t->travel_m)) left.push_back(*t);
    }
    for (const auto& [low, high] : {std::pair{t0, middle}, std::pair{middle, t1}}) {
      if (left.empty() || nearest.clearance.distance_m <= 0 || nearest.clearance.distance_m < stop_m) return;
      halve(low, high, left);
    }
  }

  bool harmless(double distance, double travel) const {
    const double least = distance - travel;
    return least > 0 && least >= nearest.clearance.distance_m - allowance_m;
  }
};

Surroundings::Surroundings(const Laboratory& laboratory) : parts_(std::make_unique<const Parts>(laboratory)) {}
Surroundings::~Surroundings() = default;

Clearance Surroundings::clearance(const State& state, double enough_m) const {
  const Parts& p = *parts_;
  const std::vector<PlacedBody> at = placed(p.laboratory, p.bodies, state);
  struct Candidate {
    double least_m;
    std::size_t pair;
  };
  std::vector<Candidate> near;
  Clearance best{enough_m, "", ""};
  for (std::size_t i = 0; i < p.pairs.size(); ++i) {
    const WatchedPair& pair = p.pairs[i];
    if (ball_gap(p.bodies[pair.a], at[pair.a], p.bodies[pair.b], at[pair.b]) >= enough_m) continue;
    const double least = p.lower_bound(pair, at);
    if (least < enough_m) near.push_back({least, i});
  }
  std::sort(near.begin(), near.end(), [](const Candidate& x, const Candidate& y) {
    return x.least_m != y.least_m ? x.least_m < y.least_m : x.pair < y.pair;
  });
  for (const Candidate& candidate : near) {
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

Surroundings::Nearest Surroundings::nearest_between(const State& from, const State& to, double enough_m, double stop_m,
                                                    double allowance_m) const {
  LineLook look{*parts_, from, to, stop_m, std::max(allowance_m, 1e-7), {}, {{enough_m, "", ""}, 0}};
  std::vector<TravellingPair> pairs;
  for (const auto& [name, arm] : parts_->laboratory.arms) {
    std::vector<double>& turns = look.turns.emplace_back();
    const Joints &a = joints_of(arm, from), &b = joints_of(arm, to);
    for (std::size_t i = 0; i < a.size(); ++i) turns.push_back(std::fabs(b[i] - a[i]));
  }
  for (const WatchedPair& pair : parts_->pairs) pairs.push_back({pair, look.travel(pair)});
  look.halve(0, 1, pairs);
  return look.nearest;
}

}  // namespace gonio::acquisition
