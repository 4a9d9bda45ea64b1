// Bad input to acquire: each kind ends it with its exit status and one clear line that names the place and the remedy;
// nothing is half written, and nothing has moved.
// One process: AcquireRefuses.*
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <functional>
#include <set>

#include "acquisition/desk/socket_server.h"
#include "acquisition/desk/specimen_laboratory.h"
#include "acquisition/desk_world.h"
#include "acquisition/run/instrument_lock.h"
#include "base/atomic_file.h"
#include "data.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "manifest/value.h"
#include "process.h"

namespace gonio::tests {
namespace {

namespace fs = std::filesystem;
using manifest::Value;
using testing::HasSubstr;
using Spoil = std::function<void(Value&)>;

const char* const views = "board:views=3,tilt=30deg,nearest=25cm,farthest=35cm";

struct BadInput {
  const char* kind;
  Spoil spoil;  // null: the manifest is sound
  Process::Words words;
  int status;
  std::vector<std::string> mentions;
};

Value& lab_of(Value& d) {
  return d["laboratory"];
}
Value& arm_of(Value& d) {
  return lab_of(d)["robots"]["arm"];
}
Value& url_of(Value& d, const char* kind, const char* name) {
  return lab_of(d)[kind][name]["url"];
}

// Run with --log-level error: what a plan says of itself is no complaint.
class AcquireRefuses : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    manifest::Document lab = acquisition::specimen_laboratory("desk", folder().path());
    manifest::Camera& lens = lab.cameras.at("camera");
    lens.width_px = 16, lens.height_px = 12;
    lens.fx_px = lens.fy_px = 18;
    lens.cx_px = 8, lens.cy_px = 6;
    write_file(folder() / "lab.json", manifest::print_document(lab, folder().path()));
    const Ended planned = run({"acquire", "lab.json", "--plan", views}, folder().path());
    ASSERT_EQ(planned.status, 0) << planned.err;
    write_file(folder() / "plan.json", planned.out);
  }
  static ScratchFolder& folder() {
    static ScratchFolder made;
    return made;
  }
  static std::set<std::string> files() {
    std::set<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder().path())) names.insert(entry.path());
    return names;
  }
  // `name` with something made wrong in it, as bad.json.
  static void spoil(const char* name, const Spoil& how) {
    Value document = manifest::parse_json(read_file(folder() / name), name);
    if (how) how(document);
    write_file(folder() / "bad.json", manifest::print_json(document));
  }

  // The arm behind a register map.
  static Spoil by_map(const char* map, const std::string& camera, const std::string& lamp) {
    return [map, camera, lamp](Value& d) {
      write_file(folder() / "map.json", map);
      d["files"]["map"] = Value::object({{"path", "map.json"}});
      arm_of(d)["registers"] = "map";
      url_of(d, "robots", "arm") = "modbus://127.0.0.1:1?timeout=50ms";
      url_of(d, "cameras", "camera") = camera;
      url_of(d, "lamps", "lamp") = lamp;
    };
  }

  static void expect_refused(const char* name, const BadInput& bad, const std::function<void()>& before = {}) {
    SCOPED_TRACE(bad.kind);
    spoil(name, bad.spoil);
    Process::Words words{"acquire", "bad.json", "--log-level", "error"};
    words.insert(words.end(), bad.words.begin(), bad.words.end());
    const auto files_before = files();
    const Ended ended = run(words, folder().path(), {}, before);
    EXPECT_EQ(ended.status, bad.status) << ended.err;
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
    EXPECT_THAT(ended.err, testing::StartsWith("acquire: "));
    EXPECT_THAT(ended.err, testing::AnyOf(HasSubstr("; "), HasSubstr(" is needed"))) << "what to do about it";
    for (const std::string& words_in : bad.mentions) EXPECT_THAT(ended.err, HasSubstr(words_in));
    EXPECT_EQ(ended.out, "");
    EXPECT_EQ(files(), files_before);
  }
};

const Process::Words planning{"--plan", views}, going{"--go", "--out", "o"};

