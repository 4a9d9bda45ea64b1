// The laboratory that a manifest describes: arms, limits, solids, places, and what is refused.
#include "acquisition/laboratory/laboratory.h"

#include <gmock/gmock.h>

#include "acquisition/laboratories.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "base/random.h"
#include "data.h"
#include "manifest/sections/laboratory.h"

namespace gonio::acquisition {
namespace {

using ::testing::HasSubstr;

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  if (at != std::string::npos) text.replace(at, from.size(), to);
  return text;
}

std::string complaint(const std::string& text) {
  try {
    believed_laboratory(tests::laboratory_document(text));
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::data) << e.what();
    return e.what();
  }
  return "no complaint";
}

TEST(Laboratory, ArmsOfAllThreeInstrumentsAreWithinTheirLimitsAtHome) {
  for (const std::string& text : {tests::two_ur5_text(), tests::abb_and_arc_text(), tests::ur3_and_turntable_text()}) {
    const Laboratory laboratory = believed_laboratory(tests::laboratory_document(text));
    EXPECT_FALSE(laboratory.arms.empty());
    for (const auto& [name, arm] : laboratory.arms) {
      EXPECT_EQ(broken_limit(arm, arm.home), "");
      EXPECT_EQ(arm.limits.size(), 6u);
      EXPECT_GT(arm.solids.size(), 8u);
    }
  }
}

TEST(Laboratory, CablesTightenJointRanges) {
  const Laboratory laboratory = believed_laboratory(tests::laboratory_document(tests::two_ur5_text()));
  const LaboratoryArm& arm = laboratory.arms.at("camera-arm");
  EXPECT_DOUBLE_EQ(arm.limits[0].upper_rad, 3.5);            // the cable's
  EXPECT_DOUBLE_EQ(arm.limits[1].lower_rad, -1.5708 - 2.8);  // likewise
  EXPECT_DOUBLE_EQ(arm.limits[2].upper_rad, 2.8);            // the joint's would be pi
  Joints joints = arm.home;
  joints[3] = 3;
  EXPECT_EQ(broken_limit(arm, joints), "joint 4 at 171.9 deg, limit 110.5 deg");
  joints[3] = -1.5708 + 3.5;
  EXPECT_EQ(broken_limit(arm, joints), "");
  EXPECT_EQ(broken_limit(arm, {0, 0}), "2 joint angles, limit 6");
}

TEST(Laboratory, WhatIsHeldMovesWithTheFlange) {
  const manifest::Document document = tests::laboratory_document(tests::two_ur5_text());
  const Laboratory laboratory = believed_laboratory(document);
  const LaboratoryArm& arm = laboratory.arms.at("camera-arm");
  const Joints joints{0.3, -1.2, 1.1, -2, -1.4, 0.7};
  const auto flange = world_from_tool(arm, joints);
  const auto camera = world_from_camera(document, laboratory, "eye", {{"camera-arm", joints}});
  EXPECT_NEAR(norm(camera.translation_m - flange * Vec3{0, 0, 0.1}), 0, 1e-12);
  // The base is turned by half a turn about z and stands at 0.38, 0, 0.1.
  const Vec3 in_base = robot::flange(arm.links, joints).translation_m;
  EXPECT_NEAR(norm(flange.translation_m - Vec3{0.38 - in_base.x, -in_base.y, in_base.z + 0.1}), 0, 1e-12);
  // An arm that is not named stands at home.
  const LaboratoryArm& light = laboratory.arms.at("light-arm");
  EXPECT_NEAR(
      norm(lamp_position(document, laboratory, "led", {}) - world_from_tool(light, light.home) * Vec3{0, 0, 0.052}), 0,
      1e-12);
}

