// color-calib as people run it: a photograph of a chart in, a correction out; and develop, which applies it. The
// programs are those of GONIO_BIN.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <sstream>

#include "base/atomic_file.h"
#include "base/text.h"
#include "colour/chart_photograph.h"
#include "colour/correction.h"
#include "colour/patch_readings.h"
#include "data.h"
#include "io/codes.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/sections/colour_correction.h"
#include "manifest/sections/image.h"
#include "manifest/sections/table.h"
#include "process.h"

namespace gonio::tests {
namespace {

using testing::HasSubstr;
using Words = Process::Words;

constexpr int width = 480, height = 320;

class ColorCalib : public testing::Test {
 protected:
  ColorCalib() {
    photograph_.pose = colour::pose_from_corners({Vec2{90, 60}, {400, 40}, {420, 270}, {70, 250}}, "test");
    photograph_.exposure = 40, photograph_.read = 0.1, photograph_.blur_px = 0.6,
    photograph_.room = colour::cluttered_room(1, width, height);
    picture_ = colour::photograph_of(chart_, photograph_, width, height);
    io::write_picture(folder_ / "chart.exr", picture_);
  }
  Ended calib(Words words) const {
    words.insert(words.begin(), "color-calib");
    return run(words, folder_.path());
  }
  manifest::ColourCorrection section(const Ended& ended, const std::string& name = "camera") const {
    EXPECT_EQ(ended.status, 0) << ended.err;
    return manifest::parse_document(ended.out, "out", folder_.path()).colour.at(name);
  }
  ScratchFolder folder_;
  colour::Chart chart_ = colour::colorchecker_classic("after-2014", "test");
  colour::ChartSpecimen photograph_;
  io::Image picture_;
};

TEST_F(ColorCalib, FindsTheChartAndTheCamera) {
  const Ended ended = calib({"chart.exr", "--preview", "preview.png", "--to", "srgb"});
  const auto found = section(ended);
  EXPECT_EQ(found.to, "srgb");
  EXPECT_LT(*found.held_out_de00, 0.5);
  EXPECT_LT(*found.exposure_de00, 1e-6);
  EXPECT_GT(*found.noise_gain, 0.5);
  EXPECT_EQ(found.patches.size(), 24u);
  EXPECT_EQ(found.alternatives.size(), 6u);
  EXPECT_EQ(found.covariance.size(), 3 * found.matrix[0].size());
  EXPECT_NEAR(found.corners_px[0], 90, 2);
  EXPECT_NEAR(found.corners_px[5], 270, 2);
  for (const char* words : {"colorchecker-24 found", "held out", "exposures of 0.1 to 10 times", "noise is amplified",
                            "disagree most", "offset", "light changes by"})
    EXPECT_THAT(ended.err, HasSubstr(words));
  EXPECT_EQ(io::read_picture(folder_ / "preview.png").width, 2 * width);
  EXPECT_EQ(calib({"chart.exr", "--preview", "preview.png", "--to", "srgb"}).out, ended.out);
}

// Readings as they are, before anything was taken off: explain asks them.
TEST_F(ColorCalib, LeavesReadingsThatExplainAsks) {
  photograph_.offset = {0.012, 0.012, 0.012};
  io::write_picture(folder_ / "veiled.exr", colour::photograph_of(chart_, photograph_, width, height));
  const Ended ended = calib({"veiled.exr", "-o", "veiled.json"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const auto document = manifest::read_document(folder_ / "veiled.json");
  const manifest::Table& table = document.tables.at("camera-chart");
  EXPECT_EQ(table.model, "chart");
  ASSERT_EQ(table.rows.as_array().size(), 24u);
  const auto& black = table.rows.as_array().back().as_array();
  ASSERT_EQ(black.size(), table.columns.size());
  for (std::size_t c = 0; c < table.columns.size(); ++c)
    if (table.columns[c].first == "G") {
      const double expected = read_of(photograph_, chart_.patches.back()).y + 0.012 * photograph_.exposure;
      EXPECT_NEAR(black[c].as_number(), expected, 0.02 * expected);
    }
  const Ended explained = run({"explain", "veiled.json"}, folder_.path());
  EXPECT_EQ(explained.status, 0) << explained.err;
  EXPECT_THAT(explained.err, HasSubstr("sensor.black-offset"));
}

TEST_F(ColorCalib, TakesCornersAndAModel) {
  const auto searched = section(calib({"chart.exr", "--model", "linear"})),
             given = section(calib({"chart.exr", "--model", "linear", "--corners", "90,60 400,40 420,270 70,250"}));
  EXPECT_EQ(given.model, "linear");
  EXPECT_EQ(given.alternatives.size(), 1u);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) EXPECT_NEAR(given.matrix[i][j], searched.matrix[i][j], 0.02);
}

// Colours of other pictures of the same camera, longer exposed, come out as the chart's references; variance with them.
TEST_F(ColorCalib, DevelopAppliesIt) {
  photograph_.exposure = 120, photograph_.read = 0;
  io::Image longer = colour::photograph_of(chart_, photograph_, width, height);
  io::Image scene(width, height, {"R", "G", "B", "variance.R", "variance.G", "variance.B"});
  for (std::size_t i = 0; i < longer.pixels(); ++i)
    for (std::size_t c = 0; c < 3; ++c) scene.data[6 * i + c] = longer.data[3 * i + c], scene.data[6 * i + 3 + c] = 4;
  io::write_picture(folder_ / "scene.exr", scene);
  const Ended calibrated = calib({"chart.exr", "-o", "colour.json"});
  ASSERT_EQ(calibrated.status, 0) << calibrated.err;
  const Ended developed =
      run({"develop", "--colour", "camera", "--out", "d", "-i", "colour.json", "scene.exr"}, folder_.path());
  ASSERT_EQ(developed.status, 0) << developed.err;
  const auto document = manifest::parse_document(developed.out, "out", folder_.path());
  ASSERT_EQ(document.images.size(), 1u);
  EXPECT_TRUE(document.cameras.empty());
  const io::Image colours = io::read_picture(manifest::resolve(document, document.images[0].file, "test"));
  ASSERT_EQ(colours.channels.size(), 6u);
  const auto readings = colour::read_patches(colours, {}, photograph_.pose, chart_, "test");
  for (std::size_t p = 0; p < 24; ++p) {
    const Rgb wanted = colour::from_xyz_d50(colour::Target::cie_rgb) * chart_.patches[p].xyz * 3;
    EXPECT_LT(norm(readings[p].rgb - wanted), 0.03 + 0.02 * norm(wanted)) << chart_.patches[p].name;
  }
  EXPECT_NE(colours.at(5, 5, colours.channel("variance.G")), 4);
  ASSERT_EQ(document.images[0].developed.size(), 1u);
  EXPECT_EQ(document.images[0].developed[0].step, "colour");
  EXPECT_EQ(document.images[0].developed[0].by, "camera");
  write_file(folder_ / "colours.json", developed.out);
  for (const char* picture : {"", "d/scene.exr"}) {
    std::vector<std::string> words = {"develop", "--colour", "camera", "--out", "e", "-i", "colours.json"};
    if (*picture != 0) words.push_back(picture);
    const Ended again = run(words, folder_.path());
    EXPECT_EQ(again.status, 65);
    EXPECT_THAT(again.err, HasSubstr("is corrected already (developed: colour by camera)"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "e/scene.exr"));
  }
  const Ended unknown =
      run({"develop", "--colour", "other", "--out", "e", "-i", "colour.json", "scene.exr"}, folder_.path());
  EXPECT_EQ(unknown.status, 65);
  EXPECT_THAT(unknown.err, HasSubstr("has no \"other\"; there is camera"));
}

// Radiance stays radiance: all colours as they are with white at 1, times what green read of a perfect white.
TEST_F(ColorCalib, DevelopKeepsTheLevelWhereAsked) {
  const Ended calibrated = calib({"chart.exr", "-o", "colour.json"});
  ASSERT_EQ(calibrated.status, 0) << calibrated.err;
  const auto colours = [&](const std::string& white) {
    const Ended developed = run({"develop", "--colour", "camera", "--white", white, "--out", "white-" + white, "-i",
                                 "colour.json", "chart.exr"},
                                folder_.path());
    EXPECT_EQ(developed.status, 0) << developed.err;
    const auto document = manifest::parse_document(developed.out, "out", folder_.path());
    return io::read_picture(manifest::resolve(document, document.images[0].file, "test"));
  };
  const double level = manifest::read_document(folder_ / "colour.json").colour.at("camera").white[1];
  ASSERT_GT(level, 2);
  const io::Image one = colours("1"), green = colours("green");
  for (std::size_t i = 0; i < one.data.size(); i += 97)
    EXPECT_NEAR(green.data[i], level * one.data[i], 1e-5 * (level + std::abs(green.data[i])));
  const Ended alone =
      run({"develop", "--merge", "--white", "green", "--out", "x", "-i", "colour.json"}, folder_.path());
  EXPECT_EQ(alone.status, 64) << alone.err;
}

TEST_F(ColorCalib, ReadsCodesAndImagesOfAManifest) {
  io::Image codes = picture_;
  for (float& v : codes.data) v = io::srgb_from_linear(v / 45);
  io::write_png(folder_ / "chart.png", codes, 16);
  EXPECT_LT(*section(calib({"chart.png", "--response", "srgb"})).held_out_de00, 0.6);
  write_file(folder_ / "in.json", R"({"gonio": 1, "files": {"f": {"path": "chart.exr"}}, "cameras": {"left": {"model":
    "pinhole", "width_px": 480, "height_px": 320, "fx_px": 500, "fy_px": 500, "cx_px": 240, "cy_px": 160}},
    "images": [{"id": "a", "file": "f", "camera": "left"}]})");
  const auto found = section(calib({"in.json"}), "left");
  EXPECT_EQ(found.camera, "left");
  EXPECT_EQ(found.image, "a");
}

