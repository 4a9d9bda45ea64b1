// CT volumes against the shape that the user believes in.
#include "explain/domain.h"
#include "explain/volumes/volumes_problem.h"

namespace gonio::explain::domains {

const Domain& volumes() {
  static const Domain domain{
      .name = "volumes",
      .sentence = "CT volumes whose \"reference\" names the shape that you believe in (a CAD model, a measured part)",
      .order = 7,
      .applies = has_volumes,
      .problems =
          [](const manifest::Document& document, const ProblemOptions&) {
            std::vector<std::unique_ptr<Problem>> problems;
            for (VolumesInput& input : volumes_inputs(document)) problems.push_back(volumes_problem(std::move(input)));
            return problems;
          },
      .files = volumes_files};
  return domain;
}

}  // namespace gonio::explain::domains
