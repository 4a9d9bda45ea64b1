// A sequence of tracks and a solver's shapes as a problem for the engine: what did the solver's camera leave out?
//
// Observations: the tracks, two coordinates an observation, one group per point; neighbouring frames share a block.
// Base model: the solver's own (solved_model.h): per frame a rotation and a translation, and a scale where the solver
// had one; weights of the shapes within the solver's freedom; K shapes per point. All of it is refitted. On a held-out
// point everything that frames share comes from the other points, its own 3 K numbers are fitted on one half of its
// frames and judged on the other. Hypotheses: tracks.perspective (one number), tracks.scale (one for each frame but
// the first). Observations that do not follow are found beforehand (outlying.h), at a false-alarm rate of one in a
// hundred sequences, and take no part: tracks.outliers. Score: RMS distance of tracks from where the model sees the
// points.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "explain/nrsfm/solved_model.h"
#include "explain/problem.h"

namespace gonio::explain {

struct TracksInput {
  std::string sequence, reconstruction;  // ids
  tracks::Solved solved;
  std::optional<double> inverse_focal;  // switched on in the manifest: tracks.perspective
};

// Reconstructions in one frame of reference for the whole sequence, whose camera is (scaled) orthographic.
bool has_tracks(const manifest::Document& document);
// One for each sequence: of its reconstructions the one that reprojects best.
std::vector<TracksInput> tracks_inputs(const manifest::Document& document);
std::vector<std::filesystem::path> tracks_files(const manifest::Document& document);
std::unique_ptr<Problem> tracks_problem(TracksInput input);

}  // namespace gonio::explain
