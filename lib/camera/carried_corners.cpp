// See carried_corners.h.
#include "camera/carried_corners.h"

#include <algorithm>
#include <cmath>

namespace gonio::camera {

Carriers::Carriers(const std::vector<View>& views, std::size_t index) : view_(views[index]), of_(view_.corners.size()) {
  for (std::size_t k = 0; k < view_.corners.size(); ++k) {
    const auto& looked_up = view_.corners[k].looked_up;
    if (looked_up == nullptr) continue;
    for (const LookedUp::At& at : looked_up->at)
      for (std::size_t v = 0; v < views.size(); ++v) {
        const View& other = views[v];
        if (v == index || other.camera != at.camera || other.shot != view_.shot || other.board != view_.board) continue;
        const auto found = std::ranges::find(other.corners, view_.corners[k].id, &Corner::id);
        if (found == other.corners.end()) continue;
        of_[k].push_back({v, static_cast<std::size_t>(found - other.corners.begin()),
                          Eigen::Matrix2d{{at.slope[0], at.slope[1]}, {at.slope[2], at.slope[3]}}});
      }
    if (of_[k].size() != looked_up->at.size()) of_[k].clear();
    for (const CarriedFrom& from : of_[k])
      if (std::ranges::find(views_, from.view) == views_.end()) views_.push_back(from.view);
  }
}

std::optional<double> Carriers::variance_px2(std::size_t corner) const {
  const Corner& own = view_.corners[corner];
  if (!of_[corner].empty()) return 0.5 * (own.looked_up->own[0] + own.looked_up->own[2]);
  if (own.sigma_px > 0) return own.sigma_px * own.sigma_px;
  return std::nullopt;
}

// The inverse of the root of the covariance over its mean variance: of the 2 x 2 matrix m, root m = (m + sqrt(det) 1) /
// sqrt(trace + 2 sqrt(det)).
Eigen::Matrix2d Carriers::whitening(std::size_t corner) const {
  if (of_[corner].empty()) return Eigen::Matrix2d::Identity();
  const std::array<double, 3>& own = view_.corners[corner].looked_up->own;
  const double mean = 0.5 * (own[0] + own[2]), a = own[0] / mean, b = own[1] / mean, c = own[2] / mean,
               root = std::sqrt(std::max(1e-12, a * c - b * b)), whole = std::sqrt(a + c + 2 * root);
  return Eigen::Matrix2d{{c + root, -b}, {-b, a + root}} / (root * whole);
}

std::vector<Vec2> misses(const std::vector<View>& views, const CalibrationSetup& setup, const Adjustment& state,
                         std::size_t index) {
  std::vector<Vec2> result = residuals(views[index], setup, state, index);
  if (std::ranges::none_of(views[index].corners, [](const Corner& c) { return c.looked_up != nullptr; })) return result;
  const Carriers carriers(views, index);
  std::vector<std::vector<Vec2>> carried(views.size());
  for (const std::size_t v : carriers.views()) carried[v] = residuals(views[v], setup, state, v);
  for (std::size_t k = 0; k < result.size(); ++k) {
    Eigen::Vector2d r(result[k].x, result[k].y);
    for (const CarriedFrom& from : carriers.of(k)) {
      const Vec2 own = carried[from.view][from.corner];
      r -= from.slope * Eigen::Vector2d(own.x, own.y);
    }
    r = carriers.whitening(k) * r;
    result[k] = {r(0), r(1)};
  }
  return result;
}

}  // namespace gonio::camera
