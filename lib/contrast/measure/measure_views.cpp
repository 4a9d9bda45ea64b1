// Contrast of single views, their directions, and which of them belong together (contrast/measure/measure_views.h).
#include "contrast/measure/measure_views.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "linear/symmetric_eigen.h"
#include "stats/intervals.h"

namespace gonio::contrast {
namespace {

constexpr double same_direction_rad = pi / 180;

// Unit vector from the pattern's middle to the camera, in the world; nothing without a pose.
std::optional<Vec3> direction(const Input& input, const InputView& view) {
  const auto& pose = input.pose[static_cast<std::size_t>(view.placement)];
  if (!pose || !view.pose) return std::nullopt;
  const Vec2 size = input.pattern.size_m();
  const Vec3 middle = pose->world_from_pattern * Vec3{size.x / 2, size.y / 2, 0};
  const auto world_from_camera = inverse(view.pose->camera_from_world);
  if (view.camera->orthographic()) return -world_from_camera.rotate({0, 0, 1});
  return normalized(world_from_camera.translation_m - middle);
}

Vec3 normal_of(const Input& input, int placement) {  // towards who looks at the sample, in the world
  return -input.pose[static_cast<std::size_t>(placement)]->world_from_pattern.rotate({0, 0, 1});
}

// The horizontal direction in which the cameras are spread the most, with a positive largest component.
Vec3 main_direction(const std::vector<Vec3>& directions, Vec3 normal) {
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  Vec3 mean;
  for (const Vec3 d : directions) mean += d / static_cast<double>(directions.size());
  for (const Vec3 d : directions) {
    const Vec3 flat = (d - mean) - normal * dot(d - mean, normal);
    spread += Eigen::Vector3d(flat.x, flat.y, flat.z) * Eigen::RowVector3d(flat.x, flat.y, flat.z);
  }
  if (spread.trace() < 1e-8) return Basis(normal).t;
  const Eigen::Vector3d axis = linear::SymmetricEigen<Eigen::Matrix3d>(spread).eigenvectors().col(2);
  Eigen::Index most = 0;
  axis.cwiseAbs().maxCoeff(&most);
  const double sign = axis(most) < 0 ? -1 : 1;
  return {sign * axis(0), sign * axis(1), sign * axis(2)};
}

}  // namespace

Members members_of(const CellPattern& pattern) {
  Members members;
  for (std::size_t cell = 0; cell < pattern.cells(); ++cell) members[pattern.bits[cell]].push_back(cell);
  return members;
}

ViewFit fit_view(const CellPattern& pattern, const Members& members, const CellMeans& means) {
  return {{fit_class(pattern, members[0], means.mean, means.sigma),
           fit_class(pattern, members[1], means.mean, means.sigma)}};
}

metric::Estimate michelson_of(metric::Estimate a, metric::Estimate b) {
  const double sum = a.value + b.value;
  if (!(std::abs(sum) > 0)) return {std::nan(""), std::nan("")};
  return {(a.value - b.value) / sum, 2 * std::hypot(b.value * a.sigma, a.value * b.sigma) / (sum * sum)};
}

void enter_contrast(const CellPattern& pattern, const ViewFit& fit, MeasuredView& view) {
  const ClassFit &zero = fit.of[0], &one = fit.of[1];
  view.bright = {one.mean, one.sigma};
  view.dark = {zero.mean, zero.sigma};
  view.difference = {one.mean - zero.mean, std::hypot(one.sigma, zero.sigma)};
  view.michelson = michelson_of(view.bright, view.dark);
  // Welch & Satterthwaite; fits without degrees of freedom rest on the pixels' noise, of which there are many.
  const auto part = [](const ClassFit& c) { return c.degrees >= 1 ? std::pow(c.sigma, 4) / c.degrees : 0.0; };
  const double parts = part(zero) + part(one);
  view.degrees = parts > 0 ? std::pow(view.difference.sigma, 4) / parts : 1000;
  int counted = 0, right = 0;
  view.ratio.assign(pattern.cells(), std::nan(""));
  for (std::size_t cell = 0; cell < pattern.cells(); ++cell) {
    const double value = view.means.mean[cell], a = one.expected[cell], b = zero.expected[cell];
    if (!std::isfinite(value)) continue;
    ++counted;
    right += (value > (a + b) / 2) == ((pattern.bits[cell] == 1) == (view.difference.value >= 0));
    view.ratio[cell] = value / (pattern.bits[cell] == 1 ? a : b);
  }
  view.right = counted > 0 ? static_cast<double>(right) / counted : 0;
}

std::vector<double> deviations(const CellPattern& pattern, const ViewFit& fit, const CellMeans& means) {
  std::vector<double> z(pattern.cells(), std::nan(""));
  for (std::uint8_t bit = 0; bit < 2; ++bit) {
    const ClassFit& of = fit.of[bit];
    std::vector<double> size;
    for (std::size_t cell = 0; cell < pattern.cells(); ++cell) {
      if (pattern.bits[cell] != bit || !std::isfinite(means.mean[cell])) continue;
      // Over the brightness there: texture scatters by shares of it. What is dark beside its scatter stays as it is.
      const double by = of.expected[cell] > 5 * of.scatter ? of.expected[cell] : of.mean;
      z[cell] = (means.mean[cell] - of.expected[cell]) / std::max(std::abs(by), 1e-300);
      size.push_back(std::abs(z[cell]));
    }
    if (size.empty()) continue;
    const double n = static_cast<double>(size.size());
    const double scatter =
        std::max(stats::sigma_of_median * stats::median(size) * std::sqrt(n / std::max(of.degrees, 1.0)), 1e-9);
    for (std::size_t cell = 0; cell < pattern.cells(); ++cell)
      if (pattern.bits[cell] == bit) z[cell] /= scatter;
  }
  return z;
}

void enter_directions(const Input& input, std::vector<MeasuredView>& views, const std::vector<std::size_t>& of_input) {
  std::vector<Vec3> all;
  for (const std::size_t i : of_input)
    if (const auto d = direction(input, input.views[i])) all.push_back(*d);
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t v = 0; v < views.size(); ++v) {
    MeasuredView& view = views[v];
    view.tilt_rad = view.azimuth_rad = view.along_rad = unknown;
    const auto d = direction(input, input.views[of_input[v]]);
    if (!d) continue;
    const auto& pose = input.pose[static_cast<std::size_t>(view.placement)]->world_from_pattern;
    const Vec3 local = matrix_of(conjugate(pose.rotation)) * *d, normal = normal_of(input, view.placement);
    view.tilt_rad = std::atan2(std::hypot(local.x, local.y), -local.z);
    view.azimuth_rad = std::atan2(-local.y, local.x);
    view.along_rad = std::atan2(dot(*d, main_direction(all, normal)), dot(*d, normal));
  }
}

