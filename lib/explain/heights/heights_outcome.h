// What comes out of a height map's explanation: the sentence, the upgraded manifest, the spectrum as a picture. Private
// to heights_problem.cpp.
#pragma once
#include <string>

#include "explain/heights/heights_problem.h"
#include "explain/heights/spectrum_model.h"
#include "inference/explanation.h"

namespace gonio::explain {

// Period, direction and height of what was named, with their uncertainties, and what the tiles can show at all.
std::string heights_remarks(const HeightsInput& input, const heights::TileSpectra& spectra, const Problem& problem,
                            const Explanation& e);
void upgrade_heights(const HeightsInput& input, std::span<const double> harmonic, const Problem& problem,
                     const Explanation& e, manifest::Document& document);
// The mean over tiles of ln P, and of what the model leaves of it, over the plane of frequencies.
Illustration illustrate_heights(const heights::TileSpectra& spectra, const Problem& problem, const Explanation& e);

}  // namespace gonio::explain