TEST_F(AcquireRefuses, LaboratoriesThatCannotBe) {
  const std::string lab = "bad.json#/laboratory";
  const BadInput all[]{{"no laboratory",
                        [](Value& d) { d["laboratory"] = Value::object(); },
                        planning,
                        64,
                        {"which camera is not said"}},
                       {"without robots",
                        [](Value& d) { lab_of(d)["robots"] = Value::object(); },
                        planning,
                        65,
                        {lab + "/cameras/camera/robot: names \"arm\"", "that section is empty"}},
                       {"robot of unknown model",
                        [](Value& d) { arm_of(d)["model"] = "ur17"; },
                        planning,
                        65,
                        {lab + "/robots/arm/model: \"ur17\" is no known arm", "ur10e"}},
                       {"calibration missing",
                        [](Value& d) {
                          d["files"]["c"] = Value::object({{"path", "none.conf"}});
                          arm_of(d)["calibration"] = "c";
                        },
                        planning,
                        66,
                        {"bad.json#/files/c/path: \"none.conf\" cannot be read"}},
                       {"mesh missing",
                        [](Value& d) {
                          d["files"]["m"] = Value::object({{"path", "none.ply"}});
                          lab_of(d)["obstacles"].as_array().push_back(Value::object({{"name", "x"}, {"mesh", "m"}}));
                        },
                        planning,
                        66,
                        {"bad.json#/files/m/path: \"none.ply\" cannot be read"}},
                       {"joint limit reversed",
                        [](Value& d) {
                          arm_of(d)["limits"] = Value::object(
                              {{"lower_rad", std::vector<double>(6, 1)}, {"upper_rad", std::vector<double>(6, -1)}});
                        },
                        planning,
                        65,
                        {lab + "/robots/arm/limits: joint 1 may turn from 1 to -1 rad"}}};
  for (const BadInput& bad : all) expect_refused("lab.json", bad);
}

TEST_F(AcquireRefuses, LimitsAndDevicesThatCannotBe) {
  const std::string lab = "bad.json#/laboratory";
  const BadInput all[]{
      {"home in the table",
       [](Value& d) { arm_of(d)["home_rad"] = std::vector<double>{0, 1, 1, 0, 0, 0}; },
       planning,
       65,
       {lab + "/robots: at home arm/", "of table, limit 0.01 m; give the arms another home_rad"}},
      {"workspace that excludes home",
       [](Value& d) {
         lab_of(d)["limits"] =
             Value::object({{"lower_m", std::vector<double>{-2, -2, -2}}, {"upper_m", std::vector<double>{2, 2, 0.3}}});
       },
       planning,
       65,
       {lab + "/robots: at home arm's flange at z = ", "limit 0.300 m; give the arms another home_rad"}},
      {"workspace reversed",
       [](Value& d) {
         lab_of(d)["limits"] =
             Value::object({{"lower_m", std::vector<double>{1, 1, 1}}, {"upper_m", std::vector<double>{0, 0, 0}}});
       },
       planning,
       65,
       {lab + "/limits: lower_m is not below upper_m"}},
      {"lamp on an arm that does not exist",
       [](Value& d) { lab_of(d)["lamps"]["lamp"]["robot"] = "third"; },
       planning,
       65,
       {lab + "/lamps/lamp/robot: names \"third\"", "there is arm"}},
      {"two devices with one URL",
       [](Value& d) {
         for (const char* name : {"lamp", "other"}) url_of(d, "lamps", name) = "modbus://10.0.0.9/coil/1";
       },
       planning,
       65,
       {lab + "/lamps/other/url: modbus://10.0.0.9/coil/1 is that of /laboratory/lamps/lamp, too; give every device"}},
      {"negative time of a lamp",
       [](Value& d) { lab_of(d)["lamps"]["lamp"]["settle_s"] = -1; },
       planning,
       65,
       {lab + "/lamps/lamp/settle_s: is -1 s"}}};
  for (const BadInput& bad : all) expect_refused("lab.json", bad);
}

TEST_F(AcquireRefuses, WhatCannotBeAsked) {
  const BadInput all[]{
      {"pose out of reach",
       {},
       {"--plan", "hemisphere:step=45deg,radius=5m"},
       65,
       {"bad.json#/laboratory: lets no view be taken of the 9 that are asked; move what is looked at"}},
      {"exposure bracket negative",
       {},
       {"--plan", views, "--exposure", "2ms", "--exposure", "-2ms"},
       64,
       {"--exposure: is -2ms, at least 1e-07 s"}},
      {"unknown pattern", {}, {"--plan", "spiral"}, 64, {"--plan: no pattern \"spiral\"; one of arc, board"}},
      {"number of a pattern", {}, {"--plan", "board:views=0"}, 64, {"--plan: board: views is 0; between 1 and 10000"}},
      {"camera that it has not",
       {},
       {"--plan", views, "--camera", "left"},
       64,
       {"--camera: \"left\"", "there is camera"}},
      {"fault unknown", {}, {"--serve", "--faults", "lamp-dork=1%"}, 64, {"\"lamp-dork\" is no fault; there is rtde-"}},
      {"--wait with a bad duration", {}, {"--go", "--out", "o", "--wait", "10"}, 64, {"--wait: '10' lacks its unit"}},
      {"--go without a folder", {}, {"--go"}, 64, {"--go: has no folder for its frames; give --out DIR"}},
      {"no plan", {}, going, 65, {"bad.json#/plans: is empty; plan first"}}};
  for (const BadInput& bad : all) expect_refused("lab.json", bad);
}

