// What surrounds the volumes problem: conditions of its rows, words, the upgraded manifest, pictures. Private to
// volumes/.
#pragma once
#include <string>
#include <vector>

#include "explain/volumes/observed.h"
#include "inference/explanation.h"

namespace gonio::explain {

// Voxels for which an error of a reading's unit counts in the score: a grey value that is off by a quarter of material
// less air counts as much as a wall that is off by a voxel.
inline double weight_of(const volumes::Row& row) {
  return row.reading == volumes::Reading::wall || row.reading == volumes::Reading::width ? 1 : 4;
}

std::vector<Condition> volume_conditions(const volumes::Observed& observed);
std::string volumes_remarks(const VolumesInput& input, const volumes::Observed& observed, const Problem& problem,
                            const Explanation& explanation);
// Named and given mechanisms with their fitted numbers.
void upgrade_volumes(const VolumesInput& input, const Problem& problem, const Explanation& explanation,
                     manifest::Document& document);
// Walls and grey values seen along the rotation axis and from the side, what is left of each as colours.
Illustration illustrate_volumes(const volumes::Observed& observed, const Explanation& explanation);

}  // namespace gonio::explain
