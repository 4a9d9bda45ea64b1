// What people give color-calib by mistake: the right exit status, one line that says what is wrong, nothing written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "base/atomic_file.h"
#include "colour/chart_specimen.h"
#include "data.h"
#include "io/picture.h"
#include "process.h"

namespace gonio::tests {
namespace {

namespace fs = std::filesystem;
using Words = Process::Words;

class ColorCalibRefuses : public testing::Test {
 protected:
  ColorCalibRefuses() {
    photograph_.pose = colour::pose_from_corners({Vec2{60, 40}, {260, 40}, {260, 170}, {60, 170}}, "test");
    picture_ = colour::photograph_of(chart_, photograph_, 320, 213);
    io::write_picture(folder_ / "chart.exr", picture_);
  }
  std::set<fs::path> files() const {
    std::set<fs::path> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path())) names.insert(entry.path());
    return names;
  }
  void expect(const Words& words, int status, const std::string& mentions) const {
    Words all{"color-calib", "--log-level", "error"};
    all.insert(all.end(), words.begin(), words.end());
    const auto before = files();
    const Ended ended = run(all, folder_.path());
    EXPECT_EQ(ended.status, status) << ended.err;
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
    EXPECT_THAT(ended.err, testing::StartsWith("color-calib: "));
    EXPECT_THAT(ended.err, testing::HasSubstr(mentions));
    EXPECT_EQ(ended.out, "");
    EXPECT_EQ(files(), before);
  }
  void write(const std::string& name, const io::Image& image) const { io::write_picture(folder_ / name, image); }
  ScratchFolder folder_;
  colour::Chart chart_ = colour::colorchecker_classic("after-2014", "test");
  colour::ChartSpecimen photograph_;
  io::Image picture_;
};

TEST_F(ColorCalibRefuses, WordsThatSayNothing) {
  expect({}, 66, "has no photograph of a chart");
  expect({"missing.exr"}, 66, "missing.exr");
  expect({"chart.exr", "--model", "cubic"}, 64, "--model");
  expect({"chart.exr", "--edition", "1976"}, 64, "--edition");
  expect({"chart.exr", "--to", "cmyk"}, 64, "--to");
  expect({"chart.exr", "--chart", "passport"}, 64, "is no chart that is known: passport");
  expect({"chart.exr", "--light", "A"}, 64, "is for charts whose file has reflectances");
  expect({"chart.exr", "--preview", "p.jpg"}, 64, "is no PNG: p.jpg");
  expect({"chart.exr", "--image", "a"}, 64, "is for manifests");
  expect({"chart.exr", "--accept", "-1"}, 64, "--accept");
}

TEST_F(ColorCalibRefuses, CornersThatAreNone) {
  expect({"chart.exr", "--corners", "60,40 260,40 260,170"}, 64, "are 6 numbers, needs 8");
  expect({"chart.exr", "--corners", "a,b c,d e,f g,h"}, 64, "holds what is no number");
  expect({"chart.exr", "--corners", "60,40 60,170 260,170 260,40"}, 64, "counter-clockwise, as in a mirrored picture");
  expect({"chart.exr", "--corners", "60,40 260,170 260,40 60,170"}, 64, "convex quadrilateral");
  expect({"chart.exr", "--corners", "60,40 360,40 360,170 60,170"}, 65, "reaches out of the picture");
  expect({"chart.exr", "--corners", "260,170 60,170 60,40 260,40"}, 65, "begin at another corner than the first patch");
  expect({"chart.exr", "--corners", "60,40 75,40 75,50 60,50"}, 65, "limit 16");
}

TEST_F(ColorCalibRefuses, PicturesWithoutAChart) {
  write("grey.exr", io::Image(64, 48, {"Y"}));
  expect({"grey.exr"}, 65, "has one channel");
  write("black.exr", io::Image(64, 48, {"R", "G", "B"}));
  expect({"black.exr"}, 65, "shows no grid of patches");
  write("codes.png", picture_);
  expect({"codes.png"}, 65, "whose response is not stated");
  io::Image nan = picture_;
  for (float& v : nan.data) v = std::numeric_limits<float>::quiet_NaN();
  write("nan.exr", nan);
  expect({"nan.exr"}, 65, "shows no grid of patches");
  expect({"nan.exr", "--corners", "60,40 260,40 260,170 60,170"}, 65, "shows no patch that can be used");
  photograph_.pose = colour::pose_from_corners({Vec2{60, 40}, {84, 40}, {84, 56}, {60, 56}}, "test");
  write("small.exr", colour::photograph_of(chart_, photograph_, 320, 213));
  expect({"small.exr"}, 65, "shows no");
  write_file(folder_ / "text.exr", "no picture");
  expect({"text.exr"}, 65, "text.exr");
}

TEST_F(ColorCalibRefuses, ChartsThatAreClippedMaskedOrUneven) {
  expect({"chart.exr", "--saturation", "0.001"}, 65, "shows no patch that can be used");
  io::Image none(320, 213, {"Y"});
  write("none.png", none);
  expect({"chart.exr", "--mask", "none.png"}, 65, "shows no patch that can be used");
  write("other.png", io::Image(32, 21, {"Y"}));
  expect({"chart.exr", "--mask", "other.png"}, 65, "has another size than the picture");
  photograph_.gradient = {1.9, 0};
  write("uneven.exr", colour::photograph_of(chart_, photograph_, 320, 213));
  expect({"uneven.exr", "--corners", "60,40 260,40 260,170 60,170"}, 65, "light it evenly");
}

TEST_F(ColorCalibRefuses, ChartFilesAndManifestsThatContradictThemselves) {
  write_file(folder_ / "five.json", R"({"name": "c", "grid": [3, 2], "patches": [{"name": "a", "lab": [50, 0, 0]}]})");
  expect({"chart.exr", "--chart", "five.json"}, 65, "are 1, and the grid has 6");
  write_file(folder_ / "broken.json", "{");
  expect({"chart.exr", "--chart", "broken.json"}, 65, "broken.json");
  expect({"chart.exr", "--chart", "absent.json"}, 66, "absent.json");
  expect({"chart.exr", "--chart", "five.json", "--edition", "after-2014"}, 64, "--edition");
  write_file(folder_ / "two.json", R"({"gonio": 1, "files": {"f": {"path": "chart.exr"}},
    "images": [{"id": "a", "file": "f"}, {"id": "b", "file": "f"}]})");
  expect({"two.json"}, 64, "--image");
  expect({"two.json", "--image", "c"}, 65, "have no \"c\" with a file");
  write_file(folder_ / "empty.json", R"({"gonio": 1})");
  expect({"empty.json"}, 65, "have no file");
}

}  // namespace
}  // namespace gonio::tests