TEST_F(AcquireRefuses, PlansAndTruthsThatDoNotFit) {
  write_file(folder() / "rust.json", R"({"gonio": 1, "mechanisms": {"robot.rust": {"mm": 1}}})");
  write_file(folder() / "ninth.json", R"({"gonio": 1, "mechanisms": {"robot.joint-offset": {"joint_9_rad": 1}}})");
  const auto with = [](Process::Words words, const Process::Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  const BadInput all[]{
      {"plan of another laboratory",
       [](Value& d) { arm_of(d)["home_rad"].as_array()[1] = -1.8; },
       going,
       65,
       {"bad.json#/plans: was made for another laboratory, or changed by hand; plan again"}},
      {"plan edited by hand",
       [](Value& d) { d["plans"].as_array()[0]["steps"].as_array()[0]["joints_rad"].as_array()[0] = 0.5; },
       going,
       65,
       {"bad.json#/plans: was made for another laboratory, or changed by hand; plan again"}},
      {"--go missing", {}, {}, 64, {"--go: is not given, and nothing else is asked for; plan (--plan)"}},
      {"plan that is not there", {}, with(going, {"--plan-id", "zz"}), 64, {"--plan-id: no plan's id begins with zz"}},
      {"camera without the asked pixel format",
       [](Value& d) { lab_of(d)["cameras"]["camera"]["pixel_format"] = "Polarized8"; },
       going,
       65,
       {"/laboratory/cameras/camera/pixel_format: \"Polarized8\"", "as Mono12"}},
      {"truth with an unknown mechanism",
       {},
       with(going, {"--truth", "rust.json"}),
       65,
       {"rust.json#/mechanisms/robot.rust: no such mechanism"}},
      {"truth with an unknown parameter",
       {},
       with(going, {"--truth", "ninth.json"}),
       65,
       {"ninth.json#/mechanisms/robot.joint-offset/joint_9_rad: robot.joint-offset has no such parameter"}},
      {"truth missing", {}, with(going, {"--truth", "none.json"}), 66, {"none.json: No such file"}},
      {"simulated devices beside others",
       [](Value& d) { url_of(d, "lamps", "lamp") = "modbus://10.0.0.9/coil/1"; },
       going,
       65,
       {"bad.json#/laboratory: has simulated devices beside others; give all of them sim://"}}};
  for (const BadInput& bad : all) expect_refused("plan.json", bad);
}

// A camera that stands needs no arm: that is no bad input.
TEST_F(AcquireRefuses, NoLaboratoryWithoutArms) {
  spoil("lab.json", [](Value& d) {
    lab_of(d)["robots"] = Value::object();
    lab_of(d)["obstacles"] = Value::array();
    lab_of(d)["cameras"]["camera"]["robot"] = "";
    lab_of(d)["cameras"]["camera"]["world_from_camera"] = Value::object(
        {{"rotation", std::vector<double>{0, 1, 0, 0}}, {"translation_m", std::vector<double>{0, 0, 0.4}}});
  });
  const Ended ended = run({"acquire", "bad.json", "--plan", "hdr:longest=4ms", "--go", "--spp", "1", "--out", "stands"},
                          folder().path());
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("\"images\""));
}

// The devices behind URLs; the arm is one that answers on loopback.
Spoil reached(const DeskWorld& world, const std::string& camera, const std::string& lamp) {
  return [arm = world.robot_url(), camera, lamp](Value& d) {
    url_of(d, "robots", "arm") = arm;
    url_of(d, "cameras", "camera") = camera;
    url_of(d, "lamps", "lamp") = lamp;
  };
}

