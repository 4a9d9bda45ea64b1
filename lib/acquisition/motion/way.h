// Ways of arms from one state to another, and what is to be feared on them. Between neighbouring states of a way every
// joint moves in proportion: straight lines in joint space, all arms at once.
#pragma once
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/laboratory/laboratory.h"

namespace gonio::acquisition {

using Way = std::vector<State>;

// Distance between the two nearest solids that may not meet.
struct Clearance {
  double distance_m = 0;  // 0 where they meet
  std::string first, second;
};
// Which solids may not meet: those of different arms, of arms and obstacles, and of one arm what is two or more links
// apart, or is carried and not on the link that holds it. Bases and obstacles do not move: what they do to each other
// is nobody's business here.
class Surroundings {
 public:
  explicit Surroundings(const Laboratory& laboratory);  // keeps a copy
  ~Surroundings();
  Surroundings(const Surroundings&) = delete;
  Surroundings& operator=(const Surroundings&) = delete;
  // Exact below `enough_m`; beyond, some two solids that are at least `enough_m` apart. May be called from several
  // threads at once.
  Clearance clearance(const State& state, double enough_m = std::numeric_limits<double>::infinity()) const;
  bool free(const State& state, double margin_m) const;  // faster: is it more than the margin?
  // Pairs that are not watched, with the smallest distance seen in 1000 random postures: what is within the
  // laboratory's margin in 95 % of them, such as a wrist's housings or a shoulder and the table that it stands on; and
  // links of one arm, two apart, that never touch, for which a margin means nothing.
  const std::vector<Clearance>& left_out() const;
  // No two solids that may not meet come nearer or go apart by more, while the arms go from one state to the other in a
  // straight line in joint space.
  double change_m(const State& from, const State& to) const;

 private:
  struct Parts;
  std::unique_ptr<const Parts> parts_;
};

struct WayFigures {
  double clearance_m = 0, smallest_singular_m = 0;  // smallest on the way, of any arm
  double largest_turn_rad = 0;                      // of one joint between neighbouring states
  double duration_s = 0;                            // speeds and accelerations of the joints, the tools' speed limit
  std::string fault;  // the first limit that is broken, in words with place, value and limit; empty: none
};
// Walks it in steps that move no solid by more than `step_m`. Of the end itself only the limits and the clearance are
// judged where `end_only`.
WayFigures judge(const Laboratory& laboratory, const Surroundings& surroundings, const Way& way, double step_m = 0.005);

// Time of a motion of one joint, at rest at both ends, by a trapezoid of speed. rad, rad/s, rad/s^2 -> s.
double trapezoid_time(double distance, double speed, double acceleration);
// Of a straight line in joint space: the slowest joint's.
double line_time(const LaboratoryArm& arm, const Joints& from, const Joints& to);

// The tool of `arm` on a straight line from where it is to `world_from_tool`, the rotation turning evenly: states so
// close that between them the tool leaves the line by less than `deviation_m`. Nothing where a branch ends, a joint
// would flip, or a limit is met; `why` then says where.
std::optional<Way> straight_way(const Laboratory& laboratory, const State& from, const std::string& arm,
                                const Rigid<frame::World, frame::Tool>& world_from_tool, double deviation_m,
                                std::string* why);
// Any way without a fault, found by a search in joint space (OMPL, RRT-Connect) and shortened; the straight line in
// joint space where that is one. Nothing where none was found within `tries`.
std::optional<Way> joint_way(const Laboratory& laboratory, const Surroundings& surroundings, const State& from,
                             const State& to, std::uint64_t seed, int tries = 2000);

}  // namespace gonio::acquisition
