// What surrounds the polarization problem: its rows and their conditions, the upgraded manifest, pictures. Private to
// polarization/.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "explain/polarization/mosaic_light.h"
#include "explain/polarization/polarization_term.h"
#include "inference/explanation.h"

namespace gonio::explain::polarization {

struct Row {
  std::size_t tile = 0, place = 0;  // in the tile
};
struct Use {  // a form of a mechanism, and the places of all its declaration's parameters in the problem
  const Term* term = nullptr;
  Form form;
  std::size_t first = 0;
  std::vector<double> neutral;
};

// Of a picture's samples behind each polarizer, at polarizer_over().
using PolarizerMeans = std::array<double, 4>;

// `state`: without any hypothesis; `gain`: from the simulation to the recordings, of whose pictures the means are.
std::vector<inference::Condition> mosaic_conditions(const MosaicLight& light, const std::vector<Row>& rows,
                                                    const State& state, double gain,
                                                    const std::vector<PolarizerMeans>& means);
// Where the use is active: into the section of what it changes, or into the mechanisms.
void upgrade(const Setup& setup, const Use& use, const inference::Explanation& explanation,
             manifest::Document& document);
inference::Illustration illustrate_mosaics(const MosaicLight& light, const std::vector<Row>& rows,
                                           const inference::Observations& observations,
                                           const inference::Explanation& explanation);

}  // namespace gonio::explain::polarization
