// How the arms can take a view: the inverse solutions in home's branch (plan/postures.h), with all their turns, of the
// arm that holds the camera, and for a lamp, which
// is a point, those of many turns of its tool about it; each alone, then in pairs. A candidate keeps the joints' limits
// (and the cable's), stays away from singular postures, and touches nothing.
#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "acquisition/laboratory/laboratory.h"
#include "acquisition/motion/way.h"
#include "acquisition/plan/configurations.h"
#include "manifest/sections/forward.h"

namespace gonio::acquisition {

struct Candidates {
  std::vector<Configuration> all;  // nearest to home first
  std::string why;                 // where there are none: what stopped most, in words
};

// The arm that holds the camera (lamp) of a step; empty where none does.
std::string camera_arm(const manifest::Document& document, const manifest::PlanStep& step);
// Of the step's lamps the first that an arm holds: its name, or empty.
std::string held_lamp(const manifest::Document& document, const manifest::PlanStep& step);

// Writes where the arms stand into a step: `robot`'s joints first, those of the others by name.
void set_joints(manifest::PlanStep& step, const State& state, const std::string& robot);

class CandidateSearch {
 public:
  // `target_m`: where lamps with a direction shine.
  CandidateSearch(const manifest::Document& document, const Laboratory& laboratory, const Surroundings& surroundings,
                  Vec3 target_m);
  ~CandidateSearch();

  // Of many steps, in parallel; steps that ask the same share the work. Error(data) for unknown cameras and lamps.
  // `most`: of each.
  static constexpr std::size_t usual_count = 24;
  std::vector<Candidates> find(const std::vector<const manifest::PlanStep*>& steps,
                               std::size_t most = usual_count) const;

 private:
  struct Parts;
  std::unique_ptr<const Parts> parts_;
};

}  // namespace gonio::acquisition
