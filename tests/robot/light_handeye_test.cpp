// A light on a tool, found in the world: simulation with known truth, coverage of the intervals, motions that leave
// something open.
#include "robot/light_handeye.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "base/error.h"
#include "base/random.h"
#include "manifest/document.h"
#include "manifest/sections/light_position.h"
#include "manifest/sections/mounting.h"

namespace gonio::robot {
namespace {

using testing::Contains;
using testing::HasSubstr;

const Rigid<frame::World, frame::Base> true_base{normalized(Quaternion{0.7, 0.1, -0.2, 0.6}), {0.8, -0.3, 0.4}};
const Vec3 true_light{0.03, -0.02, 0.15};
enum class Motion { rich, shifts, one_axis };

std::vector<LightSample> samples(std::uint64_t seed, int count, double robot_m, double sigma_m,
                                 Motion motion = Motion::rich) {
  Random random(seed, 3);
  std::vector<LightSample> list;
  const auto normal3 = [&] { return Vec3{random.normal(), random.normal(), random.normal()}; };
  for (int i = 0; i < count; ++i) {
    Vec3 turn{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-2, 2)};
    if (motion == Motion::shifts) turn = {0.3, -0.2, 0.5};
    if (motion == Motion::one_axis) turn = {0, 0, turn.z};
    const Rigid<frame::Base, frame::Tool> tool{
        quaternion_of_rotation_vector(turn),
        {random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4), random.uniform(0.1, 0.6)}};
    const Vec3 p = true_base * (tool * true_light) + normal3() * sigma_m + normal3() * robot_m;
    list.push_back({"p" + std::to_string(i),
                    tool,
                    p,
                    {std::max(sigma_m, 1e-6), std::max(sigma_m, 1e-6), std::max(sigma_m, 1e-6)}});
  }
  return list;
}

std::array<double, 9> error(const LightMounting& m) {
  const Vec3 turn = rotation_vector_of(m.world_from_base.rotation * conjugate(true_base.rotation));
  const Vec3 shift = m.world_from_base.translation_m - true_base.translation_m, light = m.light_in_tool_m - true_light;
  return {turn.x, turn.y, turn.z, shift.x, shift.y, shift.z, light.x, light.y, light.z};
}

TEST(LightHandEye, IsExactOnExactPositions) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const LightMounting m = calibrate_light(samples(seed, 8, 0, 0));
    for (const double e : error(m)) EXPECT_LT(std::abs(e), 1e-8) << seed;
    EXPECT_TRUE(m.unobservable.empty());
  }
}

TEST(LightHandEye, IntervalsCoverTheTruth) {
  int covered = 0, all = 0;
  double noise = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const LightMounting m = calibrate_light(samples(seed, 15, 0.002, 0.001));
    const auto e = error(m);
    for (std::size_t k = 0; k < 9; ++k) covered += std::abs(e[k]) <= 1.96 * m.sigma(k);
    all += 9;
    noise += m.robot_m / 100;
  }
  const double share = static_cast<double>(covered) / all;
  std::cout << "covered " << share << ", noise " << noise << "\n";
  EXPECT_GT(share, 0.92);
  EXPECT_LT(share, 0.98);
  EXPECT_NEAR(noise, 0.002, 0.0002);
}

// Positions known well in two directions and badly along a third, which is another one at every pose.
TEST(LightHandEye, CovariancesKeepTheIntervalsAndNarrowThem) {
  int covered = 0, all = 0;
  double with = 0, without = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    std::vector<LightSample> list = samples(seed, 15, 0.0005, 0), plain;
    Random random(seed, 4);
    for (LightSample& s : list) {
      const Mat3 turn = matrix_of(
          quaternion_of_rotation_vector({random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)}));
      const Vec3 sigma{0.0002, 0.0002, 0.006};
      s.position_m += turn * (Vec3{random.normal(), random.normal(), random.normal()} * sigma);
      s.covariance_m2 =
          turn * Mat3{{sigma.x * sigma.x, 0, 0, 0, sigma.y * sigma.y, 0, 0, 0, sigma.z * sigma.z}} * transposed(turn);
      const Mat3& m = *s.covariance_m2;
      s.sigma_m = {std::sqrt(m(0, 0)), std::sqrt(m(1, 1)), std::sqrt(m(2, 2))};
      plain.push_back(s);
      plain.back().covariance_m2.reset();
    }
    const LightMounting m = calibrate_light(list), p = calibrate_light(plain);
    const auto e = error(m), f = error(p);
    for (std::size_t k = 0; k < 9; ++k) covered += std::abs(e[k]) <= 1.96 * m.sigma(k);
    all += 9;
    for (std::size_t k = 6; k < 9; ++k) with += e[k] * e[k], without += f[k] * f[k];
  }
  const double share = static_cast<double>(covered) / all;
  std::cout << "covered " << share << ", errors with over without covariances " << std::sqrt(with / without) << "\n";
  // 540 intervals of 95 %, nine of a run alike: three standard deviations of the share, were all of them one.
  EXPECT_GT(share, 0.95 - 3 * 0.028);
  EXPECT_LT(with, 0.6 * without);
}

