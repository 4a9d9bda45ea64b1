// See factorial.h.
#include "nrsfm/make/factorial.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/text.h"
#include "nrsfm/make/flow.h"
#include "nrsfm/make/selection.h"

namespace gonio::nrsfm {
namespace {

// Columns that enough frames see.
std::vector<Eigen::Index> tracked_columns(const Visible& visible, double least_seen, const std::string& place) {
  std::vector<Eigen::Index> kept = often_seen(visible, least_seen);
  if (kept.size() < 4)
    throw NoTracks(Exit::data, place,
                   "has " + std::to_string(kept.size()) + " points that are seen in " +
                       least_frames(visible, least_seen) + " of " + std::to_string(visible.rows()) + " frames",
                   "4 is the least; take more frames, or another path");
  return kept;
}

// Pictures from one frame to the next, so many that nothing moves farther than half a patch of the tracker's between
// two of them. `tracks`: where the points truly are, pixels.
Eigen::Index pictures_per_frame(const Tracks& tracks) {
  constexpr double most_px = 6;
  constexpr Eigen::Index most = 24;
  const Eigen::Index rows = tracks.rows() - 2;
  const Eigen::ArrayXXd step = tracks.bottomRows(rows) - tracks.topRows(rows);
  double longest = 0;
  for (Eigen::Index f = 0; f < rows / 2; ++f)
    longest = std::max(longest, step.middleRows<2>(2 * f).matrix().colwise().norm().maxCoeff());
  return std::clamp<Eigen::Index>(static_cast<Eigen::Index>(std::ceil(longest / most_px)), 1, most);
}

// Optical flow in the sequence's unit. Orthographic pictures have the scale that the pinhole has at its distance.
Tracks tracked(const Motion& motion, const Take& take, const Sequence& s, int width_px, std::uint64_t seed) {
  const double share = static_cast<double>(width_px) / view_width_px;
  const bool orthographic = s.projection == Projection::orthographic;
  const Pinhole& pinhole = take.pinhole;
  const Ball ball = ball_around(motion.points_m);
  PictureView view;
  view.projection = s.projection;
  view.width = width_px, view.height = static_cast<int>(std::lround(view_height_px * share));
  const double focal = orthographic ? view_height_px / (3 * ball.radius_m) : pinhole.fx_px;
  view.pinhole = {share * focal, share * focal, share * pinhole.cx_px, share * pinhole.cy_px};
  const Eigen::Index gaps = s.frames() - 1, parts = pictures_per_frame(s.tracks * share * (orthographic ? focal : 1));
  const auto cameras = camera_path(take.path, parts * gaps + 1, take.place);
  Tracks tracks = flow_tracks(motion, *s.truth, take.visible.leftCols(s.points()), cameras, view, seed);
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

Take take_of(const Motion& motion, const std::string& path, const std::string& camera, const ViewOptions& options) {
  const Ball ball = ball_around(motion.points_m);
  const double distance_m = options.distance * ball.radius_m;
  Take take;
  take.path = path, take.camera = camera;
  take.pinhole = view_pinhole(distance_m, ball.radius_m);
  take.place = {distance_m, ball.radius_m, ball.centre_m, options.places};
  if (camera == "perspective") take.projection = Projection::perspective;
  take.cameras = camera_path(path, motion.frames(), take.place);
  const Visible visible = visible_points(motion, take.cameras, take.projection);
  take.points = tracked_columns(visible, options.least_seen, motion.kind + "-" + path + "-" + camera);
  take.wanted = take.points.size();
  if (motion.wanted > 0) take.wanted = std::min(take.wanted, static_cast<std::size_t>(motion.wanted));
  take.visible = visible(Eigen::all, take.points);
  return take;
}

Sequence film(const Motion& motion, const Take& take, const Cell& cell, std::uint64_t seed,
              const ViewOptions& options) {
  Sequence s;
  s.name = name_of(cell, seed);
  s.projection = take.projection;
  s.cameras = take.cameras;
  if (s.projection == Projection::perspective) s.pinhole = take.pinhole;
  const bool by_flow = options.flow_width_px > 0;
  std::vector<Eigen::Index> points = take.points;
  if (!by_flow) points.resize(take.wanted);
  s.truth = Shapes(motion.points_m(Eigen::all, points));
  s.tracks = project(*s.truth, s.cameras, s.projection, take.pinhole);
  s.unit_m = 1;
  s.factors = {
      {"deformation", cell.deformation}, {"path", cell.path}, {"camera", cell.camera}, {"missing", cell.missing}};
  s.visible = Visible::Constant(s.frames(), s.points(), true);
  if (by_flow) {
    s.tracks = tracked(motion, take, s, options.flow_width_px, seed);
    s.visible = !s.tracks(Eigen::seq(0, Eigen::last, 2), Eigen::all).array().isNaN();
    std::vector<Eigen::Index> kept = tracked_columns(s.visible, options.least_seen, s.name);
    kept.resize(std::min(kept.size(), take.wanted));
    keep_points(s, kept);
  } else if (cell.missing == "with") {
    s.visible = take.visible.leftCols(s.points());
    for (Eigen::Index f = 0; f < s.frames(); ++f)
      for (Eigen::Index p = 0; p < s.points(); ++p)
        if (!s.visible(f, p)) s.tracks.block<2, 1>(2 * f, p).setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  check(s, s.name);
  return s;
}

Sequence film(const Motion& motion, const Cell& cell, std::uint64_t seed, const ViewOptions& options) {
  return film(motion, take_of(motion, cell.path, cell.camera, options), cell, seed, options);
}

}  // namespace gonio::nrsfm
