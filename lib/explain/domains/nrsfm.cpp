// Tracks of shapes that deform, and what a solver made of them.
#include "explain/domain.h"
#include "explain/nrsfm/tracks_problem.h"

namespace gonio::explain::domains {

const Domain& nrsfm() {
  static const Domain domain{
      .name = "nrsfm",
      .sentence = "sequences of tracks with a reconstruction by an orthographic camera (nrsfm-solve)",
      .order = 6,
      .applies = gonio::nrsfm::has_followed,
      .problems =
          [](const manifest::Document& document, const ProblemOptions&) {
            std::vector<std::unique_ptr<Problem>> problems;
            for (gonio::nrsfm::Followed& followed : gonio::nrsfm::followed_tracks(document, false_alarm_of_outliers))
              problems.push_back(tracks_problem(std::move(followed)));
            return problems;
          },
      .files = gonio::nrsfm::followed_files,
      .untouched = {
          {"polarizer.", "tracks say where light goes, not how it swings"},
          {"screen.", "tracks say where light goes, not how it swings"},
          {"retarder.", "tracks say where light goes, not how it swings"},
          {"print.", "tracks show no printed heights"},
          {"projector.", "tracks have no projector"},
          {"rig.", "tracks have no projector"},
          {"structured-light.", "tracks have no projector"},
          {"lens.", "tracks of one view under an orthographic camera: bent rays and a bent shape are one and the same"},
          {"camera.", "tracks state neither exposure nor temperature"},
          {"ground.", "tracks are points, and have no rims"},
          {"mask.", "tracks are points, and have no rims"},
          {"board.", "the shape is unknown: a board is one that does not deform"},
          {"light.", "tracks are places, and keep no brightness"},
          {"optics.", "tracks are places, and keep no brightness"},
          {"sensor.", "tracks are places, and keep no brightness"},
          {"surface.", "tracks are places, and keep no brightness"},
          {"volume.", "tracks are places, and keep no brightness"},
          {"scene.", "everything moves: that is what is sought"},
          {"transport.", "tracks are places, and keep no brightness"},
          {"reference.", "tracks are places, and keep no brightness"},
          {"geometry.", "shape and motion are what is sought, and free in every frame"},
          {"robot.", "no robot is known"},
          {"marker.", "markers are tables of the model markers"},
          {"ct.", "no X-rays"},
          {"colour.", "tracks are places, and keep no brightness"},
          {"probe.", "tracks have no lamps: highlights are tables of the model probe"}}};
  return domain;
}

}  // namespace gonio::explain::domains
