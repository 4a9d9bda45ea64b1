// What people give dlp-slice by mistake: the right exit status, one line, nothing written.
#include <csignal>
#include <thread>

#include "dlp_slice_fixture.h"

namespace gonio::tests {
namespace {

TEST_F(DlpSlice, MissingWordsAreAskedFor) {
  expect_refused({"--printer", "printer.json", "--out", "o"}, 64, "MESH");
  expect_refused({"box.obj", "--printer", "printer.json", "--out", "o"}, 64, "--unit");
  expect_refused({"box.obj", "--unit", "mm", "--printer", "printer.json"}, 64, "--out");
  expect_refused({"box.obj", "--unit", "mm", "--out", "o"}, 65, "describes no printer");
  expect_refused({"--growth-from", "box.obj", "--printer", "printer.json"}, 64, "--map-at");
}

TEST_F(DlpSlice, FilesThatAreNotWhatTheyShouldBe) {
  const Words rest{"--unit", "mm", "--printer", "printer.json", "--out", "o"};
  const auto refused = [&](const std::string& mesh, int status, const std::string& mentions) {
    Words words{mesh};
    words.insert(words.end(), rest.begin(), rest.end());
    expect_refused(words, status, mentions);
  };
  refused("nothing.stl", 66, "nothing.stl");
  write_file(path("empty.stl"), "");
  refused("empty.stl", 65, "empty.stl");
  write_file(path("nan.obj"), "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  refused("nan.obj", 65, "nan.obj");
  write_file(path("open.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  refused("open.obj", 65, "open.obj");
  write_file(path("index.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
  refused("index.obj", 65, "index.obj");
  write_file(path("large.obj"), box_obj(5, 1, 1));
  refused("large.obj", 65, "large.obj");
  expect_refused({"--sent", "box.obj", "--printer", "printer.json", "--out", "o"}, 65, "box.obj");
  expect_refused({"--growth-from", "box.obj", "--map-at", "0mm,0mm", "--printer", "printer.json"}, 65, "bench");
}

TEST_F(DlpSlice, PrintersThatCannotBe) {
  const auto refused = [&](const std::string& from, const std::string& to, const std::string& mentions) {
    std::string text = printer_text();
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    write_file(path("bad.json"), text.replace(at, from.size(), to));
    expect_refused({"box.obj", "--unit", "mm", "--printer", "bad.json", "--out", "o"}, 65, mentions);
  };
  refused("\"pixel_m\": [1e-5, 1e-5]", "\"pixel_m\": [1e-5]", "pixel_m");
  refused("\"pixel_m\": [1e-5, 1e-5]", "\"pixel_m\": [1e-5, -1e-5]", "pixel_m");
  refused("\"width_px\": 200", "\"width_px\": 0", "width_px");
  refused("\"layer_m\": 1.8e-5", "\"layer_m\": 0", "layer_m");
  refused("\"beta_m\": 1.024e-5", "\"beta_m\": 0", "beta_m");
  refused("\"alpha_m\": 1.8e-5", "\"alpha_m\": -1.8e-5", "no grey value cures");
  refused("\"gamma\": -0.01", "\"gamma\": -0.01, \"greys\": [0, 1]", "heights_m");
  refused("\"gamma\": -0.01", "\"gamma\": -0.01, \"greys\": [0.5, 0.5], \"heights_m\": [0, 1e-5]", "greys");
  refused("\"exposure_s\": 3", "\"exposures\": 3", "exposures");
  refused("\"process\"", "\"bleed\": {\"sigma_m\": 1e-5, \"tail_share\": 0.1}, \"process\"", "tail_m");
  refused("\"process\"", "\"ground\": \"g\", \"process\"", "ground");
}

TEST_F(DlpSlice, OptionsThatContradict) {
  const auto refused = [&](Words more, int status, const std::string& mentions) {
    Words words{"box.obj", "--unit", "mm", "--printer", "printer.json", "--out", "o"};
    words.insert(words.end(), more.begin(), more.end());
    expect_refused(words, status, mentions);
  };
  refused({"--structure", "waves"}, 64, "waves");
  refused({"--structure", "ridges:ridge_rad=20deg,pitch_m=100um"}, 65, "pitch_m");
  refused({"--structure", "picture:pixel_m=10um,file=absent.png"}, 66, "absent.png");
  refused({"--structure", "noise:label=3"}, 64, "label");
  refused({"--structure", "expression:u_m+w"}, 65, "expression");
  refused({"--axes", "texture", "--structure", "noise"}, 65, "texture");
  refused({"--axes", "direction", "--structure", "noise"}, 64, "--direction: is missing");
  refused({"--direction", "0,0,1", "--structure", "noise"}, 64, "without --axes direction");
  refused({"--axes", "direction", "--direction", "0,0,0", "--structure", "noise"}, 64, "no direction");
  refused({"--structure", "noise:stretch_m=1m"}, 65, "cells");
  refused({"--at", "1mm"}, 64, "--at");
  refused({"--at", "0mm,0mm", "--at", "1mm,0mm"}, 64, "--at");
  refused({"--layers", "1mm:18um"}, 64, "--layers");
  refused({"--layers", "0mm:0um"}, 64, "--layers");
  refused({"--window", "0mm,0mm,1mm,1mm"}, 64, "--window");
  refused({"--predict", "--window", "5mm,0mm,1mm,1mm"}, 64, "--window");
  refused({"--to", "job.xyz"}, 64, "job.xyz");
  refused({"--print", "other"}, 65, "other");
  refused({"--predict", "--ground", "absent"}, 65, "absent");
  expect_refused({"--wish", "shine=3", "--printer", "printer.json", "--out", "o"}, 64, "shine");
  expect_refused({"--wish", "sq=3", "--printer", "printer.json", "--out", "o"}, 64, "--wish");
}

// A compensation that was interrupted goes on where it was, to the same bytes.
TEST_F(DlpSlice, AnInterruptedCompensationIsTakenUp) {
  std::string text = printer_text();
  const std::size_t at = text.find("\"process\"");
  write_file(path("spread.json"), text.insert(at, R"("bleed": {"sigma_m": 6e-6}, "overcure_m": 2e-5, )"));
  write_file(path("post.obj"), box_obj(0.6, 0.4, 0.9));
  const Words words{"dlp-slice",    "post.obj",     "--unit", "mm",          "--printer", "spread.json",
                    "--compensate", "--iterations", "20",     "--log-level", "error"};
  const auto with = [&](const Words& more) {
    Words all = words;
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  Process process(with({"--out", "o", "-o", "o.json"}), folder_.path());
  for (int k = 0; k < 4000 && !fs::exists(path("o/layers.sl1s.compensated/7.png")); ++k)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  ::kill(process.id(), SIGINT);
  EXPECT_EQ(process.end().status, 75);
  EXPECT_FALSE(fs::exists(path("o/layers.sl1s")));
  ASSERT_TRUE(fs::exists(path("o/layers.sl1s.compensated/7.png")));
  const Ended resumed = run(with({"--out", "o", "-o", "o.json", "--resume"}), folder_.path());
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  const Ended whole = run(with({"--out", "w", "-o", "w.json"}), folder_.path());
  ASSERT_EQ(whole.status, 0) << whole.err;
  EXPECT_EQ(read_file(path("o/layers.sl1s")), read_file(path("w/layers.sl1s")));
  EXPECT_FALSE(fs::exists(path("o/layers.sl1s.compensated")));
}

// Ctrl-C in the middle: no archive that looks whole, exit 75.
TEST_F(DlpSlice, AnInterruptLeavesNoHalfArchive) {
  write_file(path("tall.obj"), box_obj(0.9, 0.7, 400));
  Process process({"dlp-slice", "tall.obj", "--unit", "mm", "--printer", "printer.json", "--out", "o"}, folder_.path());
  for (int k = 0; k < 2000 && !fs::exists(path("o/tall.ply")); ++k)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  ::kill(process.id(), SIGINT);
  EXPECT_EQ(process.end().status, 75);
  EXPECT_FALSE(fs::exists(path("o/layers.sl1s")));
  for (const fs::path& file : files()) EXPECT_EQ(file.string().find("layers"), std::string::npos) << file;
}

}  // namespace
}  // namespace gonio::tests
