// The driver of Universal Robots' arms against the simulated controller: what it says of the arm is so, or it says that
// it does not know.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "base/error.h"
#include "desk_world.h"

using namespace gonio;
using namespace gonio::acquisition;
using gonio::acquisition::desk::Fault;
using gonio::tests::DeskWorld;

namespace {

using Way = std::vector<std::vector<double>>;

std::string problem_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Exit::unavailable) << error.what();
    return error.what();
  }
  return "no error";
}

TEST(DeviceRobot, StateIsTheArms) {
  DeskWorld world;
  const auto robot = open_robot(world.robot_url(), "here");
  const RobotState state = robot->state();
  EXPECT_EQ(state.joints_rad, tests::joints_of(world.arm.now()));
  EXPECT_TRUE(state.powered && state.standing && state.remote_control);
  EXPECT_FALSE(state.protective_stop || state.emergency_stop);
  EXPECT_EQ(state.mode, "RUNNING");
  ASSERT_TRUE(state.base_from_tool);
  EXPECT_NEAR(state.base_from_tool->translation_m.x, 0.31, 1e-12);
  EXPECT_NEAR(rotation_vector_of(state.base_from_tool->rotation).z, 0.2, 1e-12);
  EXPECT_NEAR(state.temperature_K.at(0), 273.15 + world.arm.now().temperature_C[0], 0.5);
  EXPECT_LE(state.time_s, world.arm.now().time_s);
}

TEST(DeviceRobot, GoesThroughAWayAndStandsAtItsEnd) {
  DeskWorld world;
  const auto robot = open_robot(world.robot_url(), "here");
  const auto start = tests::joints_of(world.arm.now());
  Way way{start};
  for (int k = 1; k <= 3; ++k) {
    way.push_back(way.back());
    way.back()[k] += 0.3;
    way.back()[5] -= 4 * (k == 3);  // beyond zero: turns are counted
  }
  const RobotState state = robot->move(way, tests::kSpeeds, tests::kAccelerations);
  EXPECT_LE(tests::farthest(state.joints_rad, way.back()), 1e-4);
  EXPECT_LE(tests::farthest(tests::joints_of(world.arm.now()), way.back()), 1e-9);
  EXPECT_TRUE(state.standing);
  EXPECT_EQ(world.arm.programs(), 1);
  std::reverse(way.begin(), way.end());
  EXPECT_LE(tests::farthest(robot->move(way, tests::kSpeeds, tests::kAccelerations).joints_rad, start), 1e-4);
  EXPECT_EQ(world.arm.programs(), 2);
  // Where it is already.
  EXPECT_LE(tests::farthest(robot->move(Way{start, start}, tests::kSpeeds, tests::kAccelerations).joints_rad, start),
            1e-4);
}

TEST(DeviceRobot, DoesNotMoveWhereItMayNot) {
  DeskWorld world;
  const auto robot = open_robot(world.robot_url("&begin=2s"), "here");
  const auto start = tests::joints_of(world.arm.now());
  Way way{start, start};
  way[1][0] += 0.2;
  const auto moves = [&](const Way& asked) {
    return problem_of([&] { robot->move(asked, tests::kSpeeds, tests::kAccelerations); });
  };
  Way elsewhere{way[1], start};
  EXPECT_THAT(moves(elsewhere), testing::HasSubstr("is not where the way begins: joint 1 stands at 0.100000 rad"));
  world.arm.set_remote_control(false);
  EXPECT_THAT(moves(way), testing::HasSubstr("is not in remote control"));
  world.arm.set_remote_control(true);
  world.arm.set_powered(false);
  EXPECT_THAT(moves(way), testing::HasSubstr("robot mode POWER_OFF"));
  world.arm.set_powered(true);
  world.arm.protective_stop();
  EXPECT_THAT(moves(way), testing::HasSubstr("safety mode PROTECTIVE_STOP"));
  EXPECT_TRUE(robot->state().protective_stop);
  EXPECT_EQ(robot->state().mode, "RUNNING, PROTECTIVE_STOP");
  world.arm.clear_stops();
  world.arm.emergency_stop();
  EXPECT_THAT(moves(way), testing::HasSubstr("safety mode ROBOT_EMERGENCY_STOP"));
  EXPECT_TRUE(robot->state().emergency_stop);
  world.arm.clear_stops();
  world.arm.run({{desk::ArmStep::Kind::move, 0, 0, {0.1, -1.2, 1.3, -1.5, -1.6, 6.0}, 1e-3, 1}});  // somebody else's
  EXPECT_THAT(moves(way), testing::HasSubstr("another program runs on it"));
  EXPECT_EQ(world.arm.programs(), 1);
  EXPECT_THROW(robot->move(Way{}, tests::kSpeeds, tests::kAccelerations), Error);
  EXPECT_THROW(robot->move(Way{start, {1, 2}}, tests::kSpeeds, tests::kAccelerations), Error);
}

