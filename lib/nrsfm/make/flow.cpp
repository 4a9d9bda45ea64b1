// See flow.h.
#include "nrsfm/make/flow.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "nrsfm/make/camera_paths.h"
#include "nrsfm/make/tracker.h"
#include "stats/intervals.h"

namespace gonio::nrsfm {
namespace {

// `part` of the way from one frame to the next.
FrameMesh mesh_between(const Motion& motion, Eigen::Index frame, double part) {
  FrameMesh mesh = motion.mesh(frame);
  if (part > 0) mesh.vertices_m += part * (motion.mesh(frame + 1).vertices_m - mesh.vertices_m);
  return mesh;
}

Tracks in_pixels(Tracks tracks, const PictureView& view) {
  if (view.projection == Projection::perspective) return tracks;
  for (Eigen::Index f = 0; f < tracks.rows() / 2; ++f) {
    tracks.row(2 * f) = view.pinhole.fx_px * tracks.row(2 * f).array() + view.pinhole.cx_px;
    tracks.row(2 * f + 1) = view.pinhole.fy_px * tracks.row(2 * f + 1).array() + view.pinhole.cy_px;
  }
  return tracks;
}

}  // namespace

Tracks flow_tracks(const Motion& motion, const Shapes& points_m, const Visible& seen,
                   const std::vector<CameraFromObject>& cameras, const PictureView& view, std::uint64_t seed) {
  const Eigen::Index frames = motion.frames();
  const std::size_t per_frame = (cameras.size() - 1) / static_cast<std::size_t>(frames - 1);
  std::vector<CameraFromObject> of_frames;
  for (std::size_t k = 0; k < cameras.size(); k += per_frame) of_frames.push_back(cameras[k]);
  const Tracks truth = in_pixels(project(points_m, of_frames, view.projection, view.pinhole), view);
  PictureView first = view;
  first.camera = cameras.front();
  const double pixel = pixel_m(first, shape_of(points_m, 0).rowwise().mean());
  const Paint paint{4 * pixel, seed};
  const int half_px = TrackerOptions{}.half_px;

  Tracker tracker(points_m.cols());
  std::vector<char> begun(static_cast<std::size_t>(points_m.cols()), 0);
  Tracks tracks(2 * frames, points_m.cols());
  const std::size_t batch = 2 * static_cast<std::size_t>(threads());
  for (std::size_t start = 0; start < cameras.size(); start += batch) {
    std::vector<GreyPicture> pictures(std::min(batch, cameras.size() - start));
    parallel_for(0, pictures.size(), [&](std::size_t k) {
      const std::size_t at = start + k;
      PictureView here = view;
      here.camera = cameras[at];
      const double part = static_cast<double>(at % per_frame) / static_cast<double>(per_frame);
      const FrameMesh mesh = mesh_between(motion, static_cast<Eigen::Index>(at / per_frame), part);
      pictures[k] = picture_of(mesh, motion.material_m, here, paint);
    });
    for (std::size_t k = 0; k < pictures.size(); ++k) {
      const auto f = static_cast<Eigen::Index>((start + k) / per_frame);
      std::vector<Eigen::Index> beginning;
      for (Eigen::Index p = 0; p < points_m.cols() && (start + k) % per_frame == 0; ++p)
        if (!begun[static_cast<std::size_t>(p)] && seen(f, p) &&
            is_one_surface(pictures[k], truth.block<2, 1>(2 * f, p), half_px, 2 * half_px * pixel))
          beginning.push_back(p);
      tracker.advance(std::move(pictures[k]));
      if ((start + k) % per_frame != 0) continue;
      for (const Eigen::Index p : beginning) {
        begun[static_cast<std::size_t>(p)] = 1;
        tracker.begin(p, truth.block<2, 1>(2 * f, p));
      }
      tracks.middleRows<2>(2 * f) = tracker.places_px();
    }
  }
  return tracks;
}

TrackErrors track_errors(const Sequence& s) {
  const Tracks truth = project(*s.truth, s.cameras, s.projection, s.pinhole.value_or(Pinhole{}));
  std::vector<double> errors;
  for (Eigen::Index f = 0; f < s.frames(); ++f)
    for (Eigen::Index p = 0; p < s.points(); ++p)
      if (s.visible(f, p)) errors.push_back((s.tracks - truth).block<2, 1>(2 * f, p).norm());
  if (errors.empty()) return {};
  return {stats::median(errors), stats::quantile(errors, 0.95)};
}

}  // namespace gonio::nrsfm
