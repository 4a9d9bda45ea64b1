// The Modbus client, lamps and turntables: against the desk's server with faults, and against one from another project.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <fstream>
#include <thread>

#include "acquisition/device/modbus_client.h"
#include "acquisition/device/register_map.h"
#include "base/error.h"
#include "data.h"
#include "desk_world.h"
#include "process.h"

using namespace gonio;
using namespace gonio::acquisition;
using gonio::acquisition::desk::Fault;
using gonio::tests::DeskWorld;

namespace {

using Words = std::vector<std::uint16_t>;

// IEEE 754: 1.5 = 3FC00000, -2.5 = C0200000, pi = 400921FB54442D18.
TEST(DeviceModbus, PacksNumbersAsTheyAreWrittenDown) {
  EXPECT_EQ(words_of_float(1.5f, WordOrder::high_first), (Words{0x3FC0, 0x0000}));
  EXPECT_EQ(words_of_float(-2.5f, WordOrder::low_first), (Words{0x0000, 0xC020}));
  EXPECT_EQ(words_of_double(3.141592653589793, WordOrder::high_first), (Words{0x4009, 0x21FB, 0x5444, 0x2D18}));
  EXPECT_EQ(words_of_double(3.141592653589793, WordOrder::low_first), (Words{0x2D18, 0x5444, 0x21FB, 0x4009}));
  EXPECT_EQ(words_of_integer(-2, WordOrder::high_first), (Words{0xFFFF, 0xFFFE}));
  EXPECT_EQ(words_of_integer(65537, WordOrder::low_first), (Words{1, 1}));
  EXPECT_EQ(signed_word(0xFFFF), -1);
  EXPECT_EQ(signed_word(0x8000), -32768);
  EXPECT_EQ(signed_word(0x7FFF), 32767);
  Random random(2);
  for (int i = 0; i < 1000; ++i)
    for (const auto order : {WordOrder::high_first, WordOrder::low_first}) {
      const double value = random.normal() * std::exp(20 * random.normal());
      EXPECT_EQ(double_of_words(words_of_double(value, order), order), value);
      const auto single = static_cast<float>(random.normal());
      EXPECT_EQ(float_of_words(words_of_float(single, order), order), single);
      const auto whole = static_cast<std::int32_t>(random.next());
      EXPECT_EQ(integer_of_words(words_of_integer(whole, order), order), whole);
    }
}

TEST(DeviceModbus, URsRegistersAreTheArms) {
  DeskWorld world;
  ModbusClient device({"127.0.0.1", world.registers.port(), 255}, "here");
  const RegisterReading reading = read_registers(device, ur_register_map());
  EXPECT_LE(tests::farthest(reading.joints_rad, tests::joints_of(world.arm.now())), 1.001e-3);  // cut to mrad
  EXPECT_LT(reading.joints_rad[1], -1);
  EXPECT_EQ(reading.mode, 7);
  EXPECT_TRUE(*reading.powered);
  EXPECT_FALSE(*reading.protective_stop || *reading.emergency_stop);
  EXPECT_NEAR(reading.temperature_K[3], 273.15 + world.arm.now().temperature_C[3], 1);
  world.arm.protective_stop();
  EXPECT_TRUE(*read_registers(device, ur_register_map()).protective_stop);
  EXPECT_EQ(device.reconnections(), 0);
}

// An answer that comes after its time is not taken for the next one's: each question is for another register.
TEST(DeviceModbus, FaultsNeverGiveAnotherRegistersValue) {
  desk::Faults faults(11);
  desk::ModbusDesk server(faults);
  faults.late_s = 0.03;
  ModbusClient patient({"127.0.0.1", server.port(), 1}, "here");
  ModbusClient device({"127.0.0.1", server.port(), 1, 0.02, 3}, "here");
  for (std::uint16_t i = 0; i < 64; ++i) {
    const auto value = static_cast<std::uint16_t>(1000 + 7 * i);
    patient.write_words(i, std::span(&value, 1));
  }
  for (const auto kind : {Fault::modbus_exception, Fault::modbus_busy, Fault::modbus_acknowledge, Fault::modbus_gateway,
                          Fault::modbus_late, Fault::modbus_dropped, Fault::modbus_reset})
    faults.set(kind, 0.06);
  int answered = 0;
  for (int k = 0; k < 300; ++k) {
    const int address = k * 37 % 64;
    try {
      EXPECT_EQ(device.words(WordTable::holding, address, 1).at(0), 1000 + 7 * address);
      ++answered;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Exit::unavailable);
      EXPECT_THAT(error.problem(), testing::HasSubstr("Modbus at 127.0.0.1:" + std::to_string(server.port())));
    }
  }
  EXPECT_GT(answered, 100);
  EXPECT_GT(device.reconnections(), 20);
  EXPECT_GT(faults.struck(Fault::modbus_late), 10);
}

