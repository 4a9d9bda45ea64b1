// See flow.h.
#include "nrsfm/flow.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/video/tracking.hpp>

#include "base/parallel.h"
#include "base/random.h"
#include "nrsfm/frame_caster.h"

namespace gonio::nrsfm {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// Value noise, smooth between random values of a cubic lattice; mean 0, values within -1 and 1.
double noise(const Eigen::Vector3d& p, std::uint64_t seed) {
  const Eigen::Vector3d cell = p.array().floor(), f = p - cell;
  const Eigen::Array3d t = f.array().square() * (3 - 2 * f.array());
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1;
    std::uint64_t key = seed;
    for (int axis = 0; axis < 3; ++axis) {
      const int up = corner >> axis & 1;
      weight *= up ? t(axis) : 1 - t(axis);
      key = split_mix(key ^ static_cast<std::uint64_t>(static_cast<std::int64_t>(cell(axis)) + up));
    }
    sum += weight * (static_cast<double>(key >> 11) * 0x1p-52 - 1);
  }
  return sum;
}

// Albedo at a place of the material.
double albedo(const Paint& paint, const Eigen::Vector3d& place_m) {
  constexpr int octaves = 4;
  double sum = 0;
  for (int k = 0; k < octaves; ++k)
    sum += noise(place_m / (paint.grain_m * (1 << k)), split_mix(paint.seed + static_cast<std::uint64_t>(k)));
  return std::clamp(0.5 + 0.35 * sum, 0.05, 0.95);
}

// Ray through a place of the picture: origin and direction in the object's frame. Orthographic ones start at the depth
// `nearest` of the camera's frame.
std::pair<Eigen::Vector3d, Eigen::Vector3d> ray_through(const PictureView& view, double x_px, double y_px,
                                                        double nearest) {
  const Eigen::Matrix3d back = view.camera.rotation.transpose();
  const double x = (x_px - view.pinhole.cx_px) / view.pinhole.fx_px;
  const double y = (y_px - view.pinhole.cy_px) / view.pinhole.fy_px;
  if (view.projection == Projection::perspective)
    return {-back * view.camera.translation, (back * Eigen::Vector3d(x, y, 1)).normalized()};
  return {back * (Eigen::Vector3d(x, y, nearest) - view.camera.translation), back.col(2)};
}

// Width of a pixel on the object, metres.
double pixel_m(const PictureView& view, const Eigen::Vector3d& centre_m) {
  if (view.projection == Projection::orthographic) return 1 / view.pinhole.fx_px;
  return (view.camera.rotation * centre_m + view.camera.translation).z() / view.pinhole.fx_px;
}

cv::Mat mat(const GreyPicture& picture) {
  return cv::Mat(picture.height, picture.width, CV_8UC1, const_cast<std::uint8_t*>(picture.value.data()));
}

}  // namespace

GreyPicture picture_of(const Motion& motion, Eigen::Index frame, const PictureView& view, const Paint& paint) {
  const FrameMesh mesh = motion.mesh(frame);
  const FrameCaster caster(mesh);
  const Eigen::Vector3d centre = mesh.vertices_m.rowwise().mean();
  const double size = (mesh.vertices_m.colwise() - centre).colwise().norm().maxCoeff();
  const double nearest = (view.camera.rotation * centre + view.camera.translation).z() - 2 * size;
  const Eigen::Vector3d lamp = Eigen::Vector3d(0.5, -0.6, 1).normalized();
  GreyPicture picture{view.width, view.height, {}};
  picture.value.reserve(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height));
  for (int y = 0; y < view.height; ++y) {
    for (int x = 0; x < view.width; ++x) {
      double sum = 0;
      for (const auto& [dx, dy] : {std::pair{0.25, 0.25}, {0.75, 0.25}, {0.25, 0.75}, {0.75, 0.75}}) {
        const auto [origin, direction] = ray_through(view, x + dx, y + dy, nearest);
        const auto met = caster.closest(origin, direction);
        if (!met) continue;
        const auto& t = mesh.triangles[met->triangle];
        const Eigen::Vector3d place = (1 - met->b1 - met->b2) * motion.material_m.col(t[0]) +
                                      met->b1 * motion.material_m.col(t[1]) + met->b2 * motion.material_m.col(t[2]);
        sum += albedo(paint, place) * (0.35 + 0.65 * std::max(0.0, met->normal.dot(lamp)));
      }
      picture.value.push_back(static_cast<std::uint8_t>(std::lround(255 * sum / 4)));
    }
  }
  return picture;
}

