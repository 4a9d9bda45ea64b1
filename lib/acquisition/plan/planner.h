// From views that are asked for to a plan: joints for every arm, ways between, an order that saves time.
//
// Every view has its inverse solutions and their turns as candidates (plan/candidates.h), those that no singular
// posture parts from home; those that break a limit, wind a cable, come near a singularity or touch something are
// dropped, and a view without candidates is unreachable, with the reason that stopped most of them and the nearest view
// that can be reached. Order and candidates are chosen together (plan/tour.h), the cost the time of the slowest joint;
// the ways between are then walked (plan/edges.h): a line in joint space where that is free, a straight line of the
// camera where asked, else a way that is found; what cannot be walked costs so much that the next round chooses other
// candidates or another order.
//
// Steps that ask the same of the arms and turntables are taken one after the other without moving, unless the order is
// to be kept. Arms of which a step asks nothing stand at home.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/laboratory/laboratory.h"
#include "acquisition/motion/way.h"
#include "base/progress.h"
#include "manifest/sections/forward.h"
#include "manifest/sections/plan.h"

namespace gonio::acquisition {

struct PlanOptions {
  std::uint64_t seed = 1;
  bool keep_order = false;  // as asked, instead of the fastest
  bool shuffle = false;     // a random order: drift is then told from what is measured; slower
  double repeat_share = 0;  // of the views that are taken a second time, spread over the plan
  // Views between frames of reference, in the asked steps of that purpose in turn, one at the beginning and one at the
  // end; 0: those steps are taken once, like views. A reference frame always stands in the same joints.
  int reference_every = 0;
  int board_every = 0;             // the same for board frames, which measure repeatability
  int dark_every = 0;              // views between frames with the lamps off, taken where the arms stand
  std::string straight{};          // camera whose way is a straight line between its views; keeps the order
  std::optional<Vec3> target_m{};  // where held lamps shine; left out: where the cameras' axes meet
};

// `asked`: steps without joints. The plan's id is set. Error(data) where the laboratory has no such camera or lamp,
// where an image's id stands twice, or where frames of reference are wanted and none is asked.
manifest::Plan make_plan(const manifest::Document& document, const Laboratory& laboratory,
                         const std::vector<manifest::PlanStep>& asked, const std::string& pattern,
                         const PlanOptions& options, Progress* progress = nullptr);

// Where the arms stand at step `index`.
State state_at(const Laboratory& laboratory, const manifest::Plan& plan, std::size_t index);
// The way to step `index` of a plan: from the step before (or home) through its `via`.
Way way_to(const Laboratory& laboratory, const manifest::Plan& plan, std::size_t index);
// From the last step (or any other) back home: a line in joint space where that is free, else one that is found.
// Error(data) where there is none.
Way way_home(const Laboratory& laboratory, const manifest::Plan& plan, std::size_t from);

// SHA-256, hexadecimal, of what decides a plan: the laboratory's arms, limits and solids, the request, the seed, and
// every step's pose, joints, lamps and exposures; not of times and figures. Nor of where the laboratory believes its
// cameras and lamps to sit: what a run measures of them belongs to the plan whose joints it was measured in, and must
// not give that plan another name.
std::string plan_id(const manifest::Document& document, const manifest::Plan& plan);

}  // namespace gonio::acquisition
