// A plan over time, and the laboratory's model that carries it out.
//
// The time is that of motions, turntables, lamps that settle, and exposures; what cameras need to hand their pictures
// over comes on top. On a way the arms go from state to state in time proportional to the largest turn of a joint.
#pragma once
#include <map>
#include <set>
#include <string>
#include <vector>

#include "acquisition/laboratory/laboratory.h"
#include "acquisition/plan/laboratory_model.h"
#include "manifest/sections/forward.h"

namespace gonio::acquisition {

struct PlanMoment {
  double time_s = 0;
  State state;
  std::map<std::string, double> turntables;
};
struct PlanStand {  // a step's photographs
  double from_s = 0, until_s = 0;
};
struct PlanTimes {
  std::vector<PlanMoment> moments;  // times rise; between two of them every joint turns in proportion
  std::vector<PlanStand> stands;    // one a step
  double end_s() const { return moments.back().time_s; }
};
PlanTimes times_of(const manifest::Document& document, const Laboratory& laboratory, const manifest::Plan& plan);
State state_at_time(const Laboratory& laboratory, const PlanTimes& times, double time_s);

// Views are marks where their cameras stand: to be taken, taken, out of reach. `taken`: the steps whose pictures are
// there; a null pointer: each is from its time on.
LaboratoryModel plan_model(const manifest::Document& document, const Laboratory& laboratory, const manifest::Plan& plan,
                           const PlanTimes& times, const std::set<std::size_t>* taken = nullptr);

// What the colours of such a model mean, of those that it shows.
std::vector<report::ColourKey> legend_of(const io::MovingModel& model);

}  // namespace gonio::acquisition