// What may pass is asked again, on the same connection, for as long as the timeout; what stays is asked once.
TEST(DeviceModbus, ExceptionsThatPassAreWaitedOut) {
  for (const auto& [kind, words] : {std::pair{Fault::modbus_exception, "failure (exception 04, asked "},
                                    {Fault::modbus_acknowledge, "(exception 05, asked "},
                                    {Fault::modbus_busy, "busy (exception 06, asked "},
                                    {Fault::modbus_gateway, "(exception 11, asked "}}) {
    desk::Faults faults(3);
    desk::ModbusDesk server(faults);
    ModbusClient device({"127.0.0.1", server.port(), 7, 3600}, "lab.json");
    faults.set(kind, 0.5);
    for (std::uint16_t i = 0; i < 12; ++i) {
      device.write_words(i, std::span(&i, 1));
      EXPECT_EQ(device.words(WordTable::holding, i, 1).at(0), i);
      device.write_bit(i, i % 2 == 1);
      EXPECT_EQ(device.bits(BitTable::coil, i, 1).at(0), i % 2 == 1);
    }
    EXPECT_GT(faults.struck(kind), 20);
    EXPECT_EQ(faults.occasions(kind), 48 + faults.struck(kind));
    EXPECT_EQ(device.reconnections(), 0);
    faults.set(kind, 1);
    ModbusClient hasty({"127.0.0.1", server.port(), 7, 0.02}, "lab.json#/laboratory/turntables/t/url");
    try {
      hasty.words(WordTable::holding, 11, 1);
      ADD_FAILURE() << words;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Exit::unavailable);
      EXPECT_THAT(error.what(), testing::StartsWith("lab.json#/laboratory/turntables/t/url: Modbus at 127.0.0.1:"));
      EXPECT_THAT(error.problem(),
                  testing::AllOf(testing::HasSubstr(", unit 7, register 11: "), testing::HasSubstr(words)));
      EXPECT_NE(error.remedy(), "");
    }
  }
}

TEST(DeviceModbus, WhatTheDeviceRefusesIsSaidAtOnce) {
  desk::Faults faults;
  desk::ModbusDesk server(faults);
  ModbusClient device({"127.0.0.1", server.port(), 3, 3600}, "lab.json#/laboratory/lamps/left/url");
  const auto refusal = [&](const auto& ask) -> std::string {
    const auto before = faults.occasions(Fault::modbus_busy);
    try {
      ask();
    } catch (const Error& error) {
      EXPECT_EQ(faults.occasions(Fault::modbus_busy), before + 1);
      return error.what();
    }
    return "taken";
  };
  EXPECT_THAT(refusal([&] { device.words(WordTable::holding, 60000, 1); }),
              testing::AllOf(testing::StartsWith("lab.json#/laboratory/lamps/left/url: Modbus at 127.0.0.1:"),
                             testing::HasSubstr(", unit 3, register 60000: Illegal data address (exception 02); "),
                             testing::HasSubstr("check the number and unit=")));
  EXPECT_THAT(refusal([&] { device.write_bit(4000, true); }),
              testing::HasSubstr("writing coil 4000: Illegal data address (exception 02)"));
  EXPECT_EQ(device.reconnections(), 0);
}

// A lamp and a turntable do their work though every third answer is an exception.
TEST(DeviceModbus, DevicesWorkThroughExceptions) {
  DeskWorld world;
  for (const auto kind :
       {Fault::modbus_exception, Fault::modbus_busy, Fault::modbus_acknowledge, Fault::modbus_gateway})
    world.faults.set(kind, 0.1);
  const auto lamp = open_lamp(world.host() + "/coil/4?answer=4&timeout=60s", "here");
  const auto table = open_turntable(world.host() + "/register/40?scale=0.1mrad&timeout=60s&stall=60s", "here");
  for (int i = 0; i < 6; ++i) {
    lamp->set(i % 2 == 0);
    EXPECT_EQ(world.lamps.lit(4), i % 2 == 0);
    EXPECT_NEAR(table->turn_to(0.3 * i), 0.3 * i, 1e-4);
    EXPECT_NEAR(world.table.angle_rad(), 0.3 * i, 1e-4);
  }
  EXPECT_GT(world.faults.struck(Fault::modbus_exception), 3);
}