// An arm answers on loopback all the while, and has to stand where it stood.
TEST_F(AcquireRefuses, DevicesThatAreNotAsTheyShouldBe) {
  DeskWorld world;
  const std::string nobody = "modbus://127.0.0.1:1", lamp = world.host() + "/coil/3";
  const std::string pictures = "folder://" + folder().path().string();
  const auto real = [&](const std::string& camera, const std::string& light) { return reached(world, camera, light); };
  write_file(folder() / "map.json", "{}");
  const BadInput all[]{
      {"unknown scheme",
       real("vimba://10.0.0.2", lamp),
       going,
       64,
       {"/laboratory/cameras/camera/url: no driver for 'vimba://'; there are ", "v4l2://"}},
      {"camera that is none",
       real("v4l2:///dev/null", lamp),
       going,
       69,
       {"/laboratory/cameras/camera/url: camera /dev/null: as a camera: "}},
      {"device that does not answer",
       real(pictures, nobody + "/coil/1?timeout=50ms"),
       going,
       69,
       {"/laboratory/lamps/lamp/url: Modbus at 127.0.0.1:1, cannot be reached: Connection refused"}},
      {"address that a device has not",
       real(pictures, world.host() + "/coil/3?answer=5000"),
       going,
       69,
       {"/laboratory/lamps/lamp/url: Modbus at ",
        "discrete input 5000: Illegal data address (exception 02); the device"}},
      {"register map without a register",
       by_map(R"({"joints": 6, "registers": {"joint-1": {"address": 1}}})", pictures, lamp),
       going,
       65,
       {"map.json#/registers: joint-2 is missing; every joint needs its angle"}},
      {"key that a URL has not", real(pictures, lamp + "?answr=3"), going, 64, {"'answr' is not known; it knows unit"}},
      {"--truth beside real devices",
       real(pictures, lamp),
       {"--go", "--out", "o", "--truth", "map.json"},
       64,
       {"--truth: is for sim:// devices; leave it out"}},
      {"--go missing on a real robot", real(pictures, lamp), {}, 64, {"--go: is not given"}}};
  const auto stood = joints_of(world.arm.now());
  for (const BadInput& bad : all) expect_refused("plan.json", bad);
  EXPECT_EQ(joints_of(world.arm.now()), stood);
  EXPECT_FALSE(world.arm.now().program_running);
}

TEST_F(AcquireRefuses, WhatAnotherHolds) {
  const DeskWorld world;
  const std::string lamp = world.host() + "/coil/3", pictures = "folder://" + folder().path().string();
  {
    const acquisition::InstrumentLock other({lamp}, std::chrono::seconds(0));
    expect_refused("plan.json", {"lock held",
                                 reached(world, pictures, lamp),
                                 going,
                                 75,
                                 {lamp + ": is driven by another program (waited 0 s); wait longer (--wait 10min)"}});
  }
  const int taken = acquisition::desk::listen_on_loopback(0);
  expect_refused("lab.json", {"port in use",
                              {},
                              {"--serve", "--port", std::to_string(acquisition::desk::port_of(taken))},
                              69,
                              {"the port is taken"}});
  ::close(taken);
}

// A disk that fills is no end: what was written before stands, and the run goes on with it.
TEST_F(AcquireRefuses, ADiskThatFillsEndsARunThatGoesOn) {
  spoil("plan.json", {});
  const Process::Words words{"acquire", "bad.json", "--go", "--out", "full", "--spp", "16", "--log-level", "error"};
  const Ended full = run(words, folder().path(), {}, [] {
    const rlimit few{900, 900};  // bytes of one file: the journal's
    ::setrlimit(RLIMIT_FSIZE, &few);
    ::signal(SIGXFSZ, SIG_IGN);
  });
  EXPECT_EQ(full.status, 74) << full.err;
  EXPECT_EQ(std::count(full.err.begin(), full.err.end(), '\n'), 1) << full.err;
  EXPECT_THAT(full.err, testing::AllOf(HasSubstr("full/journal.jsonl: cannot be written: File too large"),
                                       HasSubstr("; make room, then go on with --resume")));
  EXPECT_EQ(full.out, "");
  const Ended again = run(words, folder().path());
  EXPECT_EQ(again.status, 73) << again.err;
  EXPECT_THAT(again.err, HasSubstr("full/journal.jsonl: is the journal of a run that is there already; go on with it"));

  Process::Words resumed = words;
  resumed.push_back("--resume");
  const Ended whole = run(resumed, folder().path());
  EXPECT_EQ(whole.status, 0) << whole.err;
  for (const char* name : {"1", "2", "3"})
    EXPECT_TRUE(fs::exists(folder() / ("full/frames/board-000" + std::string(name) + ".png")));

  const Ended other = run({"acquire", "lab.json", "--plan", "board:views=4,tilt=30deg,nearest=25cm,farthest=35cm",
                           "--go", "--out", "full", "--resume", "--log-level", "error"},
                          folder().path());
  EXPECT_EQ(other.status, 65) << other.err;
  EXPECT_EQ(std::count(other.err.begin(), other.err.end(), '\n'), 1) << other.err;
  EXPECT_THAT(other.err, HasSubstr("full/journal.jsonl: is the journal of another plan or laboratory; resume with"));
  EXPECT_EQ(other.out, "");
}

}  // namespace
}  // namespace gonio::tests
