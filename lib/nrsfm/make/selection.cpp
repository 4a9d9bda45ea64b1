// See selection.h.
#include "nrsfm/make/selection.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"

namespace gonio::nrsfm {
namespace {

double least_count(const Visible& visible, double least_seen) {
  return std::max(2.0, least_seen * static_cast<double>(visible.rows()));
}

}  // namespace

std::vector<Eigen::Index> often_seen(const Visible& visible, double least_seen) {
  const double least = least_count(visible, least_seen);
  std::vector<Eigen::Index> kept;
  for (Eigen::Index p = 0; p < visible.cols(); ++p)
    if (static_cast<double>(visible.col(p).count()) >= least) kept.push_back(p);
  return kept;
}

std::string least_frames(const Visible& visible, double least_seen) {
  return shortest_text(std::ceil(least_count(visible, least_seen)));
}

void keep_points(Sequence& s, const std::vector<Eigen::Index>& points) {
  s.tracks = Tracks(s.tracks(Eigen::all, points));
  s.visible = Visible(s.visible(Eigen::all, points));
  if (s.sigma.size() > 0) s.sigma = Eigen::MatrixXd(s.sigma(Eigen::all, points));
  if (s.truth) s.truth = Shapes((*s.truth)(Eigen::all, points));
}

void keep_frames(Sequence& s, const std::vector<Eigen::Index>& frames) {
  std::vector<Eigen::Index> twos, threes;
  std::vector<CameraFromObject> cameras;
  for (const Eigen::Index f : frames) {
    twos.insert(twos.end(), {2 * f, 2 * f + 1}), threes.insert(threes.end(), {3 * f, 3 * f + 1, 3 * f + 2});
    if (!s.cameras.empty()) cameras.push_back(s.cameras[static_cast<std::size_t>(f)]);
  }
  s.tracks = Tracks(s.tracks(twos, Eigen::all));
  s.visible = Visible(s.visible(frames, Eigen::all));
  if (s.sigma.size() > 0) s.sigma = Eigen::MatrixXd(s.sigma(frames, Eigen::all));
  if (s.truth) s.truth = Shapes((*s.truth)(threes, Eigen::all));
  s.cameras = std::move(cameras);
}

}  // namespace gonio::nrsfm