TEST_F(ColorCalib, NamesClippedPatchesAndGoesOn) {
  const Ended ended = calib({"chart.exr", "--saturation", "35"});
  const auto found = section(ended);
  EXPECT_THAT(ended.err, HasSubstr("left out: white (clipped)"));
  EXPECT_EQ(found.patches[18].left_out, "clipped");
  EXPECT_LT(*found.held_out_de00, 0.6);
}

TEST_F(ColorCalib, EndsWithTwoWhereItIsNotGoodEnough) {
  const Ended ended = calib({"chart.exr", "--edition", "before-2014", "--accept", "0.1"});
  EXPECT_EQ(ended.status, 2) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("\"colour\""));
}

TEST_F(ColorCalib, SaysWhatNoCorrectionCanMend) {
  write_file(folder_ / "sensor.csv",
             "nm,R,G,B\n400,0,0,0.5\n450,0,0.1,1\n500,0,0.6,0.3\n550,0.1,1,0\n600,1,0.3,0\n"
             "650,0.6,0,0\n700,0.1,0,0\n");
  const auto day = section(calib({"chart.exr", "--sensor", "sensor.csv"})),
             lamp = section(calib({"chart.exr", "--sensor", "sensor.csv", "--light", "A"}));
  EXPECT_GT(*day.metamerism_de00, 0.3);
  EXPECT_GT(std::abs(*lamp.metamerism_de00 - *day.metamerism_de00), 1e-3);
  EXPECT_EQ(calib({"chart.exr", "--sensor", "chart.exr"}).status, 65);
}

