// Projectors against the pinhole camera in their place, and against the thin lens' closed form.
#include <gtest/gtest.h>

#include "camera/camera_model.h"
#include "cases.h"
#include "geom/rigid.h"

namespace gonio::tests {
namespace {

using light::Emitter;

manifest::Parameter vector_of(Vec3 v) {
  return std::vector<double>{v.x, v.y, v.z};
}

constexpr int width = 40, height = 30;

// Where it stands, and which way it looks, as the rig's entry says it.
struct Stand {
  Quaternion world_from_projector = quaternion_of_rotation_vector({0.3, -0.8, 2.1});
  Vec3 position_m{0.2, -0.1, 0.4};
};

std::unique_ptr<Emitter> projector(const Stand& stand, std::shared_ptr<const io::Image> picture,
                                   manifest::Parameters more = {}) {
  const Mat3 turn = matrix_of(stand.world_from_projector);
  more["position_m"] = vector_of(stand.position_m);
  more["direction"] = vector_of(turn * Vec3{0, 0, 1});
  more["up"] = vector_of(turn * Vec3{0, -1, 0});
  more["fx_px"] = 50.0, more["fy_px"] = 53.0, more["cx_px"] = 18.2, more["cy_px"] = 16.7;
  more["watt_per_sr"] = 2.0;
  return light::find("projector")->prepare(more, {std::move(picture), {}}, "p");
}
camera::CameraModel pinhole() {
  return {camera::Intrinsics{50, 53, 18.2, 16.7, {}}, width, height};
}
// Red along the columns, green along the rows.
std::shared_ptr<io::Image> ramps() {
  auto picture = std::make_shared<io::Image>(width, height, std::vector<std::string>{"R", "G", "B"});
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      picture->at(x, y, 0) = static_cast<float>(x), picture->at(x, y, 1) = static_cast<float>(y),
                        picture->at(x, y, 2) = 1;
  return picture;
}

TEST(Projector, LightsWhatTheCameraInItsPlaceSeesAtThePixel) {
  const Stand stand;
  const auto light = projector(stand, ramps());
  const camera::CameraModel camera = pinhole();
  const Rigid<frame::World, frame::Camera> world_from_camera{stand.world_from_projector, stand.position_m};
  Random random(11);
  int lit = 0;
  for (int k = 0; k < 2000; ++k) {
    const Vec2 pixel{random.uniform(-2, width + 1), random.uniform(-2, height + 1)};
    const double distance = random.uniform(0.3, 3);
    const camera::Ray ray = camera.ray(pixel);
    const auto s = light->sample(world_from_camera * (ray.origin_m + distance * ray.direction), {0.3, 0.4});
    const bool inside = pixel.x > -0.5 && pixel.y > -0.5 && pixel.x < width - 0.5 && pixel.y < height - 0.5;
    ASSERT_EQ(s.valid, inside) << pixel.x << " " << pixel.y;
    if (!inside) continue;
    ++lit;
    EXPECT_TRUE(s.delta);
    EXPECT_NEAR(s.distance_m, distance, 1e-12);
    EXPECT_NEAR(norm(s.direction + world_from_camera.rotate(ray.direction)), 0, 1e-12);
    const double white = 2 / (distance * distance);
    EXPECT_NEAR(s.weight.x / white, std::clamp<double>(pixel.x, 0, width - 1), 1e-5);
    EXPECT_NEAR(s.weight.y / white, std::clamp<double>(pixel.y, 0, height - 1), 1e-5);
    EXPECT_NEAR(s.weight.z / white, 1, 1e-9);
  }
  EXPECT_GT(lit, 1000);
  const Vec3 behind = stand.position_m - matrix_of(stand.world_from_projector) * Vec3{0, 0, 1};
  EXPECT_FALSE(light->sample(behind, {0.5, 0.5}).valid);
}

TEST(Projector, GammaActsOnThePixelsBeforeTheyBlend) {
  auto picture = std::make_shared<io::Image>(width, height, std::vector<std::string>{"Y"});
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) picture->at(x, y, 0) = x == 18 ? 0.5f : x == 19 ? 0.25f : 1.0f;
  const Stand stand;
  const auto bent = projector(stand, picture, {{"gamma", 2.2}});
  for (const double right : {0.0, 0.4, 1.0}) {
    const Vec3 along = pinhole().ray({18 + right, 12}).direction;
    const auto s = bent->sample(stand.position_m + matrix_of(stand.world_from_projector) * along, {0.5, 0.5});
    EXPECT_NEAR(s.weight.x / 2, (1 - right) * std::pow(0.5, 2.2) + right * std::pow(0.25, 2.2), 1e-9);
  }
}

// The power of a pixel far from others, as irradiance over the plane at a distance: whatever the lens, the same; its
// second moment that of a disc of f R |1 / focus - 1 / z| px, added to that of a bilinear pixel, 1/6 along each axis.
TEST(Projector, OutOfFocusAPixelIsADisc) {
  constexpr double radius = 0.06, focus = 1.2;
  auto picture = std::make_shared<io::Image>(width, height, std::vector<std::string>{"Y"});
  picture->at(18, 15, 0) = 1;
  Stand stand;
  stand.world_from_projector = {1, 0, 0, 0}, stand.position_m = {};
  const auto light = projector(stand, picture, {{"radius_m", radius}, {"focus_m", focus}});
  for (const double z : {0.8, 1.2, 2.0}) {
    double sum = 0, first = 0, second = 0;
    constexpr int steps = 120, grid = 12;
    constexpr double half_px = 5;
    for (int i = 0; i < steps; ++i)
      for (int j = 0; j < steps; ++j) {
        const double u = half_px * ((2.0 * i + 1) / steps - 1), v = half_px * ((2.0 * j + 1) / steps - 1);
        const Vec3 at{(18 + u - 18.2) / 50 * z, (15 + v - 16.7) / 53 * z, z};
        const double e = irradiance_by_sampling(*light, at, {0, 0, -1}, grid).x;
        sum += e, first += u * e, second += u * u * e;
      }
    const double pixel_m2 = z * z / (50 * 53), step_px2 = 4 * half_px * half_px / (steps * steps);
    const double blur_px = 50 * radius * std::abs(1 / focus - 1 / z);
    EXPECT_NEAR(sum * step_px2 * pixel_m2, 2 / (50.0 * 53), 0.01 * 2 / (50.0 * 53)) << z;
    EXPECT_NEAR(first / sum, 0, 0.02) << z;
    EXPECT_NEAR(second / sum, 1.0 / 6 + blur_px * blur_px / 4, 0.03 * (0.2 + blur_px * blur_px / 4)) << z;
  }
}

TEST(Projector, OfVanishingRadiusIsThePoint) {
  const Stand stand;
  const auto point = projector(stand, ramps()), tiny = projector(stand, ramps(), {{"radius_m", 1e-9}});
  Random random(12);
  for (int k = 0; k < 200; ++k) {
    const Vec3 along = pinhole().ray({random.uniform(0, width - 1), random.uniform(0, height - 1)}).direction;
    const Vec3 at = stand.position_m + matrix_of(stand.world_from_projector) * along * random.uniform(0.5, 2);
    const auto a = point->sample(at, {0.2, 0.7}), b = tiny->sample(at, {0.2, 0.7});
    ASSERT_TRUE(a.delta && !b.delta);
    EXPECT_NEAR(max_component(b.weight - a.weight), 0, 1e-5 * max_component(a.weight));
  }
}

// All photons of a white picture: watt_per_sr times the solid angle of the frustum, four right triangles' worth.
TEST(Projector, WhitePictureFillsItsSolidAngle) {
  auto white = std::make_shared<io::Image>(width, height, std::vector<std::string>{"Y"});
  for (float& v : white->data) v = 1;
  for (const double radius : {0.0, 0.02}) {
    const auto light = projector({}, white, {{"radius_m", radius}});
    double sum = 0;
    constexpr int grid = 200;
    for (int i = 0; i < grid; ++i)
      for (int j = 0; j < grid; ++j)
        sum += light->emit({0.1 + 0.004 * i, 0.1 + 0.004 * j}, {(i + 0.5) / grid, (j + 0.5) / grid}).flux.x;
    const auto corner = [](double x, double y) { return std::atan(x * y / std::sqrt(1 + x * x + y * y)); };
    const double left = 18.7 / 50, right = 21.3 / 50, up = 17.2 / 53, down = 12.8 / 53;
    const double solid = corner(left, up) + corner(left, down) + corner(right, up) + corner(right, down);
    EXPECT_NEAR(sum / (grid * grid), 2 * solid, 1e-3 * 2 * solid) << radius;
  }
}

}  // namespace
}  // namespace gonio::tests
