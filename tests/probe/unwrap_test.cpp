// lib/probe/unwrap.h, fill.h: what is not seen is marked, filled or left black; views share what they show.
#include "probe/unwrap.h"

#include <gtest/gtest.h>

#include "probe/bright_lights.h"
#include "probe/fill.h"
#include "probe/projection.h"

namespace gonio::probe {
namespace {

constexpr int size = 160;

double angle_between(Vec3 a, Vec3 b) {
  return std::atan2(norm(cross(a, b)), dot(a, b));
}
double room(Vec3 d) {
  return 2 + d.x + 0.5 * d.y * d.z;
}

// A perfect mirror at the origin before a camera at `eye`, which looks at it.
BallView view_from(Vec3 eye) {
  camera::Intrinsics lens;
  lens.fx_px = lens.fy_px = 700, lens.cx_px = lens.cy_px = (size - 1) / 2.0;
  BallView view{.picture = io::Image(size, size, {"Y"}), .camera = {lens, size, size}};
  const Vec3 forward = normalized(-eye), right = normalized(cross(forward, {0, 0, 1})), down = cross(forward, right);
  view.world_from_camera = {
      quaternion_of(Mat3{{right.x, down.x, forward.x, right.y, down.y, forward.y, right.z, down.z, forward.z}}), eye};
  view.ball = {{}, 0.03};
  const MirrorBall mirror = view.mirror();
  view.radius_px = 700 * std::tan(std::asin(0.03 / norm(eye)));
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const camera::Ray ray = view.camera.ray({double(x), double(y)});
      if (const auto r = mirror.reflect(eye, view.world_from_camera.rotate(ray.direction)))
        view.picture.at(x, y, 0) = static_cast<float>(room(r->direction));
    }
  return view;
}

class Unwrapping : public testing::Test {
 protected:
  Unwrapping() {
    wish_.columns = 128;
    wish_.metal.perfect = true;
  }
  Unwrapped of(const std::vector<BallView>& views) const {
    std::vector<Facing> faces;
    for (const BallView& v : views) faces.push_back(facing(v, wish_));
    return unwrapped(views, faces, wish_);
  }
  template <class Check>
  void each_texel(const Check& check) const {
    const SphereMap map = sized(Projection::lat_long, wish_.columns / 2);
    for (int y = 0; y < map.height; ++y)
      for (int x = 0; x < map.width; ++x) check(x, y, direction_at(map, {x + 0.5, y + 0.5})->unit);
  }
  UnwrapWish wish_;
  const Vec3 eye_{-0.3, 0.05, 0.04};
};

TEST_F(Unwrapping, OneViewIsBlindBehindTheBallAndWhereTheCameraStands) {
  wish_.camera_radius_m = 0.06;
  wish_.fill = false;
  const Unwrapped u = of({view_from(eye_)});
  const double hidden = std::atan2(0.06, norm(eye_)), behind = std::asin(0.03 / norm(eye_));
  EXPECT_GT(u.blind_sr, 2 * pi * (2 - std::cos(hidden) - std::cos(behind)));
  EXPECT_LT(u.blind_sr, 1.4);  // the rest is the rim
  each_texel([&](int x, int y, Vec3 d) {
    const bool blind = angle_between(d, eye_) < hidden || angle_between(d, -eye_) < behind;
    if (blind) {
      EXPECT_EQ(u.weight.at(x, y, 0), 0);
      EXPECT_EQ(u.radiance.at(x, y, 0), 0);
    }
    if (u.weight.at(x, y, 0) == 1) {
      EXPECT_NEAR(u.radiance.at(x, y, 0), room(d), 0.02 * room(d));
      EXPECT_GT(u.weight.at(x, y, 1), 0);
    }
  });
}

TEST_F(Unwrapping, HolesTakeTheirNeighboursLight) {
  wish_.camera_radius_m = 0.06;
  const Unwrapped u = of({view_from(eye_)});
  each_texel([&](int x, int y, Vec3 d) { EXPECT_NEAR(u.radiance.at(x, y, 0), room(d), 0.35); });
}

TEST_F(Unwrapping, OtherViewsSeeWhatOneDoesNot) {
  wish_.camera_radius_m = 0.06;
  const Unwrapped u = of({view_from(eye_), view_from({0.1, 0.28, 0.05}), view_from({0.12, -0.25, 0.1})});
  EXPECT_LT(u.blind_sr, 1e-9);
  each_texel([&](int x, int y, Vec3 d) { EXPECT_NEAR(u.radiance.at(x, y, 0), room(d), 0.01 * room(d)); });
}

// A view that contradicts the other one counts the less, the coarser it shows a direction.
TEST_F(Unwrapping, TheViewThatShowsADirectionFinerCountsMore) {
  BallView bright = view_from({0.1, 0.28, 0.05});
  for (float& v : bright.picture.data) v *= 2;
  const Unwrapped u = of({view_from(eye_), bright});
  double facing_first = 0, facing_second = 0;
  each_texel([&](int x, int y, Vec3 d) {
    const double factor = double{u.radiance.at(x, y, 0)} / room(d);
    if (angle_between(d, {-0.3, -0.2, 0.04}) < 0.1) facing_first = factor;
    if (angle_between(d, {0.3, 0.28, 0.05}) < 0.1) facing_second = factor;
    EXPECT_GT(factor, 0.97);
    EXPECT_LT(factor, 2.03);
  });
  EXPECT_LT(facing_first, 1.5);
  EXPECT_GT(facing_second, 1.5);
}

TEST_F(Unwrapping, MaskedPixelsAreNotUsed) {
  BallView view = view_from(eye_);
  view.counts.assign(view.picture.pixels(), 1);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size / 2; ++x) view.counts[static_cast<std::size_t>(y * size + x)] = 0;
  const Facing face = facing(view, wish_);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size / 2; ++x) EXPECT_EQ(face.used[static_cast<std::size_t>(y * size + x)], 0);
  EXPECT_GT(of({view}).blind_sr, 2);
}