TEST_F(ColorCalib, TakesAnotherChart) {
  std::string patches;
  for (const colour::Patch& p : chart_.patches)
    patches += format(R"(%s{"name": "%s", "lab": [%.4f, %.4f, %.4f]})", patches.empty() ? "" : ", ", p.name.c_str(),
                      p.lab.x, p.lab.y, p.lab.z);
  write_file(folder_ / "own.json",
             R"({"name": "own", "grid": [6, 4], "patch_share": 0.87, "patches": [)" + patches + "]}");
  const auto found = section(calib({"chart.exr", "--chart", "own.json"}));
  EXPECT_EQ(found.chart, "own");
  EXPECT_LT(*found.held_out_de00, 0.5);
}

// A raw photograph of a ColorChecker Passport before a window, glare on it, read by other software: SOURCE.md.
TEST_F(ColorCalib, OfARecordedPassport) {
  GONIO_NEEDS_DATA("colour/passport_canon550d");
  const std::string raw = data("colour/passport_canon550d/colorchart.dng");
  const Ended developed = run({"develop", "--merge", "--views", "each", "--noise-gain", "2", "--out", "d", "--black",
                               "2048", raw, "-o", "radiance.json"},
                              folder_.path());
  ASSERT_EQ(developed.status, 0) << developed.err;
  const Ended ended = calib({"radiance.json", "--edition", "before-2014"});
  const auto found = section(ended);
  EXPECT_LT(*found.held_out_de00, 2.38);  // the best of the peer's
  EXPECT_LT(*found.fitted_de00, 1.97);
  ASSERT_EQ(found.offset.size(), 3u);
  EXPECT_NEAR(100 * found.offset[1], 1.4, 0.4);  // per cent of white, glare
  // Corners of half-size pixels; the peer's patch 1 lies at (358, 312), patch 24 at (628, 461).
  EXPECT_NEAR(found.corners_px[0], 2 * (358 - 26), 16);
  EXPECT_NEAR(found.corners_px[4], 2 * (628 + 26), 16);
}

