// A sequence of tracks and a solver's shapes as a problem for the engine: what did the solver's camera leave out?
//
// Observations: the tracks, two coordinates an observation, one group per point; neighbouring frames share a block.
// Base model: the solver's own (nrsfm/solve/deforming_model.h): per frame a rotation and a translation, and a scale
// where the solver had one; weights of the shapes within the solver's freedom; K shapes per point. All of it is
// refitted. On a held-out point everything that frames share comes from the other points, its own 3 K numbers are
// fitted on one half of its frames and judged on the other. Hypotheses: tracks.perspective (one number), tracks.scale
// (one for each frame but the first). Observations that do not follow are found beforehand (nrsfm/solve/outliers.h), at
// a false-alarm rate of one in a hundred sequences, and take no part: tracks.outliers. Score: RMS distance of tracks
// from where the model sees the points.
#pragma once
#include <memory>
#include <vector>

#include "explain/engine.h"
#include "nrsfm/solve/followed.h"

namespace gonio::explain {

inline constexpr double false_alarm_of_outliers = 0.01;  // a sequence
std::unique_ptr<Problem> tracks_problem(gonio::nrsfm::Followed followed);

}  // namespace gonio::explain
