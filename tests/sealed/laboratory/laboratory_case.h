// Sealed laboratories: an arm that carries a camera over a board under a lamp, described as its owner believes it to
// be, and what is really so, which no program under test is given but the simulated instrument itself. In every one of
// them, those where nothing is to be found too, the camera sits elsewhere on the arm, its focal length and its middle
// are others, and the lamp is brighter or darker than described: that is what calibration is for.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/random.h"
#include "manifest/document.h"

namespace gonio::sealed {

struct Perturbation {
  std::string domain;                 // of explain, that sees it
  std::string mechanism;              // as explain names it
  std::vector<std::string> likewise;  // further names of the same physics
  std::string parameter;
  double value = 0;
  std::string acts_as;         // the mechanism that the truth states, where that is another
  std::string also_parameter;  // set to also_value beside it
  double also_value = 0;
};

struct LaboratoryCase {
  std::uint64_t seed = 0;
  std::vector<Perturbation> perturbations;  // none, one or two
  manifest::Document believed, truth;
  std::vector<std::string> plan;  // options of acquire
};

// `small`: fewer and smaller pictures, for a test that is to take seconds. Writes the board's drawing into `folder`.
LaboratoryCase laboratory_case(std::uint64_t seed, bool small, const std::filesystem::path& folder);
// The same with these perturbations.
LaboratoryCase laboratory_with(std::uint64_t seed, std::vector<Perturbation> perturbations, bool small,
                               const std::filesystem::path& folder);

}  // namespace gonio::sealed
