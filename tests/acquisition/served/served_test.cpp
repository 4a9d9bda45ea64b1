// The simulated laboratory behind its network, as a user runs it: the program of GONIO_BIN serves, another call of it
// acquires.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <thread>

#include "acquisition/desk/gige_camera.h"
#include "acquisition/desk/gige_packets.h"
#include "acquisition/desk/served_laboratory.h"
#include "acquisition/desk/specimen_laboratory.h"
#include "acquisition/desk/true_laboratory.h"
#include "acquisition/device/devices.h"
#include "acquisition/run/instrument.h"
#include "acquisition/whole_frame.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "data.h"
#include "io/raster.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/laboratory.h"
#include "process.h"

namespace gonio::acquisition {
namespace {

namespace fs = std::filesystem;
using tests::Process;

// The built-in laboratory with a small picture.
void write_small_laboratory(const fs::path& folder) {
  manifest::Document lab = specimen_laboratory("desk", folder);
  manifest::Camera& lens = lab.cameras.at("camera");
  lens.width_px = 48;
  lens.height_px = 36;
  lens.fx_px = lens.fy_px = 54;
  lens.cx_px = 24;
  lens.cy_px = 18;
  write_file(folder / "lab.json", manifest::print_document(lab, folder));
}

// Its description lies in served.json once it serves.
class Serving {
 public:
  Serving(const fs::path& folder, const std::vector<std::string>& more)
      : process_(words(more), folder, {}, [] { ::prctl(PR_SET_PDEATHSIG, SIGKILL); }) {
    for (int n = 0; n < 2000 && !fs::exists(folder / "served.json"); ++n)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  tests::Ended interrupt() {
    ::kill(process_.id(), SIGINT);
    return process_.end();
  }

 private:
  static Process::Words words(const std::vector<std::string>& more) {
    Process::Words all{"acquire", "--serve", "lab.json", "-o", "served.json", "--spp", "1", "--pace", "100"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  Process process_;
};

std::map<std::string, std::string> frames_in(const fs::path& folder) {
  std::map<std::string, std::string> frames;
  for (const auto& entry : fs::directory_iterator(folder / "frames"))
    frames[entry.path().filename()] = read_file(entry.path());
  return frames;
}

const char* const views = "board:views=3,tilt=30deg,nearest=25cm,farthest=35cm";

TEST(Served, ThePicturesAreThoseOfTheLaboratoryWithinOneProgramAndFaultsChangeNone) {
  const tests::ScratchFolder folder;
  write_small_laboratory(folder.path());
  write_file(folder / "truth.json", R"({"gonio": 1, "mechanisms": {"robot.joint-offset": {"joint_2_rad": 0.0035}}})");
  const Process::Words bracket{"--exposure", "2ms", "--exposure", "10ms"};
  Process::Words inside{"acquire", "lab.json",   "--plan", views,    "--go", "--spp",      "1",
                        "--truth", "truth.json", "--out",  "inside", "-o",   "inside.json"};
  inside.insert(inside.end(), bracket.begin(), bracket.end());
  const auto first = tests::run(inside, folder.path());
  ASSERT_EQ(first.status, 0) << first.err;

  Serving server(folder.path(), {"--truth", "truth.json", "--faults",
                                 "rtde-dropped=5%,rtde-reordered=5%,rtde-short=1%,modbus-busy=2%,"
                                 "modbus-exception=5%,modbus-acknowledge=2%,modbus-gateway=2%,modbus-reset=2%,frame-"
                                 "dropped=15%,frame-reordered=40%,chunk-late=20%,"
                                 "stuck-exposure=20%,lamp-dark=15%"});
  EXPECT_EQ(read_file(folder / "served.json").find("joint-offset"), std::string::npos);  // the truth stays inside
  Process::Words outside{"acquire", "served.json", "--plan",       views,       "--go", "--out",
                         "outside", "-o",          "outside.json", "--retakes", "20"};
  outside.insert(outside.end(), bracket.begin(), bracket.end());
  const auto second = tests::run(outside, folder.path());
  const auto served = server.interrupt();
  ASSERT_EQ(second.status, 0) << second.err << served.err;
  EXPECT_EQ(served.status, 0) << served.err;
  EXPECT_EQ(frames_in(folder / "inside").size(), 6U);
  EXPECT_EQ(frames_in(folder / "inside"), frames_in(folder / "outside"));
  EXPECT_THAT(served.err, testing::HasSubstr("frame-dropped: "));
  EXPECT_THAT(second.err, testing::Not(testing::HasSubstr(" 0 retaken")));
}

// A camera before a screen of 4 x 3 pixels, and a sheet behind.
manifest::Document before_a_screen(const std::filesystem::path& folder) {
  return manifest::parse_document(R"({"gonio": 1,
    "files": {"f": {"path": "left.png"}},
    "cameras": {"c": {"width_px": 16, "height_px": 12, "fx_px": 16, "fy_px": 16, "cx_px": 7.5, "cy_px": 5.5}},
    "meshes": {"sheet": {"plane": {"size_m": [2, 2]}}},
    "surfaces": {"s": {"model": "diffuse", "albedo": [0.5, 0.5, 0.5]}},
    "objects": [{"id": "sheet", "mesh": "sheet", "surface": "s"}],
    "lights": {"lcd": {"model": "screen", "file": "f", "position_m": [0, 0, 0.5], "direction": [0, 0, 1],
                       "up": [0, 1, 0], "width_m": 0.8, "height_m": 0.6, "scale": [1, 1, 1]}},
    "laboratory": {"cameras": {"c": {"url": "sim://", "codes_per_radiance_s": 100000, "white": 4095,
        "world_from_camera": {"rotation": [0, 1, 0, 0], "translation_m": [0, 0, 1.3]}}},
      "screens": {"lcd": {"url": "sim://", "kind": "lcd", "width_px": 4, "height_px": 3}}}})",
                                  "lab.json", folder);
}

// Of the rows in the middle, from one column to another.
double mean_of_columns(const RawFrame& frame, int from, int to) {
  double sum = 0;
  for (int y = 3; y < 9; ++y)
    for (int x = from; x < to; ++x) sum += frame.samples[static_cast<std::size_t>(16 * y + x)];
  return sum / (6 * (to - from));
}

// A monitor faces the camera; what it shows is seen, and the picture is that of the laboratory within one program.
TEST(Served, AScreenShowsTheCameraItsPictures) {
  const tests::ScratchFolder folder;
  const auto picture = [&](const char* name, const std::vector<float>& greys) {
    io::Image image(4, 3, {"Y"});
    for (std::size_t i = 0; i < image.data.size(); ++i) image.data[i] = greys[i % 4 < 2 ? 0 : 1];
    write_file(folder / name, io::encode_raster_png(image));
    return (folder / name).string();
  };
  const std::string left = picture("left.png", {1, 0}), right = picture("right.png", {0, 1});
  const manifest::Document lab = before_a_screen(folder.path());
  ServeOptions options;
  options.desk.spp = 4;
  const Instrument inside = desk_instrument(lab, nullptr, options.desk);
  const ServedLaboratory served(lab, nullptr, nullptr, options);
  const Instrument outside = open_instrument(served.description());
  const Shot shot{0.01, {}};
  const RawFrame dark = outside.cameras.at("c")->take(shot);
  EXPECT_LT(mean_of_columns(dark, 0, 16), 5);
  for (const auto& [path, brighter] : {std::pair{left, true}, {right, false}}) {
    inside.screens.at("lcd")->show(path);
    outside.screens.at("lcd")->show(path);
    const RawFrame seen = outside.cameras.at("c")->take(shot);
    EXPECT_EQ(seen.samples, inside.cameras.at("c")->take(shot).samples);
    const double a = mean_of_columns(seen, 2, 6), b = mean_of_columns(seen, 10, 14);
    EXPECT_GT(brighter ? a : b, 900);  // 1 W/(m^2 sr) is 1000 codes
    EXPECT_LT(brighter ? b : a, 100);
  }
  outside.screens.at("lcd")->show("");
  EXPECT_LT(mean_of_columns(outside.cameras.at("c")->take(shot), 0, 16), 5);
  io::Image small(3, 3, {"Y"});
  write_file(folder / "small.png", io::encode_raster_png(small));
  try {
    outside.screens.at("lcd")->show((folder / "small.png").string());
    ADD_FAILURE() << "a picture of another size was shown";
  } catch (const Error& error) {
    EXPECT_THAT(error.problem(), testing::HasSubstr("has 3 x 3 pixels, screen lcd has 4 x 3"));
  }
}

TEST(Served, WhatCannotBeServedIsSaidInOneLine) {
  const tests::ScratchFolder folder;
  write_small_laboratory(folder.path());
  const auto refused = [&](const Process::Words& words, int status) {
    const auto ended = tests::run(words, folder.path());
    EXPECT_EQ(ended.status, status) << ended.err;
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
    EXPECT_TRUE(ended.out.empty());
    return ended.err;
  };
  EXPECT_THAT(refused({"acquire", "--serve", "lab.json", "--faults", "lamp-dork=1%"}, 64),
              testing::AllOf(testing::HasSubstr("\"lamp-dork\" is no fault"), testing::HasSubstr("lamp-dark")));
  EXPECT_THAT(refused({"acquire", "--serve", "lab.json", "--faults", "lamp-dark=3"}, 64),
              testing::HasSubstr("is no probability"));
  Serving server(folder.path(), {"--port", "0"});
  const std::string description = read_file(folder / "served.json");
  const auto at = description.find("modbus://127.0.0.1:") + 19;
  EXPECT_THAT(refused({"acquire", "--serve", "lab.json", "--port", std::to_string(std::atoi(&description[at]))}, 69),
              testing::HasSubstr("the port is taken"));
  manifest::Document other = manifest::read_document(folder / "served.json");
  other.laboratory.entry.front().cameras.at("camera").pixel_format = "Polarized8";
  write_file(folder / "other.json", manifest::print_document(other, folder.path()));
  EXPECT_THAT(tests::run({"acquire", "other.json", "--plan", views, "--go", "--out", "no"}, folder.path()).err,
              testing::HasSubstr("has no pixel format Polarized8; it has Mono8, Mono10, Mono12, Mono16"));
  EXPECT_EQ(server.interrupt().status, 0);
}

// Bits laid out by the camera and taken apart by the driver's own unpack(); gains, exposures and numbers come back.
TEST(GigeCamera, EveryFormatArrivesAsItWasSent) {
  desk::Faults faults;
  const auto code = [](int i, int bits) { return static_cast<std::uint16_t>((i * 2654435761U >> 7U) % (1U << bits)); };
  Shot heard;
  desk::GigeCamera served(
      {.name = "c", .width_px = 33, .height_px = 20, .format = *parse_pixel_format("BayerRG12")},
      [&](const Shot& shot, const PixelFormat& format) {
        heard = shot;
        RawFrame frame;
        frame.width_px = 33;
        frame.height_px = 20;
        for (int i = 0; i < 33 * 20; ++i) frame.samples.push_back(code(i, format.bits));
        return frame;
      },
      faults);
  const std::string url = "genicam://" + served.address() + "?timeout=5s&pixel_format=";
  for (const desk::GigeFormat& format : desk::gige_formats("BayerRG")) {
    const auto camera = open_camera(url + format.name, "here");
    const auto parsed = *parse_pixel_format(format.name);
    for (const double exposure_s : {0.001, 0.007}) {
      const RawFrame frame = tests::whole_frame(*camera, {exposure_s, 2.25});
      EXPECT_EQ(frame.pixel_format, parsed.unpacked());
      EXPECT_EQ(frame.exposure_s, exposure_s);
      EXPECT_EQ(frame.gain_db, 2.25);
      EXPECT_EQ(heard.exposure_s, exposure_s);
      EXPECT_EQ(heard.gain_db, 2.25);
      EXPECT_EQ(frame.chunk_frame_id, frame.frame_id);
      ASSERT_EQ(frame.samples.size(), 660U);
      for (int i = 0; i < 660; ++i) ASSERT_EQ(frame.samples[i], code(i, parsed.bits)) << format.name << " " << i;
    }
  }
}

// The stream of another camera to somebody else on this machine, who is not there: every packet passes the interface.
class OtherStream {
 public:
  OtherStream() : socket_(::socket(AF_INET, SOCK_DGRAM, 0)), sender_([this] { send(); }) {}
  ~OtherStream() {
    ending_ = true;
    sender_.join();
    ::close(socket_);
  }