// Without a dashboard to ask, an arm that obeys its pendant shows by not beginning.
TEST(DeviceRobot, AProgramThatDoesNotBeginIsNoticed) {
  DeskWorld world;
  world.arm.set_remote_control(false);
  const auto robot = open_robot(world.host() + "?rtde=" + std::to_string(world.controller.rtde_port()) + "&script=" +
                                    std::to_string(world.controller.script_port()) + "&dashboard=none&begin=50ms",
                                "here");
  const auto start = tests::joints_of(world.arm.now());
  Way way{start, start};
  way[1][0] += 0.2;
  EXPECT_THAT(problem_of([&] { robot->move(way, tests::kSpeeds, tests::kAccelerations); }),
              testing::HasSubstr("did not begin its program within 0.05 s"));
}

TEST(DeviceRobot, AProtectiveStopOnTheWaySaysWhere) {
  DeskWorld world;
  const auto robot = open_robot(world.robot_url("&begin=2s"), "here");
  const auto start = tests::joints_of(world.arm.now());
  Way way{start, start};
  way[1][0] += 1;
  world.faults.set(Fault::protective_stop, 1);
  const std::string stopped = problem_of([&] { robot->move(way, tests::kSpeeds, tests::kAccelerations); });
  EXPECT_THAT(stopped, testing::HasSubstr("stopped on its way: safety mode PROTECTIVE_STOP; joint 1 stands at"));
  EXPECT_GT(tests::farthest(tests::joints_of(world.arm.now()), way[1]), 1e-4);
  world.arm.clear_stops();
  world.faults.set(Fault::protective_stop, 0);
  // On it goes from where it stands. The program that was to stop it may come only now and stop this motion too: an
  // error, and asked once more it goes.
  RobotState end;
  for (int tries = 3; end.joints_rad.empty() && tries > 0; --tries) {
    const std::string again = problem_of([&] {
      way[0] = robot->state().joints_rad;
      end = robot->move(way, tests::kSpeeds, tests::kAccelerations);
    });
    if (end.joints_rad.empty()) {
      EXPECT_THAT(again, testing::HasSubstr("program"));
    }
  }
  EXPECT_LE(tests::farthest(end.joints_rad, way[1]), 1e-4);
}

TEST(DeviceRobot, ATargetBeyondTheRangeIsNotReached) {
  DeskWorld world;
  const auto robot = open_robot(world.robot_url("&begin=2s"), "here");
  const auto start = tests::joints_of(world.arm.now());
  world.faults.set(Fault::joint_limit, 1);
  Way way{start, start};
  way[1][2] += 0.1;
  EXPECT_THAT(problem_of([&] { robot->move(way, tests::kSpeeds, tests::kAccelerations); }),
              testing::HasSubstr("PROTECTIVE_STOP"));
}

TEST(DeviceRobot, StopsFromAnotherThread) {
  DeskWorld world(5);  // the way takes 3 s of the arm's time, 0.6 s of ours
  const auto robot = open_robot(world.robot_url(), "here");
  const auto start = tests::joints_of(world.arm.now());
  Way way{start, start};
  way[1][0] += 2.5;
  std::string moved;
  std::thread mover([&] { moved = problem_of([&] { robot->move(way, tests::kSpeeds, tests::kAccelerations); }); });
  while (world.arm.now().speed_rad_per_s[0] == 0) std::this_thread::yield();
  robot->stop();
  const auto here = tests::joints_of(world.arm.now());
  EXPECT_EQ(world.arm.now().speed_rad_per_s[0], 0);
  mover.join();
  EXPECT_THAT(moved, testing::HasSubstr("was stopped on request"));
  EXPECT_LT(here[0], way[1][0] - 0.1);
  EXPECT_EQ(tests::joints_of(world.arm.now()), here);
  robot->stop();  // standing: nothing is wrong with that
}

// Somebody else's program replaces ours: its end is not taken for the end of ours, even where it goes to the same
// place.
TEST(DeviceRobot, AnotherProgramsEndIsNotOurs) {
  DeskWorld world(20);
  const auto robot = open_robot(world.robot_url(), "here");
  const auto start = tests::joints_of(world.arm.now());
  Way way{start, start};
  way[1][0] += 1;
  std::string moved;
  std::thread mover([&] { moved = problem_of([&] { robot->move(way, tests::kSpeeds, tests::kAccelerations); }); });
  while (world.arm.now().speed_rad_per_s[0] == 0) std::this_thread::yield();
  desk::ArmStep theirs;
  theirs.kind = desk::ArmStep::Kind::move;
  theirs.target_rad = way[1];
  world.arm.run({{desk::ArmStep::Kind::mark, 24, 12345}, theirs, {desk::ArmStep::Kind::mark, 24, 12346}});
  mover.join();
  EXPECT_THAT(moved, testing::HasSubstr("another program took the place of ours"));
}

