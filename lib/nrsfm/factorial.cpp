// See factorial.h.
#include "nrsfm/factorial.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/text.h"
#include "nrsfm/flow.h"

namespace gonio::nrsfm {
namespace {

// Sequence of the points in `kept` alone.
void keep_points(Sequence& sequence, const std::vector<Eigen::Index>& kept) {
  sequence.tracks = Tracks(sequence.tracks(Eigen::all, kept));
  sequence.truth = Shapes((*sequence.truth)(Eigen::all, kept));
  sequence.visible = Visible(sequence.visible(Eigen::all, kept));
}

void leave_out_unseen(Sequence& sequence, double least_seen) {
  const auto least = std::max(2.0, least_seen * static_cast<double>(sequence.frames()));
  std::vector<Eigen::Index> kept;
  for (Eigen::Index p = 0; p < sequence.points(); ++p)
    if (static_cast<double>(sequence.visible.col(p).count()) >= least) kept.push_back(p);
  if (kept.size() < 4)
    throw Error(Exit::data, sequence.name,
                "has " + std::to_string(kept.size()) + " points that are seen in " + shortest_text(least) + " frames",
                "4 is the least; take more frames, or another path");
  keep_points(sequence, kept);
}

// Optical flow in the sequence's unit. Orthographic pictures have the scale that the pinhole has at its distance.
Tracks tracked(const Motion& motion, const Sequence& s, const Pinhole& pinhole, int width_px, std::uint64_t seed) {
  const double share = static_cast<double>(width_px) / view_width_px;
  const bool orthographic = s.projection == Projection::orthographic;
  PictureView view;
  view.projection = s.projection;
  view.width = width_px, view.height = static_cast<int>(std::lround(view_height_px * share));
  const double focal = orthographic ? view_height_px / (3 * ball_around(motion.points_m).radius_m) : pinhole.fx_px;
  view.pinhole = {share * focal, share * focal, share * pinhole.cx_px, share * pinhole.cy_px};
  Tracks tracks = flow_tracks(motion, s.cameras, view, seed);
  if (!orthographic) return tracks / share;
  for (Eigen::Index f = 0; f < s.frames(); ++f) {
    tracks.row(2 * f) = (tracks.row(2 * f).array() - view.pinhole.cx_px) / view.pinhole.fx_px;
    tracks.row(2 * f + 1) = (tracks.row(2 * f + 1).array() - view.pinhole.cy_px) / view.pinhole.fy_px;
  }
  return tracks;
}

}  // namespace

std::string name_of(const Cell& cell, std::uint64_t seed) {
  const std::string name = cell.deformation + "-" + cell.path + "-" + cell.camera + "-" + cell.missing;
  return seed == 1 ? name : name + "-seed" + std::to_string(seed);
}

std::vector<Cell> design(const std::vector<std::string>& deformations, const std::vector<std::string>& paths,
                         const std::vector<std::string>& cameras, const std::vector<std::string>& missing) {
  std::vector<Cell> cells;
  for (const auto& d : deformations)
    for (const auto& p : paths)
      for (const auto& c : cameras)
        for (const auto& m : missing) cells.push_back({d, p, c, m});
  return cells;
}

Pinhole view_pinhole(double distance_m, double radius_m) {
  const double f = view_height_px / 3.0 * distance_m / radius_m;
  return {f, f, view_width_px / 2.0, view_height_px / 2.0};
}

Sequence film(const Motion& motion, const Cell& cell, std::uint64_t seed, const ViewOptions& options) {
  const Ball ball = ball_around(motion.points_m);
  const double distance_m = options.distance * ball.radius_m;
  Sequence s;
  s.name = name_of(cell, seed);
  s.projection = cell.camera == "perspective" ? Projection::perspective : Projection::orthographic;
  s.cameras = camera_path(cell.path, motion.frames(), {distance_m, ball.radius_m, ball.centre_m});
  const Pinhole pinhole = view_pinhole(distance_m, ball.radius_m);
  if (s.projection == Projection::perspective) s.pinhole = pinhole;
  s.tracks = project(motion.points_m, s.cameras, s.projection, pinhole);
  s.truth = motion.points_m;
  s.unit_m = 1;
  s.factors = {
      {"deformation", cell.deformation}, {"path", cell.path}, {"camera", cell.camera}, {"missing", cell.missing}};
  s.visible = Visible::Constant(motion.frames(), motion.points_m.cols(), true);
  if (options.flow_width_px > 0) {
    s.tracks = tracked(motion, s, pinhole, options.flow_width_px, seed);
    s.visible = !s.tracks(Eigen::seq(0, Eigen::last, 2), Eigen::all).array().isNaN();
    leave_out_unseen(s, options.least_seen);
  } else if (cell.missing == "with") {
    s.visible = visible_points(motion, s.cameras, s.projection);
    leave_out_unseen(s, options.least_seen);
    for (Eigen::Index f = 0; f < s.frames(); ++f)
      for (Eigen::Index p = 0; p < s.points(); ++p)
        if (!s.visible(f, p)) s.tracks.block<2, 1>(2 * f, p).setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  check(s, s.name);
  return s;
}

}  // namespace gonio::nrsfm