TEST(DeviceModbus, LampsAreReadBack) {
  DeskWorld world;
  const auto coil = open_lamp(world.host() + "/coil/3", "here");
  const auto seen = open_lamp(world.host() + "/coil/4?answer=4&timeout=200ms", "here");
  const auto inverse = open_lamp(world.host() + "/coil/5?inverse=yes", "here");
  coil->set(true);
  EXPECT_TRUE(coil->is_on() && world.lamps.lit(3) && !world.lamps.lit(4));
  coil->set(false);
  EXPECT_FALSE(coil->is_on() || world.lamps.lit(3));
  inverse->set(false);
  EXPECT_TRUE(world.lamps.lit(5) && !inverse->is_on());
  seen->set(true);
  EXPECT_TRUE(seen->is_on());
  world.faults.set(Fault::lamp_dark, 1);
  seen->set(false);
  try {
    seen->set(true);
    ADD_FAILURE() << "a dark lamp is on";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("lamp at coil 4 of 127.0.0.1 stays off after it was switched on"));
  }
}

TEST(DeviceModbus, TurntablesArriveOrSayWhereTheyStand) {
  DeskWorld world;
  const std::string url = world.host() + "/register/40?scale=0.1mrad&stall=40ms";
  const auto table = open_turntable(url, "here");
  for (const double angle : {0.5, -1.25, 3.0}) {
    EXPECT_NEAR(table->turn_to(angle), angle, 1e-4);
    EXPECT_NEAR(world.table.angle_rad(), angle, 1e-4);
    EXPECT_NEAR(table->angle_rad(), angle, 1e-4);
  }
  table->stop();
  EXPECT_NEAR(world.table.angle_rad(), 3.0, 1e-3);
  const auto deaf = open_turntable(world.host() + "/register/100?scale=0.1mrad&stall=10ms", "here");
  try {
    deaf->turn_to(1);
    ADD_FAILURE() << "registers that nobody reads turn nothing";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("stands at 0.000000 rad instead of 1.000000"));
  }
  EXPECT_THROW(open_turntable(world.host() + "/register/40?scale=0.1mrad&type=int16", "here")->turn_to(1e6), Error);
}

// A controller with its own map, played by a thread over the desk's registers.
class OtherController {
 public:
  explicit OtherController(int port) : device_({"127.0.0.1", port}, "controller") {
    thread_ = std::thread([this] {
      while (!ending_) step();
    });
  }
  ~OtherController() {
    ending_ = true;
    thread_.join();
  }

 private:
  void step() {
    const auto command = device_.words(WordTable::holding, 30, 2);
    if (device_.bits(BitTable::coil, 20, 1).at(0)) device_.write_bit(20, false);
    if (command[0] == command[1]) return std::this_thread::yield();
    auto target = device_.words(WordTable::holding, 10, 4);
    device_.write_words(0, target);  // joints in 0 .. 3
    device_.write_words(31, std::span(command).first(1));
  }
  ModbusClient device_;
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

constexpr const char* kOtherMap = R"({"joints": 2, "registers": {
 "joint-1": {"address": 0, "type": "float32", "words": "low-first", "scale": 0.017453292519943295},
 "joint-2": {"address": 2, "type": "float32", "words": "low-first", "scale": 0.017453292519943295},
 "target-1": {"address": 10, "type": "float32", "words": "low-first", "scale": 0.017453292519943295},
 "target-2": {"address": 12, "type": "float32", "words": "low-first", "scale": 0.017453292519943295},
 "command": {"address": 30}, "done": {"address": 31}, "stop": {"address": 20, "type": "bit"},
 "emergency-stop": {"address": 21, "type": "bit"}}})";

TEST(DeviceModbus, AnotherControllerMovesByItsRegisterMap) {
  DeskWorld world;
  tests::ScratchFolder folder;
  std::ofstream(folder / "my map.json") << kOtherMap;
  const std::string url =
      with_query(world.host() + "?stall=3000ms", "registers", (folder / "my map.json").string(), "here");
  const auto robot = open_robot(url, "here");
  const std::vector<std::vector<double>> way{{0, 0}, {0.5, -1}, {1.5, 2}};
  const std::vector<double> two{1, 1};
  {
    OtherController controller(world.registers.port());
    const RobotState state = robot->move(way, two, two);
    EXPECT_LE(tests::farthest(state.joints_rad, way.back()), 1e-4);
    EXPECT_TRUE(state.standing);
  }
  const auto silent =
      open_robot(url.substr(0, url.find("3000ms")) + "20ms" + url.substr(url.find("3000ms") + 6), "here");
  const std::vector<std::vector<double>> back{{1.5, 2}, {0, 0}};
  try {
    silent->move(back, two, two);
    ADD_FAILURE() << "nobody moved it";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("does not move on for 0.02 s; joint 1 stands at 1.500000 rad"));
  }
}

