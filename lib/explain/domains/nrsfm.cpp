// Tracks of shapes that deform, and what a solver made of them.
#include "explain/domain.h"
#include "explain/nrsfm/tracks_problem.h"

namespace gonio::explain::domains {

const Domain& nrsfm() {
  static const Domain domain{
      .name = "nrsfm",
      .sentence = "sequences of tracks with a reconstruction by an orthographic camera (nrsfm-solve)",
      .order = 6,
      .applies = has_tracks,
      .problems =
          [](const manifest::Document& document, const ProblemOptions&) {
            std::vector<std::unique_ptr<Problem>> problems;
            for (TracksInput& input : tracks_inputs(document)) problems.push_back(tracks_problem(std::move(input)));
            return problems;
          },
      .files = tracks_files};
  return domain;
}

}  // namespace gonio::explain::domains