std::vector<std::pair<std::size_t, std::size_t>> partners(const Input& input, const std::vector<MeasuredView>& views,
                                                          const std::vector<std::size_t>& of_input) {
  std::array<std::vector<std::size_t>, 2> of;
  bool posed = true;
  for (std::size_t v = 0; v < views.size(); ++v) {
    of[static_cast<std::size_t>(views[v].placement)].push_back(v);
    posed = posed && direction(input, input.views[of_input[v]]);
  }
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  if (!posed && of[0].size() == of[1].size())
    for (std::size_t k = 0; k < of[0].size(); ++k) pairs.emplace_back(of[0][k], of[1][k]);
  if (!posed) return pairs;
  for (const std::size_t a : of[0]) {
    const Vec3 from = *direction(input, input.views[of_input[a]]);
    double best = same_direction_rad;
    std::optional<std::size_t> partner;
    for (const std::size_t b : of[1]) {
      const Vec3 to = *direction(input, input.views[of_input[b]]);
      const double angle = std::atan2(norm(cross(from, to)), dot(from, to));
      const bool same_light = views[a].lights == views[b].lights;
      if (!same_light || angle >= best) continue;
      best = angle;
      partner = b;
    }
    if (partner) pairs.emplace_back(a, *partner);
  }
  return pairs;
}

}  // namespace gonio::contrast
