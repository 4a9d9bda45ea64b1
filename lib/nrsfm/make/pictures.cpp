// See pictures.h.
#include "nrsfm/make/pictures.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/random.h"
#include "linear/solve.h"
#include "nrsfm/make/frame_caster.h"

namespace gonio::nrsfm {
namespace {

// Value noise, smooth between random values of a cubic lattice; mean 0, values within -1 and 1.
double noise(const Eigen::Vector3d& p, std::uint64_t seed) {
  const Eigen::Vector3d cell = p.array().floor(), f = p - cell;
  const Eigen::Array3d t = f.array().square() * (3 - 2 * f.array());
  const auto mixed = [&cell](std::uint64_t key, int axis, int up) {
    return split_mix(key ^ static_cast<std::uint64_t>(static_cast<std::int64_t>(cell(axis)) + up));
  };
  double sum = 0;
  for (int i = 0; i < 2; ++i) {
    const std::uint64_t x = mixed(seed, 0, i);
    for (int j = 0; j < 2; ++j) {
      const std::uint64_t xy = mixed(x, 1, j);
      for (int k = 0; k < 2; ++k) {
        const double weight = (i ? t(0) : 1 - t(0)) * (j ? t(1) : 1 - t(1)) * (k ? t(2) : 1 - t(2));
        sum += weight * (static_cast<double>(mixed(xy, 2, k) >> 11) * 0x1p-52 - 1);
      }
    }
  }
  return sum;
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

// The pixels from (x0, y0) to before (x1, y1).
struct Window {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};
// That can show the mesh; all of them where it reaches behind the camera.
Window showing(const FrameMesh& mesh, const PictureView& view) {
  const Eigen::Matrix3Xd seen = (view.camera.rotation * mesh.vertices_m).colwise() + view.camera.translation;
  Eigen::Array2Xd at = seen.topRows<2>();
  if (view.projection == Projection::perspective) {
    if (seen.row(2).minCoeff() <= 0) return {0, 0, view.width, view.height};
    at.rowwise() /= seen.row(2).array();
  }
  const auto clamped = [](double pixel, int most) {
    return static_cast<int>(std::clamp(pixel, 0.0, static_cast<double>(most)));
  };
  const Pinhole& k = view.pinhole;
  return {clamped(std::floor(k.fx_px * at.row(0).minCoeff() + k.cx_px), view.width),
          clamped(std::floor(k.fy_px * at.row(1).minCoeff() + k.cy_px), view.height),
          clamped(std::floor(k.fx_px * at.row(0).maxCoeff() + k.cx_px) + 1, view.width),
          clamped(std::floor(k.fy_px * at.row(1).maxCoeff() + k.cy_px) + 1, view.height)};
}

}  // namespace

double albedo(const Paint& paint, const Eigen::Vector3d& material_m) {
  constexpr int octaves = 4;
  double sum = 0;
  for (int k = 0; k < octaves; ++k)
    sum += noise(material_m / (paint.grain_m * (1 << k)), split_mix(paint.seed + static_cast<std::uint64_t>(k)));
  return std::clamp(0.5 + 0.35 * sum, 0.05, 0.95);
}

double pixel_m(const PictureView& view, const Eigen::Vector3d& place_m) {
  if (view.projection == Projection::orthographic) return 1 / view.pinhole.fx_px;
  return (view.camera.rotation * place_m + view.camera.translation).z() / view.pinhole.fx_px;
}

GreyPicture picture_of(const FrameMesh& mesh, const Eigen::Matrix3Xd& material_m, const PictureView& view,
                       const Paint& paint) {
  const FrameCaster caster(mesh);
  const Eigen::Vector3d centre = mesh.vertices_m.rowwise().mean();
  const double size = (mesh.vertices_m.colwise() - centre).colwise().norm().maxCoeff();
  const double nearest = (view.camera.rotation * centre + view.camera.translation).z() - 2 * size;
  const Eigen::Vector3d lamp = Eigen::Vector3d(0.5, -0.6, 1).normalized();
  struct Seen {
    double light = 0;
    float depth_m = std::numeric_limits<float>::infinity();
  };
  const auto look = [&](double x_px, double y_px) {
    const auto [origin, direction] = ray_through(view, x_px, y_px, nearest);
    const auto met = caster.closest(origin, direction);
    if (!met) return Seen{};
    const auto& t = mesh.triangles[met->triangle];
    const Eigen::Vector3d place = on_triangle(material_m, t, met->b1, met->b2);
    return Seen{albedo(paint, place) * (0.35 + 0.65 * std::max(0.0, met->normal.dot(lamp))),
                static_cast<float>(met->distance_m)};
  };
  GreyPicture picture{view.width, view.height, {}, {}};
  const auto width = static_cast<std::size_t>(view.width);
  picture.value.assign(width * static_cast<std::size_t>(view.height), 0);
  picture.depth_m.assign(picture.value.size(), Seen{}.depth_m);
  const Window window = showing(mesh, view);
  for (int y = window.y0; y < window.y1; ++y)
    for (int x = window.x0; x < window.x1; ++x) {
      const std::array<Seen, 4> seen{look(x + 0.25, y + 0.25), look(x + 0.75, y + 0.25), look(x + 0.25, y + 0.75),
                                     look(x + 0.75, y + 0.75)};
      const double light = seen[0].light + seen[1].light + seen[2].light + seen[3].light;
      const std::size_t at = static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
      picture.value[at] = static_cast<std::uint8_t>(std::lround(255 * light / 4));
      picture.depth_m[at] = (seen[0].depth_m + seen[1].depth_m + seen[2].depth_m + seen[3].depth_m) / 4;
    }
  return picture;
}

bool is_one_surface(const GreyPicture& picture, const Eigen::Vector2d& place_px, int half_px, double extent_m) {
  const int x0 = static_cast<int>(std::floor(place_px.x())), y0 = static_cast<int>(std::floor(place_px.y()));
  if (x0 < half_px || y0 < half_px || x0 + half_px >= picture.width || y0 + half_px >= picture.height) return false;
  const Eigen::Index side = 2 * half_px + 1;
  Eigen::VectorXd depths(side * side);
  Eigen::Matrix3Xd by_place(3, side * side);
  Eigen::Index k = 0;
  for (int v = -half_px; v <= half_px; ++v)
    for (int u = -half_px; u <= half_px; ++u, ++k) {
      const auto at =
          static_cast<std::size_t>(y0 + v) * static_cast<std::size_t>(picture.width) + static_cast<std::size_t>(x0 + u);
      depths(k) = static_cast<double>(picture.depth_m[at]);
      by_place.col(k) << u, v, 1;
    }
  if (!depths.allFinite()) return false;
  const Eigen::Matrix3d normal = by_place * by_place.transpose();
  const Eigen::Vector3d plane = linear::solve_ldlt(normal, by_place * depths);
  return (depths - by_place.transpose() * plane).cwiseAbs().maxCoeff() < extent_m / 2;
}

}  // namespace gonio::nrsfm
