// Contours of bodies whose surface is known: where the wall is, which way its normals point, what stays sharp.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "volume/contour.h"
#include "volume/surfaces.h"
#include "volume/topology.h"

namespace gonio::volume {
namespace {

using tests::MemoryVolume;

// 100 inside, 0 outside, blurred by a normal spread of some voxels across the surface; `distance` is positive inside.
double blurred(double distance, double spread) {
  return 50 * (1 + std::erf(distance / (spread * std::sqrt(2.0))));
}

struct Errors {
  double mean = 0, rms = 0, largest = 0;  // voxels, positive outwards
  double normals = 0;                     // rms, degrees
};
// `distance` and `outward` of the true surface nearest to a point.
Errors errors(
    const Contour& surface, const std::function<double(Vec3)>& distance, const std::function<Vec3(Vec3)>& outward,
    const std::function<bool(Vec3)>& counts = [](Vec3) { return true; }) {
  Errors e;
  double count = 0;
  for (std::size_t n = 0; n < surface.positions.size(); ++n) {
    const auto &p = surface.positions[n], &q = surface.normals[n];
    const Vec3 at{p[0], p[1], p[2]}, normal{q[0], q[1], q[2]};
    EXPECT_NEAR(norm(normal), 1, 1e-5);
    if (!counts(at)) continue;
    const double d = distance(at);
    const double angle = std::acos(std::clamp(dot(normal, outward(at)), -1.0, 1.0));
    e.mean += d;
    e.rms += d * d;
    e.largest = std::max(e.largest, std::abs(d));
    e.normals += angle * angle;
    ++count;
  }
  e.mean /= count;
  e.rms = std::sqrt(e.rms / count);
  e.normals = std::sqrt(e.normals / count) * 180 / pi;
  return e;
}

TEST(Accuracy, OfASphere) {
  const Vec3 centre{16.1, 15.7, 16.4};
  const double radius = 12.3;
  for (const double spread : {0.5, 0.7, 1.0, 1.5}) {
    MemoryVolume volume({33, 33, 33}, [&](double i, double j, double k) {
      return blurred(radius - norm(Vec3{i, j, k} - centre), spread);
    });
    const Contour surface = contour(volume, {50});
    const Errors e = errors(
        surface, [&](Vec3 p) { return norm(p - centre) - radius; }, [&](Vec3 p) { return normalized(p - centre); });
    // Vertices lie on tangents: outside a sphere by about 1 / (6 radius).
    EXPECT_NEAR(e.mean, 1 / (6 * radius), 0.003) << spread;
    EXPECT_LT(e.rms, 0.025) << spread;
    EXPECT_LT(e.normals, spread < 0.7 ? 0.5 : 0.1) << spread;
    EXPECT_NEAR(tests::enclosed_volume(surface) / (4.0 / 3 * pi * std::pow(radius, 3)), 1, 2e-3);
    EXPECT_NEAR(tests::area(surface) / (4 * pi * radius * radius), 1, 4e-3);
    EXPECT_EQ(surface.split_polygons, 0u);
    EXPECT_EQ(tests::soundness(surface.positions, surface.triangles).euler, 2);
  }
}

TEST(Accuracy, OfATorus) {
  const Vec3 centre{20.2, 19.7, 10.3}, axis = normalized(Vec3{0.2, -0.1, 1});
  const double large = 13, small = 5;
  const auto to_ring = [&](Vec3 p) {  // from the nearest point of the ring
    const Vec3 d = p - centre, flat = d - dot(d, axis) * axis;
    return d - large * normalized(flat);
  };
  MemoryVolume volume({41, 41, 22}, [&](double i, double j, double k) {
    return blurred(small - norm(to_ring({i, j, k})), 0.8);
  });
  const Contour surface = contour(volume, {50});
  const Errors e = errors(
      surface, [&](Vec3 p) { return norm(to_ring(p)) - small; }, [&](Vec3 p) { return normalized(to_ring(p)); });
  EXPECT_LT(e.rms, 0.04);
  EXPECT_LT(e.normals, 0.5);
  EXPECT_EQ(tests::soundness(surface.positions, surface.triangles).euler, 0);
  EXPECT_NEAR(tests::enclosed_volume(surface) / (2 * pi * pi * large * small * small), 1, 5e-3);
}

TEST(Accuracy, ObliqueWallsOfTwoVoxelsSurvive) {
  const Vec3 normal = normalized(Vec3{1, 2, 3}), middle{20, 20, 20};
  for (const double thickness : {2.0, 2.5, 4.0}) {
    MemoryVolume volume({40, 40, 40}, [&](double i, double j, double k) {
      const double d = dot(normal, Vec3{i, j, k} - middle);
      return blurred(d + thickness / 2, 0.7) - blurred(d - thickness / 2, 0.7);
    });
    const Contour surface = contour(volume, {50});
    const Errors e = errors(
        surface, [&](Vec3 p) { return std::abs(dot(normal, p - middle)) - thickness / 2; },
        [&](Vec3 p) { return dot(normal, p - middle) > 0 ? normal : -normal; },
        [](Vec3 p) {
          return std::min({p.x, p.y, p.z}) > 1 && std::max({p.x, p.y, p.z}) < 38;
        });
    EXPECT_LT(e.rms, 0.02) << thickness;
    EXPECT_LT(e.normals, 0.3) << thickness;
    EXPECT_EQ(tests::soundness(surface.positions, surface.triangles).euler, 2) << thickness;  // one plate, no hole
  }
}

// A cube by its distance, turned against the grid.
TEST(Accuracy, ACubesEdgesStaySharpWithHermiteData) {
  const Vec3 middle{16.2, 15.9, 16.3};
  const Basis axes(normalized(Vec3{0.3, 0.2, 1}));
  const double half = 9.4;
  const auto local = [&](Vec3 p) { return axes.to_local(p - middle); };
  MemoryVolume volume({33, 33, 33}, [&](double i, double j, double k) {
    const Vec3 q = local({i, j, k});
    return half - std::max({std::abs(q.x), std::abs(q.y), std::abs(q.z)});
  });
  std::array<double, 2> volumes{}, furthest{};
  for (const bool hermite : {false, true}) {
    ContourWish wish;
    wish.hermite = hermite;
    const Contour surface = contour(volume, wish);
    volumes[hermite] = tests::enclosed_volume(surface) / std::pow(2 * half, 3);
    double corners = 0;  // how far the surface reaches into the cube's eight corners
    for (int c = 0; c < 8; ++c) {
      const Vec3 corner =
          middle + axes.to_world(Vec3{c & 1 ? half : -half, c & 2 ? half : -half, c & 4 ? half : -half});
      double nearest = 1e9;
      for (const auto& p : surface.positions) nearest = std::min(nearest, norm(Vec3{p[0], p[1], p[2]} - corner));
      corners = std::max(corners, nearest);
    }
    furthest[hermite] = corners;
  }
  // Gradients see two voxels: those next to an edge mix both of its faces, and the edge comes out as a narrow chamfer.
  EXPECT_NEAR(volumes[1], 1, 5e-3);
  EXPECT_LT(std::abs(1 - volumes[1]), 0.5 * std::abs(1 - volumes[0]));
  EXPECT_LT(furthest[1], 0.55);
  EXPECT_LT(furthest[1], 0.6 * furthest[0]);
  RecordProperty("corner_hermite", std::to_string(furthest[1]));
  RecordProperty("corner_mean", std::to_string(furthest[0]));
}

}  // namespace
}  // namespace gonio::volume