TEST(Laboratory, StandingLampsStandWhereTheirLightDoes) {
  const std::string text = R"({"gonio": 1, "lights": {"sun": {"model": "point", "position_m": [1, 2, 3],
      "watt_per_sr": 1}}, "laboratory": {"lamps": {"a": {"light": "sun"}, "b": {}, "c": {"in_world_m": [3, 2, 1]}}}})";
  const manifest::Document document = tests::laboratory_document(text);
  const Laboratory laboratory = believed_laboratory(document);
  EXPECT_EQ(lamp_position(document, laboratory, "a", {}), (Vec3{1, 2, 3}));
  EXPECT_EQ(lamp_position(document, laboratory, "c", {}), (Vec3{3, 2, 1}));
  EXPECT_THROW(lamp_position(document, laboratory, "b", {}), Error);
  EXPECT_THROW(lamp_position(document, laboratory, "d", {}), Error);
}

TEST(Laboratory, RefusesWhatCannotBe) {
  const std::string good = tests::two_ur5_text();
  EXPECT_THAT(complaint(R"({"gonio": 1})"), HasSubstr("/laboratory: is missing"));
  EXPECT_THAT(complaint(replaced(good, "\"ur5\"", "\"ur6\"")), HasSubstr("camera-arm/model: \"ur6\" is no known arm"));
  EXPECT_THAT(complaint(replaced(good, "[0, -1.9, 1.9, -1.6, -1.5708, 0]", "[0, 3, 0, 0, 0, 0]")),
              HasSubstr("camera-arm/home_rad: joint 2 at 171.9 deg, limit 70.4 deg"));
  EXPECT_THAT(complaint(replaced(good, "[0, -1.9, 1.9, -1.6, -1.5708, 0]", "[0, 3]")),
              HasSubstr("camera-arm/home_rad: has 2 numbers, the arm 6 joints"));
  EXPECT_THAT(complaint(replaced(good, "\"free_rad\": [0,", "\"free_rad\": [11,")),
              HasSubstr("camera-arm/cable: joint 1 may turn from 7.5 to"));
  EXPECT_THAT(complaint(replaced(good, "\"box_m\": [0.06, 0.06, 0.09]", "\"ball_m\": 1, \"box_m\": [1, 1, 1]")),
              HasSubstr("camera-arm/carries/0: needs exactly one of"));
  EXPECT_THAT(complaint(replaced(good, "\"upper_m\": [1.2, 1.2, 1.3]", "\"upper_m\": [1.2, -1.2, 1.3]")),
              HasSubstr("limits: lower_m is not below upper_m"));
  const std::string rows = R"({"a_m": 0.1, "d_m": 0.1, "alpha_rad": 0, "theta_rad": 0})";
  EXPECT_THAT(complaint(R"({"gonio": 1, "laboratory": {"robots": {"r": {"model": "dh", "dh": [)" + rows + "]}}}}"),
              HasSubstr("joint 1 has no limit of speed and acceleration"));
}

TEST(Laboratory, LinksAreTakenFromTheSection) {
  const std::string text = R"({"gonio": 1, "laboratory": {"robots": {"r": {"model": "dh", "home_rad": [0.2],
      "dh": [{"a_m": 0.5, "d_m": 0.1, "alpha_rad": 1.5, "theta_rad": 0.3}],
      "limits": {"lower_rad": [-1], "upper_rad": [1], "speed_rad_per_s": [1], "acceleration_rad_per_s2": [1]},
      "links": [{"name": "link-1-tube", "box_m": [0.5, 0.1, 0.1], "base_from_body":
        {"rotation": [1, 0, 0, 0], "translation_m": [0.3, 0, 0.1]}}]}}}})";
  const Laboratory laboratory = believed_laboratory(tests::laboratory_document(text));
  const Solid& tube = laboratory.arms.at("r").solids.at(0);
  EXPECT_EQ(tube.name, "r/link-1-tube");
  EXPECT_EQ(tube.link, 1);
  // Given in the base with the joint at zero, it is back there when the joint is.
  const auto frame = robot::link_frames(laboratory.arms.at("r").links, Joints{0.0})[1];
  EXPECT_NEAR(norm(frame.rotation * tube.placed.translation_m + frame.origin_m - Vec3{0.3, 0, 0.1}), 0, 1e-12);
  EXPECT_THAT(complaint(replaced(text, "link-1-tube", "link-2")), HasSubstr("\"link-2\" names no link"));
  EXPECT_THAT(complaint(replaced(text, "link-1-tube", "tube")), HasSubstr("\"tube\" names no link"));
}

