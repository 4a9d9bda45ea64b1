// Sequences and reconstructions of a manifest.
#pragma once
#include <filesystem>
#include <string>

#include "manifest/sections/forward.h"
#include "nrsfm/sequence.h"
#include "nrsfm/solve/solver.h"

namespace gonio::nrsfm {

// What `document.sequences.at(id)` describes: the file's content, and where the entry says something, the entry
// (projection, camera, truth_frame, unit, factors), less the observations that the mechanism tracks.outliers names.
// Error(data) where `id` is not there or does not fit its file.
Sequence sequence_of(const manifest::Document& document, const std::string& id);

// A sequence that came as a file of its own: its entry, under a name made of the file's.
std::string enter_sequence(manifest::Document& document, const std::filesystem::path& file, const Sequence& sequence);

// The entry of a solution that was written as `file`; one of the same id makes way.
void enter_reconstruction(manifest::Document& document, const std::string& id, const std::string& sequence,
                          const Solution& solution, std::uint64_t seed, const std::filesystem::path& file);

}  // namespace gonio::nrsfm
