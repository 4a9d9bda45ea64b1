// The parameters of the clouds problem: what each one moves, and the candidates they make. Private to clouds/.
#pragma once
#include <string>
#include <vector>

#include "explain/clouds/cloud_model.h"

namespace gonio::explain {

inline constexpr double size_of_usual = 0.1;  // Parameter::size of candidates, over what is usual

struct CloudParameters {
  std::vector<Parameter> parameters;
  std::vector<CloudRole> roles;
  std::vector<std::size_t> base;
  std::vector<Candidate> candidates;
};
// Candidates have all parameters that these recordings could move, estimable or not. What the manifest has switched on
// is part of the base model.
CloudParameters cloud_parameters(const CloudsInput& input, const CloudModel& model);

// A parameter's own name: "gamma" of "projector.gamma.gamma", "along_m" of "bust-3/along_m".
std::string name_of(const Parameter& parameter);

}  // namespace gonio::explain
