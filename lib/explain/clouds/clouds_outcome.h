// After the engine's work: words, the upgraded sections, pictures. Private to clouds/.
#pragma once
#include <string>

#include "explain/clouds/clouds_parameters.h"
#include "inference/explanation.h"

namespace gonio::explain {

std::string clouds_remarks(const Problem& problem, const CloudModel& model, const Explanation& e);
// The rig and its lenses as named; what has no place in them under "mechanisms".
void upgrade_clouds(const Problem& problem, const CloudsInput& input, const CloudParameters& parameters,
                    const Explanation& e, manifest::Document& document);
// Of the first clouds: how far points lie off their shape, over the picture, before and after.
Illustration illustrate_clouds(const CloudModel& model, const Observations& observations, const Explanation& e);

}  // namespace gonio::explain
