// Steps that other programs ask for: pairs of directions of `brdf-fit --plan`, and the measurements that explain would
// take next. They say where the camera and the lamp are to be; plan/planner.h finds out how.
#pragma once
#include <string>
#include <vector>

#include "acquisition/plan/view_pattern.h"
#include "manifest/sections/forward.h"

namespace gonio::acquisition {

// A flat sample at the scene's target, its normal `up`, azimuths from the world's x: the held lamp along wi, the camera
// along wo.
struct SamplePair {
  double theta_i_rad = 0, phi_i_rad = 0, theta_o_rad = 0, phi_o_rad = 0;
};
struct SampleDistances {
  double camera_m = 0.5, lamp_m = 0.5;
};
std::vector<manifest::PlanStep> pair_steps(const PatternScene& scene, const std::vector<SamplePair>& pairs,
                                           const SampleDistances& distances);

// Comma separated with a header that names theta_i_rad, phi_i_rad, theta_o_rad and phi_o_rad, in any order among other
// columns. Error(data) at `place` with the line.
std::vector<SamplePair> read_pairs(const std::string& csv, const std::string& place);

struct AskedSteps {
  std::vector<manifest::PlanStep> steps;  // in explain's order, the most telling first
  std::vector<std::string> left;          // sentences of what no step can say, with the reason
};
// The plans of all `next_measurement` in the document: views of a board (its place in the world is taken from a picture
// that shows it), pictures taken again at another exposure or with other lamps, scans of a flat sample.
AskedSteps next_steps(const manifest::Document& document, const PatternScene& scene,
                      const SampleDistances& distances = {});

}  // namespace gonio::acquisition