TEST(DeviceModbus, MapsThatAreNoneAreRefusedInWords) {
  tests::ScratchFolder folder;
  const auto refusal = [&](const std::string& text) -> std::string {
    const std::string path = (folder / "map.json").string();
    std::ofstream(path) << text;
    try {
      read_register_map(path, "here");
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Exit::data);
      return error.what();
    }
    return "taken";
  };
  const std::string one = R"("joint-1": {"address": 1})";
  EXPECT_EQ(refusal("{\"joints\": 1, \"registers\": {" + one + "}}"), "taken");
  const std::vector<std::pair<std::string, std::string>> wrong{
      {"{", "map.json"},
      {"{}", "holds no \"registers\""},
      {"{\"joints\": 2, \"registers\": {" + one + "}}", "joint-2 is missing"},
      {"{\"joints\": 0, \"registers\": {" + one + "}}", "#/joints: is no number of joints"},
      {R"({"registers": {"elbow": {"address": 1}}})", "#/registers/elbow: is not known"},
      {R"({"registers": {"joint-1": {"address": 65536}}})", "joint-1/address: is no address"},
      {R"({"registers": {"joint-1": {"address": 1, "type": "int24"}}})", "joint-1/type: is none of these words"},
      {R"({"registers": {"joint-1": {"address": 1, "scale": 0}}})", "joint-1/scale: is 0"},
      {R"({"registers": {"joint-1": {"address": 1, "table": "coil"}}})", "joint-1/type: does not fit into a coil"},
      {R"({"registers": {"joint-1": {"address": 1, "adress": 2}}})", "joint-1/adress: is not known"}};
  for (const auto& [text, words] : wrong) EXPECT_THAT(refusal(text), testing::HasSubstr(words)) << text;
}

// A server from another project (python3-pymodbus of Debian): coils 0 .. 99 and registers 0 .. 99 that hold 3 times
// their address.
constexpr const char* kPymodbusServer = R"(
import asyncio, sys, types
for name in ('serial', 'serial_asyncio'):  # imported for lines of that kind; Debian's package only recommends them
    try:
        __import__(name)
    except ImportError:
        sys.modules[name] = types.ModuleType(name)
        sys.modules[name].create_serial_connection = None
from pymodbus.server import StartAsyncTcpServer
from pymodbus.datastore import ModbusSequentialDataBlock, ModbusSlaveContext, ModbusServerContext
store = ModbusSlaveContext(di=ModbusSequentialDataBlock(0, [0, 1] * 50), co=ModbusSequentialDataBlock(0, [0] * 100),
                           hr=ModbusSequentialDataBlock(0, [3 * i for i in range(100)]),
                           ir=ModbusSequentialDataBlock(0, [0xFFFF - i for i in range(100)]), zero_mode=True)
context = ModbusServerContext(slaves=store, single=True)
asyncio.run(StartAsyncTcpServer(context, address=('127.0.0.1', int(sys.argv[1]))))
)";

TEST(DeviceModbus, SpeaksWithAServerThatIsNotOurs) {
  if (tests::run({"/usr/bin/python3", "-c", "import pymodbus"}).status != 0)
    GTEST_SKIP() << "python3-pymodbus is not installed";
  const int port = [] {
    desk::Faults faults;
    return desk::ModbusDesk(faults).port();  // one that is free
  }();
  tests::Process server({"/usr/bin/python3", "-c", kPymodbusServer, std::to_string(port)});
  struct Ender {
    tests::Process& process;
    ~Ender() {
      ::kill(process.id(), SIGKILL);
      process.end();
    }
  };
  std::optional<Ender> ender(server);
  const std::string host = "modbus://127.0.0.1:" + std::to_string(port);
  ModbusClient device({"127.0.0.1", port, 1, 2}, "here");
  const auto give_up = Clock::now() + std::chrono::seconds(60);
  for (bool up = false; !up;) {
    try {
      up = !device.words(WordTable::holding, 0, 1).empty();
    } catch (const Error&) {
      ASSERT_LT(Clock::now(), give_up) << "the server did not come up";
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
  EXPECT_EQ(device.words(WordTable::holding, 10, 4), (Words{30, 33, 36, 39}));
  EXPECT_EQ(device.words(WordTable::input, 0, 2), (Words{0xFFFF, 0xFFFE}));
  EXPECT_EQ(device.bits(BitTable::discrete, 0, 4), (std::vector<bool>{false, true, false, true}));
  for (const auto order : {WordOrder::high_first, WordOrder::low_first}) {
    device.write_words(20, words_of_double(-1234.5678, order));
    EXPECT_EQ(double_of_words(device.words(WordTable::holding, 20, 4), order), -1234.5678);
  }
  EXPECT_THROW(device.words(WordTable::holding, 200, 1), Error);
  const auto lamp = open_lamp(host + "/coil/7", "here");
  lamp->set(true);
  EXPECT_TRUE(lamp->is_on());
  EXPECT_EQ(device.bits(BitTable::coil, 6, 3), (std::vector<bool>{false, true, false}));
  ender.reset();
  EXPECT_THROW(lamp->is_on(), Error);
}

}  // namespace