TEST(LightHandEye, ShiftsAloneLeaveTheLightOpen) {
  for (const double noise : {0.0, 0.001}) {
    const LightMounting m = calibrate_light(samples(5, 12, noise, noise, Motion::shifts));
    EXPECT_THAT(m.unobservable, Contains("translation of the light in the tool's frame, in every direction"));
    EXPECT_FALSE(m.light_known);
    EXPECT_FALSE(m.base_known);
  }
}

TEST(LightHandEye, OneAxisLeavesTheShiftAlongItOpen) {
  const LightMounting m = calibrate_light(samples(6, 12, 0.001, 0.001, Motion::one_axis));
  EXPECT_THAT(m.unobservable, Contains("translation of the light along the tool's z axis"));
  EXPECT_FALSE(m.light_known);
}

manifest::Document document_of(const std::vector<LightSample>& list) {
  manifest::Document d;
  for (const LightSample& s : list) {
    manifest::LightPosition p;
    p.id = s.id;
    p.light = "lamp";
    p.base_from_tool.emplace();
    static_cast<Rigid<frame::Base, frame::Tool>&>(*p.base_from_tool) = s.base_from_tool;
    p.position_m = {s.position_m.x, s.position_m.y, s.position_m.z};
    p.sigma_m = {s.sigma_m.x};
    d.light_positions.push_back(p);
  }
  return d;
}

TEST(LightHandEye, GoesThroughTheManifest) {
  manifest::Document d = document_of(samples(7, 10, 0.001, 0.001));
  std::string light;
  const auto list = light_samples(d, light, "");
  EXPECT_EQ(light, "lamp");
  const LightMounting m = calibrate_light(list);
  enter_light_mounting(m, light, "", d);
  const manifest::Mounting& entry = d.mountings.at("lamp");
  EXPECT_EQ(entry.kind, "light-in-hand");
  EXPECT_EQ(entry.light_in_tool_m.size(), 3U);
  EXPECT_TRUE(entry.world_from_base->sigma);
  EXPECT_THAT(light_page(m, list, light), HasSubstr("known within"));
  d.light_positions.resize(3);
  EXPECT_THROW(light_samples(d, light, ""), Error);
}

TEST(LightHandEye, TakesCovariancesOfTheManifestAndRefusesWhatIsNone) {
  manifest::Document d = document_of(samples(7, 10, 0.001, 0.001));
  std::string light;
  manifest::LightPosition& p = d.light_positions[3];
  p.sigma_m.clear(), p.covariance_m2 = {4e-6, 1e-6, 0, 1e-6, 9e-6, 0, 0, 0, 1e-6};
  const LightSample taken = light_samples(d, light, "").at(3);
  EXPECT_NEAR(taken.sigma_m.y, 0.003, 1e-12);
  EXPECT_EQ((*taken.covariance_m2)(0, 1), 1e-6);
  for (const std::vector<double>& bad : {std::vector<double>{1e-6, 0, 0},
                                         {4e-6, 1e-6, 0, 2e-6, 9e-6, 0, 0, 0, 1e-6},
                                         {1e-6, 2e-6, 0, 2e-6, 1e-6, 0, 0, 0, 1e-6}}) {
    p.covariance_m2 = bad;
    try {
      light_samples(d, light, "");
      FAIL() << "took " << bad.size() << " numbers";
    } catch (const Error& e) {
      EXPECT_THAT(e.what(), HasSubstr("/light_positions/3/covariance_m2"));
    }
  }
}

TEST(LightHandEye, LeavesOutWhatIsOpen) {
  manifest::Document d = document_of(samples(8, 10, 0.001, 0.001, Motion::shifts));
  std::string light;
  enter_light_mounting(calibrate_light(light_samples(d, light, "")), light, "", d);
  EXPECT_TRUE(d.mountings.at("lamp").light_in_tool_m.empty());
  EXPECT_FALSE(d.mountings.at("lamp").world_from_base);
  EXPECT_FALSE(d.mountings.at("lamp").unobservable.empty());
}

}  // namespace
}  // namespace gonio::robot
