// The full forward model of board corners: what it adds vanishes to the bit, means what its equations say, and
// differentiates as it predicts.
#include "camera/corner_model.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "mechanism/mechanism.h"

namespace gonio::camera {
namespace {

CornerModel model() {
  CornerModel m;
  const Intrinsics k{500, 510, 320, 240, {-0.2, 0.05, 1e-3, -2e-3, 0.01, 0, 0, 0, 0, 0, 0, 0, 0}};
  m.values[0] = k.fx_px, m.values[1] = k.fy_px, m.values[2] = k.cx_px, m.values[3] = k.cy_px;
  std::copy(k.distortion.begin(), k.distortion.end(), m.values.begin() + BoardColumn::distortion);
  m.values[BoardColumn::warp] = 3e-4;
  m.pose.rotation = quaternion_of_rotation_vector({0.3, -0.25, 0.1});
  m.pose.translation_m = {-0.04, -0.03, 0.4};
  m.extent = {{0.045, 0.03}, {0.045, 0.03}};
  m.height_px = 480;
  m.warmer_K = 4, m.later_s = 100;
  return m;
}
std::vector<CornerPlace> places() {
  std::vector<CornerPlace> result;
  for (int k = 0; k < 12; ++k)
    result.push_back({{0.03 * (k % 4), 0.03 * (k / 4)}, static_cast<Colour>(k % 3), k % 2 == 0 ? 0 : 0.7});
  return result;
}
std::size_t column(const char* name) {
  const auto found = corner_column(name);
  if (!found) throw std::runtime_error(name);
  return *found;
}

TEST(CornerModel, WithoutFurtherTermsItIsTheCalibrationsToTheBit) {
  const CornerModel m = model();
  const Intrinsics k{
      m.values[0], m.values[1], m.values[2], m.values[3], {-0.2, 0.05, 1e-3, -2e-3, 0.01, 0, 0, 0, 0, 0, 0, 0, 0}};
  for (const CornerPlace& place : places()) {
    Vec2 own, plain;
    ASSERT_TRUE(predict(m, place, own));
    ASSERT_TRUE(predict(k, m.pose, m.extent, {3e-4, 0}, place.board_m, plain));
    EXPECT_EQ(own, plain);
  }
}

// Every parameter that the registry declares for boards is a column, each its own.
TEST(CornerModel, HasAColumnForEveryParameterOfTheRegistry) {
  std::set<std::size_t> columns;
  std::size_t parameters = 0;
  for (const mechanism::Mechanism* m : mechanism::all_mechanisms()) {
    if (std::ranges::find(m->domains, "boards") == m->domains.end()) continue;
    if (m->lists) {  // of single corners: three numbers, and which corner it is
      for (std::size_t k = 0; k < print_names.size(); ++k) EXPECT_EQ(m->parameters[k].name, print_names[k]);
      continue;
    }
    for (const mechanism::Parameter& p : m->parameters) {
      const auto found = corner_column(p.name);
      ASSERT_TRUE(found.has_value()) << m->id << " " << p.name;
      columns.insert(*found);
      ++parameters;
      EXPECT_EQ(p.neutral, CornerModel{}.values[*found]) << m->id << " " << p.name;
    }
    EXPECT_FALSE(m->conditions.empty()) << m->id;
    EXPECT_FALSE(m->mistaken_for.empty()) << m->id;
    EXPECT_FALSE(m->typical.empty()) << m->id;
  }
  EXPECT_EQ(columns.size(), parameters);
  EXPECT_GE(parameters, 30u);
  EXPECT_FALSE(corner_column("watt_per_sr").has_value());
}

// At every term's own values, with all others in play beside it.
TEST(CornerModel, DerivativesAreThoseOfDifferences) {
  CornerModel m = model();
  for (const auto& [name, value] : std::initializer_list<std::pair<const char*, double>>{
           {"sag_y_m", -2e-4},     {"motion_x_m", 4e-3},  {"motion_y_m", -6e-3}, {"scale_x", 4e-3},
           {"scale_y", -2e-3},     {"pupil_m", 6e-3},     {"red_linear", 2e-3},  {"red_cubic", -4e-3},
           {"blue_linear", -1e-3}, {"blue_cubic", 3e-3},  {"bias_x_px", 0.4},    {"bias_y_px", -0.3},
           {"focal_per_K", 1e-4},  {"x_px_per_K", 0.1},   {"y_px_per_K", -0.2},  {"focal_per_s", 1e-6},
           {"x_px_per_s", 1e-3},   {"y_px_per_s", -2e-3}, {"index", 1.31},       {"distance_m", 0.05},
           {"tilt_x_rad", 0.06},   {"tilt_y_rad", -0.09}, {"relative", 0.02},    {"z11_m", 2e-4},
           {"z40_m", -1e-4},       {"x21_m", 3e-5},       {"y03_m", -4e-5}})
    m.values[column(name)] = value;
  for (const CornerPlace& place : places()) {
    Vec2 at, up, down;
    CornerJacobian j{};
    ASSERT_TRUE(predict(m, place, at, j));
    Vec2 same;
    ASSERT_TRUE(predict(m, place, same));
    EXPECT_LT(norm(at - same), 1e-9);
    for (std::size_t c = 0; c < CornerColumn::count; ++c) {
      CornerModel high = m, low = m;
      const double step = c < 4 ? 1e-3 : 1e-6;
      if (c >= BoardColumn::rotation && c < BoardColumn::warp) {
        std::array<double, 6> change{};
        change[c - BoardColumn::rotation] = step;
        high.pose = moved(m.pose, change);
        change[c - BoardColumn::rotation] = -step;
        low.pose = moved(m.pose, change);
      } else if (c == BoardColumn::distortion + LensTerm::fisheye) {
        continue;  // one-sided at zero; lens_terms_test.cpp
      } else {
        high.values[c] += step, low.values[c] -= step;
      }
      ASSERT_TRUE(predict(high, place, up));
      ASSERT_TRUE(predict(low, place, down));
      const Vec2 slope = (up - down) * (1 / (2 * step));
      EXPECT_NEAR(j[0][c], slope.x, 2e-5 * (1 + std::abs(slope.x))) << c;
      EXPECT_NEAR(j[1][c], slope.y, 2e-5 * (1 + std::abs(slope.y))) << c;
    }
  }
}

// The ray at the angle theta starts at the height pupil sin^2 theta: points along it are seen at one pixel.
TEST(CornerModel, PointsOfOneRayAreSeenAtOnePixel) {
  CornerModel m = model();
  m.values[BoardColumn::warp] = 0;
  m.values[column("pupil_m")] = 8e-3;
  m.pose = {};
  const double theta = 0.5, pupil = 8e-3 * std::sin(theta) * std::sin(theta);
  std::vector<Vec2> pixels;
  for (const double range : {0.2, 0.5, 2.0}) {
    m.pose.translation_m = {range * std::sin(theta), 0, pupil + range * std::cos(theta)};
    Vec2 pixel;
    ASSERT_TRUE(predict(m, {{0, 0}}, pixel));
    pixels.push_back(pixel);
  }
  EXPECT_LT(norm(pixels[0] - pixels[1]), 1e-9);
  EXPECT_LT(norm(pixels[0] - pixels[2]), 1e-9);
}

// Where the index is one, only the index moves pixels, and by what its difference says.
TEST(CornerModel, APortOfAirIsNone) {
  CornerModel m = model();
  m.values[column("distance_m")] = 0.05, m.values[column("tilt_x_rad")] = 0.1;
  for (const CornerPlace& place : places()) {
    Vec2 plain, same, up, down;
    CornerJacobian j{};
    ASSERT_TRUE(predict(model(), place, plain));
    ASSERT_TRUE(predict(m, place, same, j));
    EXPECT_LT(norm(same - plain), 1e-9);
    CornerModel high = m, low = m;
    high.values[column("index")] += 1e-6, low.values[column("index")] -= 1e-6;
    ASSERT_TRUE(predict(high, place, up));
    ASSERT_TRUE(predict(low, place, down));
    EXPECT_NEAR(j[0][column("index")], (up.x - down.x) / 2e-6, 1e-3 * (1 + std::abs(j[0][column("index")])));
    EXPECT_NEAR(j[1][column("index")], (up.y - down.y) / 2e-6, 1e-3 * (1 + std::abs(j[1][column("index")])));
    for (const char* name : {"distance_m", "tilt_x_rad", "tilt_y_rad"})
      for (std::size_t axis = 0; axis < 2; ++axis) EXPECT_EQ(j[axis][column(name)], 0) << name;
  }
}

TEST(CornerModel, GreenIsTheReferenceAndEachTermDoesWhatItSays) {
  const CornerModel plain = model();
  const auto shift = [&](const char* name, double value, CornerPlace place) {
    CornerModel m = plain;
    m.values[column(name)] = value;
    Vec2 before, after;
    EXPECT_TRUE(predict(plain, place, before));
    EXPECT_TRUE(predict(m, place, after));
    return after - before;
  };
  const Vec2 at{0.06, 0.03};
  for (const char* name : {"red_linear", "red_cubic", "blue_linear", "blue_cubic"})
    EXPECT_EQ(shift(name, 0.01, {at, Colour::green}), (Vec2{0, 0})) << name;
  Vec2 pixel;
  ASSERT_TRUE(predict(plain, {at}, pixel));
  const Vec2 outward = pixel - Vec2{320, 240};
  EXPECT_LT(norm(shift("red_linear", 0.01, {at, Colour::red}) - outward * 0.01), 1e-9);
  EXPECT_EQ(shift("red_linear", 0.01, {at, Colour::blue}), (Vec2{0, 0}));
  EXPECT_LT(norm(shift("bias_x_px", 0.5, {at, Colour::green, pi}) - Vec2{-0.5, 0}), 1e-12);
  EXPECT_LT(norm(shift("x_px_per_K", 0.1, {at}) - Vec2{0.4, 0}), 1e-12);
  EXPECT_LT(norm(shift("focal_per_s", 1e-5, {at}) - outward * 1e-3), 1e-9);
}

}  // namespace
}  // namespace gonio::camera
