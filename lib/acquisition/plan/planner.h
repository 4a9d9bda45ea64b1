// From views that are asked for to a plan: joints for every arm, ways between, an order that saves time.
//
// Every view has all its inverse branches and turns as candidates; those that break a limit, wind a cable, come near a
// singularity or touch something are dropped, and a view without candidates is unreachable, with the reason that
// stopped most of them and the nearest view that can be reached. Order and candidates are chosen together: a
// travelling salesman among clusters of candidates (nearest insertion, then 2-opt and or-opt with the best candidates
// along the order by dynamic programming; the cost is the time of the slowest joint), whose ways are then walked: a
// line in joint space where that is free, else a way that is found, else another candidate.
#pragma once
#include <cstdint>
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
  int reference_every = 0;  // views between reference frames; 0: none
  int dark_every = 0;       // views between frames with the lamps off
  int board_every = 0;      // views between board frames, which measure repeatability
  std::string straight{};   // camera whose way is a straight line between views of one path
};

// `asked`: steps without joints. The plan's id is set. Error(data) where the laboratory has no such camera or lamp.
manifest::Plan make_plan(const manifest::Document& document, const Laboratory& laboratory,
                         const std::vector<manifest::PlanStep>& asked, const std::string& pattern,
                         const PlanOptions& options, Progress* progress = nullptr);

// The way to step `index` of a plan: from the step before (or home) through its `via`.
Way way_to(const Laboratory& laboratory, const manifest::Plan& plan, std::size_t index);

// SHA-256, hexadecimal, of what decides a plan: the laboratory's arms, limits and solids, the request, the seed, and
// every step's pose, joints, lamps and exposures; not of times, figures and pictures.
std::string plan_id(const manifest::Document& document, const manifest::Plan& plan);

}  // namespace gonio::acquisition