// Two joints: a turntable about z, an arm about y that begins 0.3 m above it and ends 0.5 m further along x.
TEST(Laboratory, ArmsComeFromTheirUrdf) {
  const tests::ScratchFolder folder;
  write_file(folder / "arm.urdf", R"(<robot name="two">
    <link name="base"><collision><origin xyz="0 0 0.05"/>
      <geometry><box size="0.2 0.2 0.1"/></geometry></collision></link>
    <link name="turn"/>
    <link name="arm"><collision><origin xyz="0.25 0 0" rpy="0 1.5707963267948966 0"/>
      <geometry><cylinder radius="0.04" length="0.5"/></geometry></collision></link>
    <link name="tip"/>
    <joint name="one" type="revolute"><parent link="base"/><child link="turn"/><axis xyz="0 0 1"/>
      <limit lower="-2" upper="2" velocity="1" effort="1"/></joint>
    <joint name="two" type="revolute"><parent link="turn"/><child link="arm"/><origin xyz="0 0 0.3"/>
      <axis xyz="0 1 0"/><limit lower="-1" upper="1" velocity="1" effort="1"/></joint>
    <joint name="end" type="fixed"><parent link="arm"/><child link="tip"/><origin xyz="0.5 0 0"/></joint></robot>)");
  manifest::Document document = manifest::parse_document(R"({"gonio": 1, "laboratory": {}})", "m.json", folder.path());
  const std::string file = manifest::add_file(document, folder / "arm.urdf", "urdf");
  manifest::LaboratoryRobot robot;
  robot.model = "urdf";
  robot.urdf = file;
  robot.home_rad = {0.2, 0.1};
  EXPECT_THROW(
      {
        document.laboratory.entry.front().robots["r"] = robot;
        believed_laboratory(document);
      },
      Error);  // a URDF knows no accelerations
  robot.limits.emplace();
  robot.limits->acceleration_rad_per_s2 = {2, 2};
  document.laboratory.entry.front().robots["r"] = robot;
  const LaboratoryArm arm = believed_laboratory(document).arms.at("r");
  EXPECT_DOUBLE_EQ(arm.limits[1].upper_rad, 1);
  for (const Joints& q : {Joints{0, 0}, Joints{0.7, -0.4}, Joints{-1.2, 0.9}}) {
    const Vec3 tip = world_from_tool(arm, q).translation_m;
    const double reach = 0.5 * std::cos(q[1]);
    EXPECT_NEAR(norm(tip - Vec3{reach * std::cos(q[0]), reach * std::sin(q[0]), 0.3 - 0.5 * std::sin(q[1])}), 0, 1e-9);
    const auto wanted = wanted_of_links(arm, world_from_tool(arm, q));
    EXPECT_NEAR(norm(wanted.translation_m - robot::flange(arm.links, q).translation_m), 0, 1e-9);
    // The middle of the arm's cylinder lies half way out.
    ASSERT_EQ(arm.solids.size(), 2u);
    const Solid& tube = arm.solids[1];
    const auto frame = robot::link_frames(arm.links, q)[static_cast<std::size_t>(tube.link)];
    const Vec3 middle = arm.world_from_base * (frame.rotation * tube.placed.translation_m + frame.origin_m);
    EXPECT_NEAR(norm(middle - (tip + Vec3{0, 0, 0.3}) / 2), 0, 1e-9);
  }
}

}  // namespace
}  // namespace gonio::acquisition