// The stop key of the pendant ends the program, and no flag tells of it.
TEST(DeviceRobot, AProgramThatEndsOnItsWayHasNotArrived) {
  DeskWorld world(20);
  const auto robot = open_robot(world.robot_url("&stall=50ms"), "here");
  const auto start = tests::joints_of(world.arm.now());
  Way way{start, start};
  way[1][0] += 2;
  std::string moved;
  std::thread mover([&] { moved = problem_of([&] { robot->move(way, tests::kSpeeds, tests::kAccelerations); }); });
  while (world.arm.now().speed_rad_per_s[0] == 0) std::this_thread::yield();
  world.arm.end_program();
  mover.join();
  EXPECT_THAT(moved, testing::HasSubstr("its program ended on the way: joint 1 stands at"));
}

TEST(DeviceRobot, RegistersOfAnotherArmAreNoticed) {
  DeskWorld world, other;
  other.arm.run({{desk::ArmStep::Kind::move, 0, 0, {0.1, -1.2, 1.3, -1.5, -1.6, 0.3}, 10, 100}});
  while (other.arm.now().program_running) std::this_thread::yield();
  const auto mixed = [&](const char* more) {
    return open_robot("modbus://127.0.0.1:" + std::to_string(other.registers.port()) +
                          world.robot_url(more).substr(world.host().size()),
                      "here");
  };
  EXPECT_THAT(problem_of([&] { mixed("")->state(); }),
              testing::HasSubstr("its registers say 0.3000 rad of joint 6, RTDE 0.2000"));
  EXPECT_NO_THROW(mixed("&check=no")->state());
}

TEST(DeviceRobot, NobodyThere) {
  const int port = [] {
    desk::Faults faults;
    return desk::ModbusDesk(faults).port();
  }();
  const std::string url = "modbus://127.0.0.1:" + std::to_string(port) + "?timeout=50ms&rtde=" + std::to_string(port);
  EXPECT_THAT(
      problem_of([&] { open_robot(url, "lab.json")->state(); }),
      testing::AllOf(testing::HasSubstr("lab.json: RTDE at 127.0.0.1:"), testing::HasSubstr("Connection refused")));
}

// Every fault of the network and the arm at once, each met by the truth or by an error: never by a wrong state.
void run_with_faults(std::uint64_t seed, int motions, int* arrived, int* refused) {
  DeskWorld world(400, seed);
  for (const auto kind : {Fault::rtde_dropped, Fault::rtde_reordered, Fault::rtde_short, Fault::rtde_reset})
    world.faults.set(kind, 0.03);
  for (const auto kind :
       {Fault::modbus_exception, Fault::modbus_busy, Fault::modbus_late, Fault::modbus_dropped, Fault::modbus_reset,
        Fault::script_lost, Fault::script_reset, Fault::protective_stop, Fault::joint_limit})
    world.faults.set(kind, 0.03);
  world.faults.late_s = 0.02;
  const auto robot = open_robot(world.robot_url("&timeout=15ms&begin=25ms&stall=50ms"), "here");
  Random random(seed, 9);
  for (int k = 0; k < motions; ++k) {
    const auto here = tests::joints_of(world.arm.now());
    Way way{here, here};
    for (double& angle : way[1]) angle = random.uniform(-3, 3);
    try {
      const RobotState state = robot->move(way, tests::kSpeeds, tests::kAccelerations);
      const auto truth = world.arm.now();
      EXPECT_LE(tests::farthest(tests::joints_of(truth), way[1]), 1e-4);
      EXPECT_EQ(state.joints_rad, tests::joints_of(truth));
      EXPECT_FALSE(state.protective_stop);
      ++*arrived;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Exit::unavailable) << error.what();
      ++*refused;
      while (world.arm.now().program_running || world.arm.now().speed_rad_per_s != desk::JointAngles(6))
        std::this_thread::yield();
    }
    const auto before = world.arm.now();
    try {
      const RobotState state = robot->state();
      const auto truth = world.arm.now();
      EXPECT_TRUE(state.time_s > before.time_s && state.time_s < truth.time_s);
      EXPECT_EQ(state.protective_stop, truth.protective_stop);
      EXPECT_EQ(before.joints_rad, truth.joints_rad) << "it moves although nobody asked";
      EXPECT_EQ(state.joints_rad, tests::joints_of(truth));
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Exit::unavailable) << error.what();
    }
    world.arm.clear_stops();
  }
}

TEST(DeviceRobot, FaultsNeverGiveAWrongState) {
  int arrived = 0, refused = 0;
  run_with_faults(7, 60, &arrived, &refused);
  EXPECT_GT(arrived, 10);
  EXPECT_GT(refused, 3);
}

}  // namespace
