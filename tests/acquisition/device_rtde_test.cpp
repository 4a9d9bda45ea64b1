// RTDE packets: bytes that others wrote down, recipes of the maker's own client, and every way of being cut or bent.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "acquisition/desk/ur_controller.h"
#include "acquisition/device/rtde_client.h"
#include "acquisition/device/urscript.h"
#include "base/error.h"
#include "data.h"
#include "desk_world.h"

using namespace gonio;
using namespace gonio::acquisition;
using gonio::acquisition::desk::Fault;
using gonio::tests::DeskWorld;

namespace {

std::string bytes_of(std::initializer_list<int> values) {
  std::string bytes;
  for (const int value : values) bytes += static_cast<char>(value);
  return bytes;
}

std::string payload_of(const std::string& packet, char type) {
  const RtdeHead head = rtde_head(packet.substr(0, 3));
  EXPECT_EQ(head.type, type);
  if (head.payload_bytes != packet.size() - 3) throw RtdeRefused("the packet is not as long as it says");
  return packet.substr(3);
}

// Packets in the tests of Universal Robots' own client library (tests/test_rtde_parser.cpp of
// Universal_Robots_Client_Library, Apache-2.0), with what they are said to mean there.
TEST(DeviceRtde, ReadsTheMakersPackets) {
  EXPECT_TRUE(rtde_accepted(payload_of(bytes_of({0, 4, 0x56, 1}), 'V')));
  EXPECT_EQ(rtde_version(payload_of(bytes_of({0, 0x13, 0x76, 0, 0, 0, 5, 0, 0, 0, 8, 0, 0, 0, 0, 0, 0, 0, 0}), 'v')),
            "5.8.0.0");
  EXPECT_TRUE(rtde_accepted(payload_of(bytes_of({0, 4, 0x50, 1}), 'P')));
  EXPECT_TRUE(rtde_accepted(payload_of(bytes_of({0, 4, 0x53, 1}), 'S')));
  const auto recipe = rtde_recipe(std::string("\1DOUBLE,DOUBLE", 14), {"timestamp", "target_speed_fraction"});
  const auto fields = rtde_fields(
      payload_of(
          bytes_of({0, 0x14, 0x55, 1, 0x40, 0xd0, 7, 0x0d, 0x2f, 0x1a, 0x9f, 0xbe, 0x3f, 0xf0, 0, 0, 0, 0, 0, 0}), 'U'),
      recipe);
  EXPECT_FLOAT_EQ(static_cast<float>(fields.at("timestamp").at(0)), 16412.2f);
  EXPECT_EQ(fields.at("target_speed_fraction").at(0), 1);
  // Theirs of a recipe's answer says 17 bytes and has 19: we refuse what is not as long as it says, and read the rest.
  const auto outputs = bytes_of(
      {0, 0x11, 0x4f, 1, 0x44, 0x4f, 0x55, 0x42, 0x4c, 0x45, 0x2c, 0x56, 0x45, 0x43, 0x54, 0x4f, 0x52, 0x36, 0x44});
  EXPECT_THROW(payload_of(outputs, 'O'), RtdeRefused);
  EXPECT_EQ(rtde_recipe(outputs.substr(3), {"timestamp", "actual_q"}).data_bytes, 1u + 8 + 48);
}

TEST(DeviceRtde, RefusesWhatIsNotAsItsRecipeSays) {
  EXPECT_THROW(rtde_head(bytes_of({0, 2, 'U'})), RtdeRefused);
  EXPECT_THROW(rtde_head("U"), RtdeRefused);
  EXPECT_THROW(rtde_accepted(""), RtdeRefused);
  EXPECT_THROW(rtde_version("12345"), RtdeRefused);
  EXPECT_THROW(rtde_text(bytes_of({5, 'a'})), RtdeRefused);
  EXPECT_EQ(rtde_text(bytes_of({2, 'n', 'o', 4, 'R', 'T', 'D', 'E', 1})), "RTDE: no");
  EXPECT_THROW(rtde_recipe(std::string("\1DOUBLE", 7), {"timestamp", "actual_q"}), RtdeRefused);
  try {
    rtde_recipe(std::string("\0DOUBLE,NOT_FOUND", 17), {"timestamp", "actual_r"});
    ADD_FAILURE();
  } catch (const RtdeRefused& refused) {
    EXPECT_THAT(refused.what(), testing::HasSubstr("has no actual_r (NOT_FOUND)"));
  }
  const auto names = rtde_names(24);
  const auto recipe = rtde_recipe("\1" + desk::rtde_types(names), names);
  desk::ArmSnapshot arm;
  arm.joints_rad = {0, 0, -1.25, 0, 0, 0};
  arm.output_registers[24] = -7;
  const std::string data = "\1" + desk::rtde_data_bytes(arm, names);
  const RtdeState state = rtde_state(rtde_fields(data, recipe), 24);
  EXPECT_EQ(state.joints_rad[2], -1.25);
  EXPECT_EQ(state.program, -7);
  EXPECT_EQ(state.robot_mode, 7);
  for (std::size_t cut = 0; cut < data.size(); ++cut)
    EXPECT_THROW(rtde_fields(data.substr(0, cut), recipe), RtdeRefused) << cut;
  EXPECT_THROW(rtde_fields(data + "x", recipe), RtdeRefused);
  EXPECT_THROW(rtde_fields("\2" + data.substr(1), recipe), RtdeRefused);
  arm.joints_rad[2] = std::nan("");
  EXPECT_THROW(rtde_state(rtde_fields("\1" + desk::rtde_data_bytes(arm, names), recipe), 24), RtdeRefused);
}

// The fields that we ask for are in the maker's own list, and so are those that the simulated controller has.
TEST(DeviceRtde, AsksForFieldsThatControllersHave) {
  GONIO_NEEDS_DATA("robots/ur_rtde/exhaustive_rtde_output_recipe.txt");
  std::ifstream list(tests::data("robots/ur_rtde/exhaustive_rtde_output_recipe.txt"));
  std::set<std::string> known;
  for (std::string name; std::getline(list, name);) known.insert(name);
  ASSERT_GT(known.size(), 200u);
  for (const int program_register : {0, 24, 47})
    for (const auto& name : rtde_names(program_register)) EXPECT_TRUE(known.contains(name)) << name;
  int held = 0;
  for (const auto& name : known) held += desk::rtde_types({name}) != "NOT_FOUND";
  EXPECT_GE(held, 48 + 11);
}

TEST(DeviceRtde, ScriptsKeepEveryJointWithinItsLimits) {
  Random random(4);
  for (int round = 0; round < 200; ++round) {
    std::vector<std::vector<double>> way(2, std::vector<double>(6));
    std::vector<double> speeds(6), accelerations(6);
    for (std::size_t i = 0; i < 6; ++i) {
      way[0][i] = random.uniform(-3, 3);
      way[1][i] = random.uniform(-3, 3);
      speeds[i] = random.uniform(0.1, 3);
      accelerations[i] = random.uniform(0.1, 9);
    }
    const LeadingAxis leading = leading_axis(way[0], way[1], speeds, accelerations);
    double longest = 0, fullest = 0;
    for (std::size_t i = 0; i < 6; ++i) longest = std::max(longest, std::abs(way[1][i] - way[0][i]));
    for (std::size_t i = 0; i < 6; ++i) {
      const double share = std::abs(way[1][i] - way[0][i]) / longest;
      EXPECT_LE(leading.speed_rad_per_s * share, speeds[i] * (1 + 1e-12));
      EXPECT_LE(leading.acceleration_rad_per_s2 * share, accelerations[i] * (1 + 1e-12));
      fullest = std::max(fullest, leading.speed_rad_per_s * share / speeds[i]);
    }
    EXPECT_NEAR(fullest, 1, 1e-12);  // and no slower than that
    const auto steps = desk::steps_of_script(motion_script({round + 1, 24, -5}, way, speeds, accelerations));
    ASSERT_EQ(steps.size(), 4u);
    EXPECT_EQ(steps[0].kind, desk::ArmStep::Kind::only_if);
    EXPECT_EQ(steps[0].value, -5);
    EXPECT_EQ(steps[1].value, 2 * (round + 1));
    EXPECT_EQ(steps[3].value, 2 * (round + 1) + 1);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(steps[2].target_rad[i], way[1][i], 1e-12);
    EXPECT_NEAR(steps[2].speed, leading.speed_rad_per_s, 1e-9);
  }
}

// A motion that was given up and stopped, and whose program comes after the one that stopped it.
TEST(DeviceRtde, ALateProgramMovesNothing) {
  DeskWorld world;
  const auto start = tests::joints_of(world.arm.now());
  std::vector<std::vector<double>> way{start, start};
  way[1][0] += 0.5;
  const auto late = desk::steps_of_script(motion_script({5, 24, 0}, way, tests::kSpeeds, tests::kAccelerations));
  world.arm.run(desk::steps_of_script(stop_script({6, 24}, 2)));
  world.arm.run(late);
  EXPECT_EQ(world.arm.now().output_registers[24], 13);
  EXPECT_FALSE(world.arm.now().program_running);
  EXPECT_EQ(tests::joints_of(world.arm.now()), start);
  const auto due = desk::steps_of_script(motion_script({7, 24, 13}, way, tests::kSpeeds, tests::kAccelerations));
  world.arm.run(due);
  EXPECT_EQ(world.arm.now().output_registers[24] / 2, 7);
}

// The simulated arm's trapezoid: its speed is the derivative of its way, within its limits, from rest to rest.
TEST(DeviceRtde, TheTrueArmMovesWithinItsLimits) {
  for (const desk::Trapezoid profile :
       {desk::Trapezoid{2, 1, 2}, desk::Trapezoid{0.1, 1, 2}, desk::Trapezoid{1e-6, 3, 1}}) {
    const double whole = profile.duration(), h = whole * 1e-5;
    EXPECT_EQ(profile.gone(0), 0);
    EXPECT_EQ(profile.gone(whole), profile.distance);
    EXPECT_EQ(profile.speed_at(whole), 0);
    for (double t = whole / 200; t < whole; t += whole / 100) {
      EXPECT_NEAR((profile.gone(t + h) - profile.gone(t - h)) / (2 * h), profile.speed_at(t), 1e-4 * profile.speed);
      EXPECT_LE(profile.speed_at(t), profile.speed * (1 + 1e-12));
      EXPECT_LE(std::abs(profile.speed_at(t + h) - profile.speed_at(t)) / h, profile.acceleration * (1 + 1e-6));
    }
  }
}

// A state that is believed is one that the arm had after it was asked for.
TEST(DeviceRtde, FaultsNeverGiveAStaleState) {
  DeskWorld world(100, 13);
  for (const auto kind : {Fault::rtde_dropped, Fault::rtde_reordered, Fault::rtde_short, Fault::rtde_reset})
    world.faults.set(kind, 0.05);
  RtdeClient client({"127.0.0.1", world.controller.rtde_port(), 24, 1, 125}, "here");
  int seen = 0, refused = 0;
  for (int k = 0; k < 300; ++k) {
    desk::JointAngles target{0.1 * (k % 7), -1, 1, -1, -1, 0.1 * (k % 5)};
    world.arm.run({{desk::ArmStep::Kind::mark, 24, k}, {desk::ArmStep::Kind::move, 0, 0, target, 20, 400}});
    const double asked = world.arm.now().time_s;
    try {
      const RtdeState state = client.fresh();
      EXPECT_GE(state.time_s, asked);
      EXPECT_LE(state.time_s, world.arm.now().time_s);
      EXPECT_EQ(state.program, k);
      ++seen;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Exit::unavailable);
      ++refused;
    }
  }
  EXPECT_GT(seen, 250);
  EXPECT_GT(client.reconnections(), 20);
  EXPECT_EQ(client.controller_version(), "5.9.4.1");
}

TEST(DeviceRtde, AControllerThatLacksAFieldSaysWhich) {
  DeskWorld world;
  try {
    RtdeClient({"127.0.0.1", world.controller.rtde_port(), 99, 0.5, 125}, "here").fresh();
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("the controller's RTDE has no output_int_register_99 (NOT_FOUND)"));
  }
}

}  // namespace
