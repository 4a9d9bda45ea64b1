// See tracker.h.
#include "nrsfm/make/tracker.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

#include "base/loaded_library.h"
#include "base/parallel.h"
#include "linear/svd.h"
#include "nrsfm/make/optical_flow_module.h"
#include "nrsfm/make/patch.h"

namespace gonio::nrsfm {
namespace {

constexpr int levels = 3;

// As OpenCV counts: 0 is the first pixel's centre.
cv::Point2f point(const Eigen::Vector2d& place_px) {
  return {static_cast<float>(place_px.x() - 0.5), static_cast<float>(place_px.y() - 0.5)};
}

}  // namespace

struct Tracker::Impl {
  struct Followed {
    std::optional<Patch> patch;
    Warp warp;                // of the patch in the last picture
    double area = 1;          // of the patch over that of the first
    double largest = 1;       // that the area has been
    double variance_px2 = 0;  // of where the patch began, about the point that was begun with
    double sigma_px = 0;
  };
  TrackerOptions options;
  GreyPicture last;              // of which only the pixels are used
  std::vector<cv::Mat> pyramid;  // of the last picture
  std::vector<Followed> points;
  Eigen::Matrix2Xd places_px;

  cv::Size window() const { return {2 * options.half_px + 1, 2 * options.half_px + 1}; }

  // Whether the point is found near `expected`.
  bool find(Followed& f, const GreyPicture& now, const Eigen::Vector2d& expected) const {
    Warp warp{f.warp.a, expected};
    const auto fit = f.patch->align(now, warp);
    if (!fit || fit->likeness < options.likeness || (warp.t - expected).norm() > options.correction_px) return false;
    const double area = f.area * warp.a.determinant();
    f.largest = std::max(f.largest, area);
    if (area < options.left * f.largest) return false;
    f.warp = warp;
    f.sigma_px = std::sqrt(f.variance_px2 + fit->sigma_px * fit->sigma_px);
    const Eigen::Vector2d sizes = linear::JacobiSvd<Eigen::Matrix2d>(warp.a).singularValues();
    if (sizes.maxCoeff() < options.change && sizes.minCoeff() * options.change > 1) return true;
    auto anew = Patch::of(now, warp.t, options.half_px);
    if (!anew) return true;
    f.patch = std::move(anew);
    f.warp.a.setIdentity();
    f.area = area;
    f.variance_px2 = f.sigma_px * f.sigma_px;
    return true;
  }
};

Tracker::Tracker(Eigen::Index points, const TrackerOptions& options) : impl_(std::make_unique<Impl>()) {
  impl_->options = options;
  impl_->points.resize(static_cast<std::size_t>(points));
  impl_->places_px = Eigen::Matrix2Xd::Constant(2, points, std::numeric_limits<double>::quiet_NaN());
}
Tracker::~Tracker() = default;

void Tracker::advance(GreyPicture picture) {
  Impl& i = *impl_;
  const cv::Mat now(picture.height, picture.width, CV_8UC1, picture.value.data());
  std::vector<cv::Mat> pyramid;
  static const auto build = loaded_from_module<decltype(gonio_flow_pyramid)>("optical_flow", "gonio_flow_pyramid");
  static const auto flow = loaded_from_module<decltype(gonio_flow)>("optical_flow", "gonio_flow");
  build(now, pyramid, i.window(), levels);
  std::vector<cv::Point2f> from, to, back;
  std::vector<std::size_t> who;
  for (std::size_t p = 0; p < i.points.size(); ++p) {
    if (!i.points[p].patch) continue;
    who.push_back(p);
    from.push_back(point(i.points[p].warp.t));
  }
  if (!who.empty()) {
    std::vector<std::uint8_t> found, returned;
    flow(i.pyramid, pyramid, from, to, found, i.window(), levels);
    flow(pyramid, i.pyramid, to, back, returned, i.window(), levels);
    parallel_for(0, who.size(), [&](std::size_t k) {
      Impl::Followed& f = i.points[who[k]];
      const bool there_and_back = found[k] && returned[k] && cv::norm(back[k] - from[k]) <= i.options.back_px;
      if (!there_and_back || !i.find(f, picture, {to[k].x + 0.5, to[k].y + 0.5})) f.patch.reset();
      const auto column = static_cast<Eigen::Index>(who[k]);
      i.places_px.col(column).setConstant(std::numeric_limits<double>::quiet_NaN());
      if (f.patch) i.places_px.col(column) = f.warp.t;
    });
  }
  i.last = std::move(picture);  // its pixels stay where they are
  i.pyramid = std::move(pyramid);
}

void Tracker::begin(Eigen::Index point, const Eigen::Vector2d& place_px) {
  Impl::Followed& f = impl_->points[static_cast<std::size_t>(point)];
  f = {Patch::of(impl_->last, place_px, impl_->options.half_px), {Eigen::Matrix2d::Identity(), place_px}};
  if (f.patch) impl_->places_px.col(point) = place_px;
}

const Eigen::Matrix2Xd& Tracker::places_px() const {
  return impl_->places_px;
}

double Tracker::sigma_px(Eigen::Index point) const {
  return impl_->points[static_cast<std::size_t>(point)].sigma_px;
}

}  // namespace gonio::nrsfm
