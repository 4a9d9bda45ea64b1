// Patterns of views: how many, where they stand, what they look at.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "acquisition/plan/asked_steps.h"
#include "acquisition/plan/view_steps.h"
#include "base/error.h"
#include "geom/view_path.h"
#include "manifest/document.h"
#include "manifest/sections/image.h"
#include "manifest/sections/laboratory.h"

namespace gonio::acquisition {
namespace {

PatternScene scene_with_lamps(std::size_t lamps) {
  PatternScene scene;
  scene.target_m = {0.1, -0.2, 0.3};
  scene.camera = "cam";
  for (std::size_t k = 0; k < lamps; ++k) scene.lamps.push_back("lamp-" + std::to_string(k));
  scene.exposures_s = {0.01};
  scene.turntable = "table";
  return scene;
}

std::vector<manifest::PlanStep> made(const std::string& name, const PatternScene& scene, PatternNumbers given = {}) {
  const ViewPattern& pattern = find_view_pattern(name, "--pattern");
  return pattern.make(scene, pattern_numbers(pattern, given, "--pattern"));
}

// The optical axis of every step's camera meets the target.
void expect_looking(const std::vector<manifest::PlanStep>& steps, const PatternScene& scene) {
  for (const manifest::PlanStep& step : steps) {
    if (!step.world_from_camera) continue;
    const Vec3 seen = inverse(*step.world_from_camera) * scene.target_m;
    ASSERT_NEAR(seen.x, 0, 1e-12) << step.image;
    ASSERT_NEAR(seen.y, 0, 1e-12) << step.image;
    ASSERT_GT(seen.z, 0) << step.image;
  }
}

TEST(ViewPatterns, AllLookAtTheTargetAndNameEveryPictureOnce) {
  for (const ViewPattern* pattern : all_view_patterns()) {
    PatternScene scene = scene_with_lamps(11);
    for (const Vec3 up : {Vec3{0, 0, 1}, Vec3{0, 0, -1}, Vec3{0.6, 0, 0.8}}) {
      scene.up = up;
      const auto steps = made(pattern->name, scene);
      ASSERT_FALSE(steps.empty()) << pattern->name;
      expect_looking(steps, scene);
      std::set<std::string> images;
      for (const manifest::PlanStep& step : steps) {
        EXPECT_TRUE(images.insert(step.image).second) << step.image;
        EXPECT_EQ(step.camera, "cam");
        EXPECT_TRUE(step.joints_rad.empty());
      }
    }
    EXPECT_FALSE(pattern->sentence.empty());
    EXPECT_FALSE(pattern->source.empty());
  }
}

// 11 lamps and 7.5 degrees: 2,783 pictures of one material, which is what the acquisition that it copies states.
TEST(ViewPatterns, ArcMakesAsManyPicturesAsWerePublished) {
  const auto steps = made("arc", scene_with_lamps(11));
  EXPECT_EQ(steps.size(), 2783u);
  std::set<std::string> lamps;
  std::set<std::pair<long, long>> places;
  for (const manifest::PlanStep& step : steps) {
    ASSERT_EQ(step.lamps.size(), 1u);
    lamps.insert(step.lamps[0]);
    const Vec3 d = step.world_from_camera->translation_m - Vec3{0.1, -0.2, 0.3};
    EXPECT_NEAR(norm(d), 0.5, 1e-12);
    const double zenith = std::acos(d.z / norm(d)) / degree, azimuth = std::atan2(d.y, d.x) / degree;
    EXPECT_GT(zenith, 7.4);
    EXPECT_LT(zenith, 82.6);
    places.emplace(std::lround(zenith * 10), std::lround(std::abs(azimuth) * 10));
  }
  EXPECT_EQ(lamps.size(), 11u);
  EXPECT_EQ(places.size(), 253u);
  EXPECT_THROW(made("arc", scene_with_lamps(0)), Error);
}

TEST(ViewPatterns, HemisphereIsAGridFromThePoleDown) {
  const PatternScene scene = scene_with_lamps(1);
  // 8 rings of 36 from 10 to 80 degrees of elevation and the pole.
  EXPECT_EQ(made("hemisphere", scene).size(), 8u * 36 + 1);
  const auto even = made("hemisphere", scene, {{"even", 1}});
  EXPECT_LT(even.size(), 200u);
  double nearest = 10;
  for (std::size_t i = 0; i < even.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Vec3 a = even[i].world_from_camera->translation_m - scene.target_m,
                 b = even[j].world_from_camera->translation_m - scene.target_m;
      nearest = std::min(nearest, std::acos(std::min(1.0, dot(a, b) / norm(a) / norm(b))));
    }
  // Chords between azimuths a step of arc apart are a little shorter than the arc of their ring.
  EXPECT_GT(nearest, 9.2 * degree);
  const auto lit = made("hemisphere", scene, {{"lamp-radius", 0.4}, {"lamp-step", 30 * degree}});
  ASSERT_EQ(lit.size() % 289, 0u);
  for (const manifest::PlanStep& step : lit) {
    ASSERT_EQ(step.light_m.size(), 3u);
    const Vec3 d = Vec3{step.light_m[0], step.light_m[1], step.light_m[2]} - scene.target_m;
    EXPECT_NEAR(norm(d), 0.4, 1e-12);
    EXPECT_GE(d.z, 0.4 * std::sin(30 * degree) - 1e-12);
  }
}

// Over the pole the picture turns as little as beside it: the limit along azimuth 0.
TEST(ViewPatterns, ThePoleContinuesItsMeridian) {
  const PatternScene scene = scene_with_lamps(1);
  const auto at = camera_at(scene, {0, 0}, 0.5), beside = camera_at(scene, {1e-6, 0}, 0.5);
  EXPECT_LT(norm(rotation_vector_of(at.rotation * conjugate(beside.rotation))), 2e-6);
}

TEST(ViewPatterns, PathsAreThoseOfTheTracks) {
  PatternScene scene = scene_with_lamps(0);
  for (const std::string& path : view_path_names()) {
    const auto steps = made(path, scene, {{"views", 7}, {"distance", 0.8}});
    ASSERT_EQ(steps.size(), 7u);
    for (std::size_t f = 0; f < steps.size(); ++f) {
      const Vec3 place = scene.target_m + 0.8 * view_path(path, static_cast<double>(f) / 6);
      EXPECT_LT(norm(steps[f].world_from_camera->translation_m - place), 1e-12) << path;
    }
    const auto small = made(path, scene, {{"views", 7}, {"distance", 0.8}, {"spread", 0.5}});
    const Vec3 whole = steps[0].world_from_camera->translation_m - steps[6].world_from_camera->translation_m;
    const Vec3 half = small[0].world_from_camera->translation_m - small[6].world_from_camera->translation_m;
    EXPECT_LT(norm(whole * 0.5 - half), 1e-12) << path;
  }
}

// Tsai & Lenz's rules in numbers: the stations' turns are large and no axis is left out.
TEST(ViewPatterns, BoardViewsTurnAboutAllAxes) {
  const PatternScene scene = scene_with_lamps(1);
  const auto steps = made("board", scene, {{"views", 6}});
  double largest = 0;
  Vec3 sums{};
  for (std::size_t i = 0; i < steps.size(); ++i) {
    EXPECT_EQ(steps[i].purpose, "board");
    for (std::size_t j = 0; j < i; ++j) {
      const Vec3 turn =
          rotation_vector_of(steps[i].world_from_camera->rotation * conjugate(steps[j].world_from_camera->rotation));
      largest = std::max(largest, norm(turn));
      sums += turn * turn;
    }
  }
  EXPECT_GT(largest, 100 * degree);
  EXPECT_GT(std::min({sums.x, sums.y, sums.z}), 0.05 * max_component(sums));
  EXPECT_EQ(made("board", scene, {{"views", 200}}).size(), 200u);
}

TEST(ViewPatterns, BracketsDoubleAndTablesTurn) {
  const auto steps = made("hdr", scene_with_lamps(1));
  ASSERT_EQ(steps.size(), 1u);
  ASSERT_EQ(steps[0].exposures_s.size(), 12u);  // 11 stops between 1 and 2048 ms
  EXPECT_DOUBLE_EQ(steps[0].exposures_s.front(), 0.001);
  EXPECT_NEAR(steps[0].exposures_s.back(), 2.048, 1e-12);
  const auto turned = made("turntable", scene_with_lamps(0));
  EXPECT_EQ(turned.size(), 36u);
  EXPECT_NEAR(turned.back().turntable_rad.at("table"), 350 * degree, 1e-12);
  EXPECT_EQ(made("photometric", scene_with_lamps(5)).size(), 5u);
}

TEST(ViewPatterns, NumbersAreHeldToTheirBounds) {
  const ViewPattern& pattern = find_view_pattern("hemisphere", "--pattern");
  EXPECT_THROW(pattern_numbers(pattern, {{"stepp", 1}}, "--set"), Error);
  EXPECT_THROW(pattern_numbers(pattern, {{"step", 0}}, "--set"), Error);
  EXPECT_THROW(find_view_pattern("spiral", "--pattern"), Error);
  for (const ViewPattern* each : all_view_patterns())
    for (const PatternParameter& p : each->parameters) {
      EXPECT_GE(p.preset, p.lower) << each->name << " " << p.name;
      EXPECT_LE(p.preset, p.upper) << each->name << " " << p.name;
    }
}

TEST(AskedSteps, PairsOfDirectionsStandWhereTheirAnglesSay) {
  const PatternScene scene = scene_with_lamps(1);
  const auto pairs =
      read_pairs("sigma_ln,theta_i_rad,phi_i_rad,theta_o_rad,phi_o_rad\n0.1,0.5,0,0.25,3.0\n", "plan.csv");
  ASSERT_EQ(pairs.size(), 1u);
  const auto steps = pair_steps(scene, pairs, {0.6, 0.4});
  ASSERT_EQ(steps.size(), 1u);
  const Vec3 eye = steps[0].world_from_camera->translation_m - scene.target_m;
  EXPECT_NEAR(eye.z, 0.6 * std::cos(0.25), 1e-12);
  EXPECT_NEAR(steps[0].light_m[0] - scene.target_m.x, 0.4 * std::sin(0.5), 1e-12);
  EXPECT_THROW(read_pairs("theta_i_rad,phi_i_rad\n1,2\n", "plan.csv"), Error);
  EXPECT_THROW(read_pairs("theta_i_rad,phi_i_rad,theta_o_rad,phi_o_rad\n1,2,x,4\n", "plan.csv"), Error);
}

TEST(AskedSteps, TakeUpWhatExplainProposes) {
  manifest::Document document;
  manifest::ImageEntry image;
  image.id = "a", image.camera = "cam", image.board = "charuco", image.exposure_s = 0.02;
  image.world_from_camera.emplace();
  image.world_from_camera->translation_m = {0, 0, 1};
  image.camera_from_board.emplace();
  image.camera_from_board->translation_m = {0.1, 0, 0.5};
  document.images.push_back(image);
  const auto plan = [](const std::string& setup) {
    return "{\"sentence\": \"s\", \"setup\": " + setup + ", \"separates\": [], \"z\": 3}";
  };
  document.explanations.push_back(manifest::parse_json(
      R"({"domain": "boards", "verdict": "named", "next_measurement": {"sentence": "", "plan": [)" +
          plan(R"({"images": [{"camera": "cam", "board": "charuco", "camera_from_board":
                   {"rotation": [1, 0, 0, 0], "translation_m": [0, 0, 0.25]}}]})") +
          "," + plan(R"({"image": "a", "exposure_scale": 4})") + "," + plan(R"({"image": "a", "light": []})") + "," +
          plan(R"({"image": "a", "light_towards": [0, 3, 4]})") + "," + plan(R"({"distance_m": 2})") + "," +
          plan(R"({"image": "a", "light": ["l"], "light_towards": [0, 0, 1], "light_position_m": [0.1, 0.2, 0.7]})") +
          "]}}",
      "explanations"));
  const PatternScene scene = scene_with_lamps(1);
  const AskedSteps asked = next_steps(document, scene, {.lamp_m = 2});
  ASSERT_EQ(asked.steps.size(), 5u);
  // The board lies at (0.1, 0, 1.5): the camera is to stand 0.25 m before it.
  EXPECT_LT(norm(asked.steps[0].world_from_camera->translation_m - Vec3{0.1, 0, 1.25}), 1e-12);
  EXPECT_DOUBLE_EQ(asked.steps[1].exposures_s.at(0), 0.08);
  EXPECT_EQ(asked.steps[2].purpose, "dark");
  EXPECT_TRUE(asked.steps[2].lamps.empty());
  ASSERT_EQ(asked.steps[3].light_m.size(), 3u);  // two metres away in the direction that was asked
  EXPECT_NEAR(asked.steps[3].light_m[1] - scene.target_m.y, 1.2, 1e-12);
  EXPECT_NEAR(asked.steps[3].light_m[2] - scene.target_m.z, 1.6, 1e-12);
  EXPECT_EQ(asked.steps[4].light_m, (std::vector<double>{0.1, 0.2, 0.7}));  // a place goes before a direction
  ASSERT_EQ(asked.left.size(), 1u);
}

}  // namespace
}  // namespace gonio::acquisition