// The same, with measured reflectances of a chart's patches and the curves of a camera of the same sensor: what they do
// to colours goes into the table, and explain finds it in the photograph, beside the glare.
TEST_F(ColorCalib, ReflectancesAndCurvesTellExplainOfMetamerism) {
  GONIO_NEEDS_DATA("colour/passport_canon550d");
  GONIO_NEEDS_DATA("colour/camera_sensitivities");
  std::string nm, line;
  std::array<std::string, 24> reflectance;
  std::ifstream measured(data("colour/colorchecker-reference/data_babelcolor_average_reflectance.csv"));
  for (std::getline(measured, line); std::getline(measured, line);) {
    std::istringstream cells(line);
    std::string cell;
    std::getline(cells, cell, ',');
    nm += (nm.empty() ? "" : ", ") + cell;
    for (std::string& patch : reflectance) std::getline(cells, cell, ','), patch += (patch.empty() ? "" : ", ") + cell;
  }
  std::string patches;
  for (std::size_t p = 0; p < 24; ++p)
    patches += (p == 0 ? "" : ", ") + format(R"({"name": "%zu", "reflectance": [%s]})", p + 1, reflectance[p].c_str());
  write_file(folder_ / "spectra.json",
             R"({"name": "spectra", "grid": [6, 4], "patch_share": 0.87, "wavelengths_nm": [)" + nm +
                 R"(], "patches": [)" + patches + "]}");
  const std::string raw = data("colour/passport_canon550d/colorchart.dng"),
                    curves = data("colour/camera_sensitivities/Canon_600D_camspec_Canon_600D.csv");
  ASSERT_EQ(run({"develop", "--merge", "--views", "each", "--noise-gain", "2", "--out", "d", "--black", "2048", raw,
                 "-o", "radiance.json"},
                folder_.path())
                .status,
            0);
  const Ended ended = calib({"radiance.json", "--chart", "spectra.json", "--sensor", curves, "-o", "colour.json"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const auto document = manifest::read_document(folder_ / "colour.json");
  ASSERT_EQ(document.tables.size(), 1u);
  const auto& columns = document.tables.begin()->second.columns;
  EXPECT_NE(std::ranges::find(columns, "sensed_R", &std::pair<std::string, std::string>::first), columns.end());
  const Ended explained = run({"explain", "colour.json"}, folder_.path());
  EXPECT_THAT(explained.err, HasSubstr("colour.metamerism")) << explained.err;
}

}  // namespace
}  // namespace gonio::tests
