// Light between the walls of a groove, by paths, against the same integral over the other wall's squares.
#include "explain/clouds/indirect_light.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/text.h"

namespace gonio::tests {
namespace {

using explain::CloudShape;
using explain::IndirectLight;

// Two walls of a right angle, 0.1 m wide and 0.2 m high, that meet in the line x = 0, z = 0.7 and open towards -z.
constexpr double wide = 0.1, high = 0.2, away = 0.7;
Vec3 on_wall(double side, double along, double up) {
  return {side * along * std::sqrt(0.5), up, away - along * std::sqrt(0.5)};
}
Vec3 normal_of(double side) {
  return {-side * std::sqrt(0.5), 0, -std::sqrt(0.5)};
}

CloudShape groove() {
  std::vector<Vec3> corners;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (const double side : {-1.0, 1.0}) {
    const auto first = static_cast<std::uint32_t>(corners.size());
    for (const auto& [a, u] : {std::pair{0.0, -high / 2}, {wide, -high / 2}, {wide, high / 2}, {0.0, high / 2}})
      corners.push_back(on_wall(side, a, u));
    triangles.push_back({first, first + 1, first + 2}), triangles.push_back({first, first + 2, first + 3});
  }
  return CloudShape::of_mesh(std::make_shared<const explain::ShapeMesh>(std::move(corners), std::move(triangles)), {});
}

scan::Station projector() {
  const camera::Intrinsics lens{700, 700, 239.5, 179.5, {}};
  scan::Station s{camera::CameraModel(lens, 480, 360), {}};
  s.rig_from_camera.translation_m = {0.03, 0, 0};
  return s;
}
Vec2 pixel_of(Vec3 p) {
  return {700 * (p.x - 0.03) / p.z + 239.5, 700 * p.y / p.z + 179.5};
}
double irradiance(Vec3 p, Vec3 n) {
  const Vec3 way = Vec3{0.03, 0, 0} - p;
  return dot(way, n) / std::pow(norm(way), 3);
}

TEST(IndirectLight, BetweenWallsIsTheIntegralOverTheOther) {
  const CloudShape shape = groove();
  const double periods[] = {1, 8, 40};
  std::vector<IndirectLight::Point> points;
  for (const double along : {0.005, 0.02, 0.06}) {
    const Vec3 p = on_wall(-1, along, 0.01);
    points.push_back({p, normal_of(-1), pixel_of(p)});
  }
  const IndirectLight light(shape, points, projector(), periods, {});
  ASSERT_TRUE(light.any());
  for (std::size_t i = 0; i < points.size(); ++i) {
    constexpr int cells = 800;
    double hidden = 0;
    std::array<std::complex<double>, 3> sums{};
    for (int a = 0; a < cells; ++a)
      for (int b = 0; b < cells; ++b) {
        // Finer where the walls meet.
        const double t = (a + 0.5) / cells, along = wide * t * t, up = high * ((b + 0.5) / cells - 0.5);
        const Vec3 q = on_wall(1, along, up), way = q - points[i].at;
        const double area = wide * 2 * t / cells * high / cells, r2 = dot(way, way),
                     form = dot(way, points[i].normal) * -dot(way, normal_of(1)) / (pi * r2 * r2) * area;
        hidden += form;
        const double light_there = irradiance(q, normal_of(1)) / irradiance(points[i].at, points[i].normal);
        for (std::size_t k = 0; k < 3; ++k)
          sums[k] += std::polar(form * light_there, 2 * pi * periods[k] * (pixel_of(q).x - points[i].told.x) / 480);
      }
    EXPECT_NEAR(light.hidden(i), hidden, 0.01);
    // Of little albedo the first bounce alone matters: its part of the turn, from two albedos.
    for (std::size_t k = 0; k < 3; ++k) {
      const double small = 1e-3;
      EXPECT_NEAR(light.turn(i, 0, k, small) / small, sums[k].imag(), 0.01) << "point " << i << ", set " << k;
    }
  }
}

TEST(IndirectLight, GoesToAndFro) {
  const double periods[] = {1};
  const Vec3 p = on_wall(-1, 0.02, 0);
  const IndirectLight::Point points[] = {{p, normal_of(-1), pixel_of(p)}};
  const IndirectLight light(groove(), points, projector(), periods, {});
  // A second bounce comes back from the point's own wall and turns its phase less: as a share the turn grows by less.
  const double weak = light.turn(0, 0, 0, 0.1) / 0.1, strong = light.turn(0, 0, 0, 0.9) / 0.9;
  EXPECT_GT(std::abs(weak), std::abs(strong));
  EXPECT_EQ(light.turn(0, 0, 0, 0), 0);
}

}  // namespace
}  // namespace gonio::tests