 private:
  void send() {
    sockaddr_in nobody{};
    nobody.sin_family = AF_INET;
    nobody.sin_port = htons(9);
    nobody.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    for (std::uint64_t id = 1; !ending_; id = id % 50 + 1)
      for (const auto& packet : desk::packets_of({id, id, 0x01100005, 33, 10, std::string(660, 'x')}, {}, 1400))
        ::sendto(socket_, packet.data(), packet.size(), 0, reinterpret_cast<const sockaddr*>(&nobody), sizeof nobody);
  }
  int socket_;
  std::atomic<bool> ending_{false};
  std::thread sender_;
};

TEST(GigeCamera, FramesOfOtherCamerasThatPassAreNotTaken) {
  desk::Faults faults;
  desk::GigeCamera served(
      {.name = "c", .width_px = 33, .height_px = 20, .format = *parse_pixel_format("BayerRG12")},
      [](const Shot&, const PixelFormat&) {
        RawFrame frame;
        frame.width_px = 33;
        frame.height_px = 20;
        frame.samples.assign(660, 7);
        return frame;
      },
      faults);
  const OtherStream other;
  int whole = 0;  // a packet may be lost on a busy machine
  for (int i = 0; i < 15; ++i) {
    const auto camera = open_camera("genicam://" + served.address() + "?timeout=2s&pixel_format=BayerRG12p", "here");
    const RawFrame frame = camera->take({0.001, {}});
    whole += frame.incomplete_packets == 0;
    if (frame.incomplete_packets == 0) {
      EXPECT_EQ(frame.samples, std::vector<std::uint16_t>(660, 7));
    }
  }
  EXPECT_GE(whole, 12);
}

TEST(GigeCamera, WhatIsWrongWithAFrameShows) {
  desk::Faults faults;
  desk::GigeCamera served(
      {.name = "c", .width_px = 200, .height_px = 100, .format = *parse_pixel_format("Mono16")},
      [&](const Shot&, const PixelFormat&) {
        RawFrame frame;
        frame.width_px = 200;
        frame.height_px = 100;
        frame.samples.assign(20000, 7);
        return frame;
      },
      faults);
  const auto camera = open_camera("genicam://" + served.address() + "?timeout=1s", "here");
  EXPECT_EQ(tests::whole_frame(*camera, {0.001, {}}).incomplete_packets, 0);
  faults.set(desk::Fault::chunk_late, 1);
  const RawFrame late = camera->take({0.004, {}});
  EXPECT_EQ(late.chunk_frame_id, late.frame_id - 1);
  EXPECT_EQ(late.exposure_s, 0.001);
  faults.set(desk::Fault::chunk_late, 0);
  faults.set(desk::Fault::stuck_exposure, 1);
  EXPECT_EQ(tests::whole_frame(*camera, {0.002, {}}).exposure_s, 0.004);
  faults.set(desk::Fault::stuck_exposure, 0);
  faults.set(desk::Fault::frame_reordered, 1);
  EXPECT_EQ(tests::whole_frame(*camera, {0.002, {}}).samples, std::vector<std::uint16_t>(20000, 7));
  faults.set(desk::Fault::trigger_lost, 1);
  EXPECT_THROW(camera->take({0.002, {}}), Error);
}

}  // namespace
}  // namespace gonio::acquisition
