// Views of reconstructions on the truth, for the page: which ones, and thinned so that the page stays small.
#pragma once
#include <string>
#include <vector>

#include "nrsfm/evaluate/evaluate.h"
#include "report/point_motion.h"
#include "tools/nrsfm-eval/submissions.h"

namespace gonio::tools::nrsfm_eval {

struct View {
  report::PointMotion motion;
  std::string title, caption;
};
struct ViewOptions {
  std::size_t most = 6;     // views
  std::size_t frames = 60;  // of a view; of more, evenly chosen ones
  std::size_t points = 150;
  bool centre = false;  // as nrsfm::EvaluationOptions::centre
};
// All of a few; of many, of each algorithm the reconstruction of median robust error. Indices, the least error first.
std::vector<std::size_t> typical(const std::vector<std::string>& algorithms, const std::vector<double>& errors,
                                 std::size_t most);
// `evaluated` belongs to the submissions, one to one.
std::vector<View> views_of(const Submissions& submissions, const std::vector<nrsfm::Evaluated>& evaluated,
                           const ViewOptions& options);

}  // namespace gonio::tools::nrsfm_eval
