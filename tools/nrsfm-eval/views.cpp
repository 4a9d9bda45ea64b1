// See views.h.
#include "tools/nrsfm-eval/views.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "base/text.h"

namespace gonio::tools::nrsfm_eval {

using namespace gonio::nrsfm;

namespace {

std::vector<Eigen::Index> evenly(Eigen::Index count, std::size_t most) {
  const auto n = static_cast<Eigen::Index>(std::min(most, static_cast<std::size_t>(count)));
  std::vector<Eigen::Index> out;
  for (Eigen::Index i = 0; i < n; ++i) out.push_back(n > 1 ? i * (count - 1) / (n - 1) : count / 2);
  return out;
}

// The least tree that joins all points, of lengths that are the largest distance in any frame: what hangs together.
std::vector<std::pair<int, int>> tree_of(const Shapes& truth, const std::vector<Eigen::Index>& frames,
                                         const std::vector<Eigen::Index>& points) {
  const std::size_t n = points.size();
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::vector<double> best(n, infinity);
  std::vector<std::size_t> from(n, 0);
  std::vector<char> joined(n, 0);
  std::vector<std::pair<int, int>> links;
  std::size_t newest = 0;
  for (std::size_t k = 1; k < n; ++k) {
    joined[newest] = 1;
    for (std::size_t p = 0; p < n; ++p) {
      if (joined[p]) continue;
      double far = -1;
      for (const Eigen::Index f : frames) {
        const auto shape = shape_of(truth, f);
        const double d = (shape.col(points[p]) - shape.col(points[newest])).norm();
        if (std::isfinite(d)) far = std::max(far, d);
      }
      if (far >= 0 && far < best[p]) best[p] = far, from[p] = newest;
    }
    std::size_t next = n;
    for (std::size_t p = 0; p < n; ++p)
      if (!joined[p] && (next == n || best[p] < best[next])) next = p;
    if (std::isfinite(best[next])) links.emplace_back(static_cast<int>(from[next]), static_cast<int>(next));
    newest = next;
  }
  return links;
}

void append(std::vector<float>& out, const Shapes& shapes, Eigen::Index frame, const std::vector<Eigen::Index>& points,
            double factor) {
  for (const Eigen::Index p : points)
    for (int i = 0; i < 3; ++i) out.push_back(static_cast<float>(factor * shapes(3 * frame + i, p)));
}

std::string caption_of(const Submission& s, const report::PointMotion& motion, Eigen::Index frames,
                       Eigen::Index points) {
  std::string text = s.reconstruction.name + ". Rings: truth. Dots: reconstruction, laid onto it by one similarity.";
  if (static_cast<Eigen::Index>(motion.frames.size()) < frames)
    text += format(" %zu of %td frames.", motion.frames.size(), frames);
  if (static_cast<Eigen::Index>(motion.points) < points) text += format(" %zu of %td points.", motion.points, points);
  return text;
}

View view_of(const Submission& s, const Sequence& sequence, const Evaluated& e, const ViewOptions& options) {
  std::vector<std::string> ignored;
  const Shapes plain = truth_for(sequence, s.reconstruction, ignored);
  const Aligned both = options.centre ? align(s.reconstruction.shapes, plain, Alignment::none)
                                      : Aligned{s.reconstruction.shapes, plain, {}, {}};
  const bool metres = sequence.unit_m > 0;
  const double factor = metres ? 1000 * sequence.unit_m : 1;
  const Eigen::Index frames = plain.rows() / 3;
  const auto shown = evenly(frames, options.frames), points = evenly(plain.cols(), options.points);
  View view;
  report::PointMotion& m = view.motion;
  m.name = s.id + (sequence.name.empty() || s.id.starts_with(sequence.name) ? "" : " of " + sequence.name);
  m.unit = metres ? "mm" : "";
  m.points = points.size(), m.full = factor * e.robust.whisker;
  for (const Eigen::Index f : shown) {
    m.frames.push_back(static_cast<int>(f));
    append(m.truth, both.truth, f, points, factor);
    Shapes laid(3, plain.cols());
    laid = moved(e.robust.alignment, shape_of(both.shapes, f));
    append(m.found, laid, 0, points, factor);
  }
  m.links = tree_of(both.truth, shown, points);
  m.turn = report::turn_for(m);
  view.title = m.name, view.caption = caption_of(s, m, frames, plain.cols());
  return view;
}

}  // namespace

std::vector<std::size_t> typical(const std::vector<std::string>& algorithms, const std::vector<double>& errors,
                                 std::size_t most) {
  std::vector<std::size_t> all(errors.size()), chosen;
  std::iota(all.begin(), all.end(), std::size_t{0});
  std::ranges::stable_sort(all, {}, [&](std::size_t i) { return errors[i]; });
  std::map<std::string, std::vector<std::size_t>> of;
  for (const std::size_t i : all) of[algorithms[i]].push_back(i);
  if (all.size() <= most) chosen = all;
  if (all.size() > most)
    for (const auto& [algorithm, list] : of) chosen.push_back(list[(list.size() - 1) / 2]);
  std::ranges::stable_sort(chosen, {}, [&](std::size_t i) { return errors[i]; });
  if (chosen.size() > most) chosen.resize(most);
  return chosen;
}

std::vector<View> views_of(const Submissions& submissions, const std::vector<Evaluated>& evaluated,
                           const ViewOptions& options) {
  std::vector<std::string> algorithms;
  std::vector<double> errors;
  for (std::size_t i = 0; i < evaluated.size(); ++i) {
    const Submission& s = submissions.all[i];
    const double unit = submissions.sequences[s.sequence].unit_m;
    algorithms.push_back(s.reconstruction.name);
    errors.push_back((unit > 0 ? unit : 1) * evaluated[i].robust.value);
  }
  std::vector<View> views;
  for (const std::size_t i : typical(algorithms, errors, options.most)) {
    const Submission& s = submissions.all[i];
    views.push_back(view_of(s, submissions.sequences[s.sequence], evaluated[i], options));
  }
  return views;
}

}  // namespace gonio::tools::nrsfm_eval
