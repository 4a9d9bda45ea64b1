// What a projector throws on a slanted plane, seen by a camera beside it, against the geometry: the ratio of a picture
// that rises along its columns to a white one is the projector's column (row), bilinear and so linear within it. Every
// sample of a pixel sees the same lamp; the ratio's scatter is that of places within the camera's pixel, at most one
// column and a half here, over sqrt(256) samples: 5 sigma are 0.15 columns.
#include <gtest/gtest.h>

#include "geom/rigid.h"
#include "scenes.h"

namespace gonio::render {
namespace {

constexpr int width = 60, height = 40;
constexpr double f_px = 70, cx_px = 24.5, cy_px = 21.25, albedo = 0.6, power = 3;

io::Image lit_by(std::shared_ptr<const io::Image> picture) {
  tests::SceneBuilder builder;
  builder.object(scene::Plane{4, 4}, builder.diffuse(albedo), {}, {0.35, 0.2, 0});
  builder.light("projector",
                {{"position_m", std::vector<double>{0.5, 0.1, 1.5}},
                 {"direction", std::vector<double>{-0.3, 0, -1}},
                 {"up", std::vector<double>{0, 1, 0}},
                 {"fx_px", f_px},
                 {"fy_px", f_px},
                 {"cx_px", cx_px},
                 {"cy_px", cy_px},
                 {"watt_per_sr", power}},
                std::move(picture));
  const scene::Scene scene = builder.view(tests::pinhole(24, 60), {-0.2, 0, 2}, {pi, 0, 0}).scene();
  return tests::render_view(scene, {.spp = 256, .geometry = false});
}

TEST(Projector, ThrowsEachPixelWhereTheGeometrySays) {
  auto ramps = std::make_shared<io::Image>(width, height, std::vector<std::string>{"R", "G", "B"});
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      ramps->at(x, y, 0) = static_cast<float>(x), ramps->at(x, y, 1) = static_cast<float>(y), ramps->at(x, y, 2) = 1;
  const io::Image seen = lit_by(ramps);
  const camera::CameraModel camera = tests::pinhole(24, 60);
  const Vec3 normal = matrix_of(quaternion_of_rotation_vector({0.35, 0.2, 0})) * Vec3{0, 0, 1};
  // The lens' own axes: forward, right = forward x up, down.
  const Vec3 forward = normalized(Vec3{-0.3, 0, -1}), right = normalized(cross(forward, Vec3{0, 1, 0})),
             down = cross(forward, right), lens{0.5, 0.1, 1.5};
  int checked = 0;
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 24; ++x) {
      const Vec3 ray = camera.ray({1.0 * x, 1.0 * y}).direction, direction{ray.x, -ray.y, -ray.z}, eye{-0.2, 0, 2};
      const Vec3 at = eye + direction * (-dot(eye, normal) / dot(direction, normal)), arm = at - lens;
      const double z = dot(arm, forward), column = f_px * dot(arm, right) / z + cx_px,
                   row = f_px * dot(arm, down) / z + cy_px;
      if (column < 1 || row < 1 || column > width - 2 || row > height - 2) continue;
      ++checked;
      const double white = seen.at(x, y, 2), square = dot(arm, arm);
      EXPECT_NEAR(seen.at(x, y, 0) / white, column, 0.15) << x << " " << y;
      EXPECT_NEAR(seen.at(x, y, 1) / white, row, 0.15) << x << " " << y;
      EXPECT_NEAR(white, albedo / pi * power * -dot(arm, normal) / (square * std::sqrt(square)), 0.01 * white);
    }
  EXPECT_GT(checked, 200);
}

}  // namespace
}  // namespace gonio::render