Tracks follow(const std::vector<GreyPicture>& pictures, const Tracks& start_px, double back_px) {
  const auto frames = static_cast<Eigen::Index>(pictures.size());
  Tracks tracks = Tracks::Constant(2 * frames, start_px.cols(), nan);
  tracks.topRows<2>() = start_px;
  const cv::Size window(15, 15);
  constexpr int levels = 3;
  for (Eigen::Index f = 1; f < frames; ++f) {
    std::vector<cv::Point2f> from, to, back;
    std::vector<Eigen::Index> who;
    for (Eigen::Index p = 0; p < tracks.cols(); ++p) {
      if (std::isnan(tracks(2 * f - 2, p))) continue;
      who.push_back(p);
      from.emplace_back(static_cast<float>(tracks(2 * f - 2, p) - 0.5), static_cast<float>(tracks(2 * f - 1, p) - 0.5));
    }
    if (who.empty()) break;
    const cv::Mat before = mat(pictures[static_cast<std::size_t>(f - 1)]),
                  now = mat(pictures[static_cast<std::size_t>(f)]);
    std::vector<std::uint8_t> found, returned;
    std::vector<float> residual;
    cv::calcOpticalFlowPyrLK(before, now, from, to, found, residual, window, levels);
    cv::calcOpticalFlowPyrLK(now, before, to, back, returned, residual, window, levels);
    for (std::size_t k = 0; k < who.size(); ++k) {
      const bool inside = to[k].x >= 0 && to[k].y >= 0 && to[k].x <= static_cast<float>(now.cols - 1) &&
                          to[k].y <= static_cast<float>(now.rows - 1);
      if (!found[k] || !returned[k] || !inside || cv::norm(back[k] - from[k]) > back_px) continue;
      tracks(2 * f, who[k]) = to[k].x + 0.5;
      tracks(2 * f + 1, who[k]) = to[k].y + 0.5;
    }
  }
  return tracks;
}

Tracks flow_tracks(const Motion& motion, const std::vector<CameraFromObject>& cameras, const PictureView& view,
                   std::uint64_t seed) {
  PictureView first = view;
  first.camera = cameras.front();
  const Paint paint{2.5 * pixel_m(first, shape_of(motion.points_m, 0).rowwise().mean()), seed};
  std::vector<GreyPicture> pictures(cameras.size());
  parallel_for(0, pictures.size(), [&](std::size_t f) {
    PictureView here = view;
    here.camera = cameras[f];
    pictures[f] = picture_of(motion, static_cast<Eigen::Index>(f), here, paint);
  });
  Tracks start = project(motion.points_m.topRows<3>(), {cameras.front()}, view.projection, view.pinhole);
  if (view.projection == Projection::orthographic) {
    start.row(0) = view.pinhole.fx_px * start.row(0).array() + view.pinhole.cx_px;
    start.row(1) = view.pinhole.fy_px * start.row(1).array() + view.pinhole.cy_px;
  }
  const auto seen = visible_in(motion.mesh(0), shape_of(motion.points_m, 0), cameras.front(), view.projection,
                               motion.tolerance_m, motion.one_sided);
  for (Eigen::Index p = 0; p < start.cols(); ++p)
    if (!seen(p)) start.col(p).setConstant(nan);
  return follow(pictures, start);
}

TrackErrors track_errors(const Sequence& s) {
  const Tracks truth = project(*s.truth, s.cameras, s.projection, s.pinhole.value_or(Pinhole{}));
  std::vector<double> errors;
  for (Eigen::Index f = 0; f < s.frames(); ++f)
    for (Eigen::Index p = 0; p < s.points(); ++p)
      if (s.visible(f, p)) errors.push_back((s.tracks - truth).block<2, 1>(2 * f, p).norm());
  if (errors.empty()) return {};
  std::sort(errors.begin(), errors.end());
  return {errors[errors.size() / 2], errors[errors.size() * 95 / 100]};
}

}  // namespace gonio::nrsfm
