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
      .files = gonio::nrsfm::followed_files};
  return domain;
}

}  // namespace gonio::explain::domains
