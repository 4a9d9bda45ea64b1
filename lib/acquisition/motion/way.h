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
  // Solids that are not watched, with the smallest distance seen in 1000 random postures: what is within the
  // laboratory's margin in 95 % of them, such as a shoulder and the table that it stands on; and parts of links, two
  // apart in one arm, that never touch but are within one and a half margins in 20 %: the housings of a wrist, to which
  // a margin means nothing. (What comes near in few postures touches in others: it is watched.) Links have several
  // solids of one name: of a pair of names in this list, others may be watched.
  const std::vector<Clearance>& left_out() const;

  // On a straight line in joint space: the nearest that two solids come below `enough_m`, and on which share of the
  // line. Nowhere on it are two solids nearer than that by more than `allowance_m`, or meet: how far each travels
  // between two looks is bounded, and where that exceeds what it has to spare, there is a look between. Ends at the
  // first place where the distance is below `stop_m`.
  struct Nearest {
    Clearance clearance;
    double at = 0;
  };
  Nearest nearest_between(const State& from, const State& to, double enough_m, double stop_m, double allowance_m) const;

 private:
  struct Parts;
  struct LineLook;
  std::unique_ptr<const Parts> parts_;
};

// Singular values count turns of the flange by this length (robot/inverse/singularity.h).
inline constexpr double singular_length_m = 0.1;

struct WayFigures {
  double clearance_m = 0;          // smallest on the way: nothing on it is nearer by more than `step_m`
  double smallest_singular_m = 0;  // on the way, of any arm of six joints; infinite where there is none
  double largest_turn_rad = 0;     // of one joint between neighbouring states
  double duration_s = 0;           // way_time
  std::string fault;               // the first limit that is broken, in words with place, value and limit; empty: none
};
// Of joints' ranges, workspace, singular values and clearance, all along the way (margins to 2 %). The walk ends at a
// fault; the figures are then those up to there.
WayFigures judge(const Laboratory& laboratory, const Surroundings& surroundings, const Way& way, double step_m = 0.005);
// Whether a straight line in joint space has no fault; faster. (No way is found on which `judge` finds one.)
bool open_line(const Laboratory& laboratory, const Surroundings& surroundings, const State& from, const State& to);

// Time of a motion of one joint, at rest at both ends, by a trapezoid of speed. rad, rad/s, rad/s^2 -> s.
double trapezoid_time(double distance, double speed, double acceleration);
// Of a straight line in joint space, all joints in proportion, none beyond its speed and acceleration.
double line_time(const LaboratoryArm& arm, const Joints& from, const Joints& to);
// Of a whole way, at rest at its ends and wherever it turns by more than 0.2 rad in joint space; all arms in
// proportion; no flange faster than the laboratory allows.
double way_time(const Laboratory& laboratory, const Way& way);

// The tool of `arm` on a straight line from where it is to `world_from_tool`, the rotation turning evenly: states so
// close that between them the tool leaves the line by less than `deviation_m`. Nothing where the line leaves the reach,
// a joint would flip, or comes too near to a singular posture, or a limit is met; `why` (may be null) then says where.
// Solids are not looked at. For arms of six joints.
std::optional<Way> straight_way(const Laboratory& laboratory, const State& from, const std::string& arm,
                                const Rigid<frame::World, frame::Tool>& world_from_tool, double deviation_m,
                                std::string* why);
// Any way without a fault: the straight line in joint space where that is one, else found by a search in joint space
// (OMPL, RRT-Connect) and shortened. Nothing where none was found within `tries`. Same seed, same way.
std::optional<Way> joint_way(const Laboratory& laboratory, const Surroundings& surroundings, const State& from,
                             const State& to, std::uint64_t seed, int tries = 2000);

}  // namespace gonio::acquisition
