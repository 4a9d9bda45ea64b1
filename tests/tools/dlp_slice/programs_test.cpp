// dlp-slice and its neighbours in the pipe: bodies to layers to surfaces to figures, and back.
#include "dlp_slice_fixture.h"
#include "io/height_map.h"
#include "io/ply.h"
#include "manifest/sections/relief.h"
#include "print/archive.h"

namespace gonio::tests {
namespace {

TEST_F(DlpSlice, LayersHoldTheBody) {
  const Ended ended = sliced({});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const manifest::Document d = document("out.json");
  const manifest::Print& print = d.prints.at("bench");
  EXPECT_EQ(print.figures.at("printed_layers"), 5);
  EXPECT_NEAR(print.figures.at("volume_m3"), 1.2e-3 * 0.8e-3 * 0.09e-3, 1e-17);
  EXPECT_NEAR(print.figures.at("time_s"), 2 * 20 + 3 * 3 + 5 * 4, 1e-9);
  ASSERT_EQ(print.parts.size(), 1u);
  EXPECT_NEAR(*print.parts[0].facing_m2, 1.2e-3 * 0.8e-3, 1e-12);
  const auto archive = print::open_archive(path("out/layers.sl1s"));
  ASSERT_EQ(archive->layers(), 5u);
  std::vector<std::uint8_t> picture(200 * 160);
  archive->read(4, picture);
  const auto full = static_cast<int>(std::lround(255 * 0.99));  // white grows a little more than a layer
  EXPECT_EQ(std::count(picture.begin(), picture.end(), full), 120 * 80);
  EXPECT_EQ(picture[static_cast<std::size_t>(40 * 200 + 40)], full);
  EXPECT_EQ(picture[static_cast<std::size_t>(39 * 200 + 40)], 0);
}

TEST_F(DlpSlice, TheSameBytesForAnyNumberOfThreads) {
  const Words noise{"--structure", "noise:amplitude=2,frequency=16", "--predict", "--ground", "published"};
  Words one = noise, three = noise;
  one.insert(one.end(), {"--threads", "1"}), three.insert(three.end(), {"--threads", "3"});
  ASSERT_EQ(sliced(one, "a").status, 0);
  ASSERT_EQ(sliced(three, "b").status, 0);
  for (const char* file : {"layers.sl1s", "predicted.x3p", "predicted.ply", "box.ply", "report.html"})
    EXPECT_EQ(read_file(path("a") / file), read_file(path("b") / file)) << file;
}

// What is predicted from the archive: the body's top where it was flat; mirrored displays change nothing.
TEST_F(DlpSlice, APredictionIsWhatWasAskedFor) {
  ASSERT_EQ(sliced({"--structure", "expression:x_m>0 ? 0.8 : 0.4", "--predict", "--mirror", "x"}).status, 0);
  ASSERT_EQ(call({"--sent", "out/layers.sl1s", "--printer", "printer.json", "--mirror", "x", "--out", "again", "-o",
                  "again.json"})
                .status,
            0);
  EXPECT_EQ(read_file(path("out/predicted.x3p")), read_file(path("again/predicted.x3p")));
  const io::HeightMap map = io::read_height_map(path("out/predicted.x3p"));
  const auto middle = map.height / 2;
  EXPECT_NEAR(map.at(map.width / 2 + 20, middle), 72e-6 + 0.8 * 18e-6, 0.1e-6);
  EXPECT_NEAR(map.at(map.width / 2 - 20, middle), 72e-6 + 0.4 * 18e-6, 0.1e-6);
}

TEST_F(DlpSlice, FiguresOfThePredictionComeThroughThePipe) {
  ASSERT_EQ(sliced({"--structure", "noise:amplitude=3,frequency=16", "--predict", "--points", "2", "--window",
                    "-0.5mm,-0.3mm,1mm,0.6mm"})
                .status,
            0);
  const Ended measured =
      run({"roughness", "--relief", "predicted", "-i", "out.json", "-o", "rough.json"}, folder_.path());
  ASSERT_EQ(measured.status, 0) << measured.err;
  const double sq = document("rough.json").reliefs.at("predicted").parameters.at("Sq").value;
  EXPECT_GT(sq, 2e-6);
  EXPECT_LT(sq, 8e-6);
}

// A wish is met by a structure that, printed again by hand, has the figure.
TEST_F(DlpSlice, AWishIsMetByAPrintOfItsStructure) {
  ASSERT_EQ(call({"--wish", "sq=2um", "--printer", "printer.json", "--out", "wish", "-o", "wish.json"}).status, 0);
  const manifest::Print print = document("wish.json").prints.at("bench");
  EXPECT_NEAR(print.figures.at("reached_sq_m"), 2e-6, 0.1e-6);
  const manifest::MicrostructureUse& use = print.microstructures.at("wished");
  std::string spec = use.model + ":";
  for (const auto& [name, value] : use.parameters)
    spec += (spec.back() == ':' ? "" : ",") + name + "=" + std::to_string(value.scalar());
  ASSERT_EQ(sliced({"--structure", spec, "--predict", "--points", "2", "--window", "-0.5mm,-0.3mm,1mm,0.6mm"}).status,
            0);
  ASSERT_EQ(run({"roughness", "--relief", "predicted", "-i", "out.json", "-o", "rough.json"}, folder_.path()).status,
            0);
  EXPECT_NEAR(document("rough.json").reliefs.at("predicted").parameters.at("Sq").value, 2e-6, 0.4e-6);
}

TEST_F(DlpSlice, WhatNothingReachesIsSaid) {
  const Ended ended =
      run({"dlp-slice", "--wish", "sq=30um", "--printer", "printer.json", "--out", "wish"}, folder_.path());
  EXPECT_EQ(ended.status, 2);
  EXPECT_THAT(ended.err, testing::HasSubstr("wished 30 um"));
}

// Print, measure, fit: the sample's own prediction is measured, and the growth that it was printed with comes back.
TEST_F(DlpSlice, TheCalibrationSampleGivesTheGrowth) {
  write_file(path("large.json"),
             R"({"gonio": 1, "prints": {"large": {"pixel_m": [1.5e-5, 1.5e-5], "width_px": 1300, "height_px": 700,
      "layer_m": 1.8e-5, "growth": {"alpha_m": 1.8e-5, "beta_m": 0.9e-5, "gamma": -0.012}, "ground": "quiet"}},
      "ground_noises": {"quiet": {"parts": [{"sq_m": 0.3e-6, "cell_m": 3e-5}]}}})");
  ASSERT_EQ(call({"--calibration-sample", "--slab-layers", "2", "--repetitions", "12", "--printer", "large.json",
                  "--out", "s", "--predict", "--window", "0mm,-2mm,8mm,7mm", "-o", "s.json"})
                .status,
            0);
  write_file(path("unknown.json"),
             R"({"gonio": 1, "prints": {"large": {"pixel_m": [1.5e-5, 1.5e-5], "width_px": 1300, "height_px": 700,
      "layer_m": 1.8e-5}}})");
  const io::HeightMap map = io::read_height_map(path("s/predicted.x3p"));
  ASSERT_GT(map.width, 300u);
  // The window's lower left corner is the map's: x of its first point, y of its last.
  const std::string at = std::to_string(7.5e-3) + "mm," +
                         std::to_string((-2e-3 + 7.5e-6 + (static_cast<double>(map.height) - 1) * 15e-6) * 1e3) + "mm";
  const Ended fit = call({"--growth-from", "s/predicted.x3p", "--map-at", at, "--printer", "unknown.json",
                          "--repetitions", "12", "--slab-layers", "2", "-o", "fit.json"});
  ASSERT_EQ(fit.status, 0) << fit.err;
  const manifest::PrintGrowth growth = document("fit.json").prints.at("large").growth.value();
  EXPECT_NEAR(growth.alpha_m, 1.8e-5, 0.3e-6);
  EXPECT_NEAR(growth.beta_m, 0.9e-5, 0.6e-6);
  EXPECT_GT(growth.sigma.at("alpha_m")[0], 0);
}

TEST_F(DlpSlice, RaysAgreeWithClipping) {
  ASSERT_EQ(sliced({"--turn", "10deg"}, "exact").status, 0);
  ASSERT_EQ(sliced({"--turn", "10deg", "--coverage", "rays", "--rays", "64"}, "rays").status, 0);
  EXPECT_NEAR(document("rays.json").prints.at("bench").figures.at("volume_m3") /
                  document("exact.json").prints.at("bench").figures.at("volume_m3"),
              1, 1e-3);
}

}  // namespace
}  // namespace gonio::tests
