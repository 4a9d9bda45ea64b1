// What comes out of a sequence's explanation: remarks, the upgraded manifest, pictures. Private to tracks_problem.cpp.
#pragma once
#include <optional>
#include <string>

#include "explain/nrsfm/tracks_problem.h"
#include "inference/explanation.h"

namespace gonio::explain {

// "px" of a perspective camera; of an orthographic one the tracks' own, which nobody states.
std::string track_unit(const gonio::nrsfm::Followed& followed);

struct TracksView {
  const Problem& problem;
  const gonio::nrsfm::Followed& followed;
};

// How near the camera is, how much the scales vary, what took part.
std::string tracks_remarks(const TracksView& view, const Explanation& e);
// tracks.outliers: observations to hide, by the names that nrsfm/manifest_sequences.h reads. tracks.perspective: the
// sequence gets a perspective camera, with the focal length that was found unless one is known. tracks.scale: the
// sequence's projection is one whose scale differs from frame to frame. Solvers then do not leave it out.
void upgrade_tracks(const TracksView& view, const Explanation& e, manifest::Document& document);
// Where shapes are lacking no race is run to its end: perspective is judged on top of as many shapes as the solver has
// and one more (nrsfm/solve/near_camera.h), and nothing else is named. `candidate`: tracks.perspective, if it is one.
void conclude_shapes(const TracksView& view, std::optional<std::size_t> candidate, Explanation& e);
// tracks.outliers joins what the engine has found; alone it is held against sound observations that the robust fit
// predicts. Where shapes are lacking it is not named and nothing is hidden: deformation may look the same.
void conclude_outliers(const TracksView& view, std::size_t candidate, Explanation& e);
// Residuals over depth and over frames, before and after.
Illustration illustrate_tracks(const TracksView& view, const Explanation& e);

}  // namespace gonio::explain