// Another ball that stands beside it is no surroundings: a disc of its own half angle, seen from the first.
TEST_F(Unwrapping, WhatTheBallShowsOfOtherBallsIsLeftOut) {
  wish_.camera_radius_m = 0;
  wish_.fill = false;
  BallView view = view_from(eye_);
  const double before = of({view}).blind_sr;
  const Ball other{{-0.3, 2, 0.2}, 0.3};  // far enough that all points of the first ball see it alike
  view.others = {other};
  const Unwrapped u = of({view});
  const double half_angle = std::asin(other.radius_m / norm(other.centre_m));
  const double disc =
      2 * pi * (1 - std::cos(half_angle));  // and a tenth of the radius and a pixel, 2 degrees, about it
  EXPECT_GT(u.blind_sr - before, disc);
  EXPECT_LT(u.blind_sr - before, 2.2 * disc);
  each_texel([&](int x, int y, Vec3 d) {
    if (angle_between(d, other.centre_m) < 0.8 * half_angle) {
      EXPECT_EQ(u.weight.at(x, y, 0), 0);
    }
  });
}

// A lamp that one view shows and the other denies stays in the picture; one that both show leaves it.
TEST_F(Unwrapping, ALampThatAViewDeniesIsNone) {
  const Vec3 lamp = normalized(Vec3{-0.4, 0.6, 0.7});
  std::vector<BallView> views{view_from(eye_), view_from({0.1, 0.28, 0.05})};
  const auto shine = [&](BallView& view) {
    const MirrorBall mirror = view.mirror();
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        const camera::Ray ray = view.camera.ray({double(x), double(y)});
        const auto r =
            mirror.reflect(view.world_from_camera.translation_m, view.world_from_camera.rotate(ray.direction));
        if (r && angle_between(r->direction, lamp) < 0.08) view.picture.at(x, y, 0) = 300;
      }
  };
  const auto found = [&] {
    std::vector<Facing> faces;
    std::vector<Highlight> spots;
    for (const BallView& v : views) faces.push_back(facing(v, wish_));
    for (std::size_t v = 0; v < views.size(); ++v)
      for (const Highlight& h : highlights(views, faces, v, {})) spots.push_back(h);
    return agreed(lights_of(spots, {}, {}), spots, views, faces);
  };
  shine(views[0]);
  EXPECT_TRUE(found().empty());
  shine(views[1]);
  const auto lights = found();
  ASSERT_EQ(lights.size(), 1u);
  EXPECT_LT(angle_between(lights[0].direction, lamp), 0.01);
  EXPECT_NEAR(lights[0].half_angle_rad, 0.08, 0.01);
  // 300 less the room's 2 or so, over the disc's solid angle.
  EXPECT_NEAR(lights[0].irradiance.x, 298 * pi * 0.08 * 0.08, 0.1 * 298 * pi * 0.08 * 0.08);
}

TEST(Fill, WithoutAnythingSeenNothingChanges) {
  io::Image radiance(8, 4, {"R", "G", "B"}), weight(8, 4, {"Y"});
  fill_unseen(radiance, weight);
  for (const float v : radiance.data) EXPECT_EQ(v, 0);
  weight.at(3, 2, 0) = 1;
  radiance.at(3, 2, 1) = 5;
  fill_unseen(radiance, weight);
  for (std::size_t i = 0; i < radiance.pixels(); ++i) EXPECT_FLOAT_EQ(radiance.data[3 * i + 1], 5);
}

}  // namespace
}  // namespace gonio::probe
