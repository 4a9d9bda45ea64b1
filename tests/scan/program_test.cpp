// structured-light as people run it: patterns that a simulated rig photographs, points into vdi2634, and what is
// refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/atomic_file.h"
#include "base/text.h"
#include "data.h"
#include "io/codes.h"
#include "io/picture.h"
#include "io/ply.h"
#include "manifest/document.h"
#include "manifest/sections/cloud.h"
#include "process.h"
#include "scan/scan_world.h"

namespace gonio::tests {
namespace {

using testing::HasSubstr;

class StructuredLight : public testing::Test {
 protected:
  void SetUp() override {
    write_file(folder_ / "rig.json", manifest_of(world_));
    const Ended made = run({"structured-light", "--pattern", "cosine", "--size", "480x360", "--periods", "1,6,40",
                            "--shifts", "4", "--name", "cosines", "--out", "patterns", "rig.json"},
                           folder_.path());
    ASSERT_EQ(made.status, 0) << made.err;
    write_file(folder_ / "cosines.json", made.out);
  }
  // Photographs of the patterns, as the manifest has them.
  void photograph(const Pinhole& camera, const std::string& name) {
    const manifest::Document d =
        manifest::parse_document(read_file(folder_ / "cosines.json"), "cosines.json", folder_.path());
    const scan::Sequence sequence = scan::sequence_of(d, "cosines");
    const Recorder recorder(world_, camera, sequence);
    make_folder(folder_ / name);
    for (std::size_t f = 0; f < sequence.frames.size(); ++f) {
      io::Image picture(camera.width, camera.height, {"Y"});
      picture.data = recorder(f).light;
      io::write_png(folder_ / name / format("%zu.png", f), picture, 16);
    }
  }
  std::vector<std::string> pictures(const std::string& camera, int count = 24) const {
    std::vector<std::string> all;
    for (int f = count - 1; f >= 0; --f) all.push_back(camera + "/" + std::to_string(f) + ".png");
    return all;
  }
  Ended measure(std::vector<std::string> words, const std::vector<std::string>& files) {
    words.insert(words.begin(), {"structured-light", "-i", "cosines.json", "--out", "scan", "--force"});
    words.insert(words.end(), files.begin(), files.end());
    return run(words, folder_.path());
  }

  ScanWorld world_{.bits = 16};
  ScratchFolder folder_;
};

// Of a thing that is red on one side and blue on the other.
TEST_F(StructuredLight, ColourPicturesColourPoints) {
  photograph(world_.left, "left");
  for (int f = 0; f < 24; ++f) {
    const io::Image grey = io::read_picture(folder_ / "left" / (std::to_string(f) + ".png"));
    io::Image colour(grey.width, grey.height, {"R", "G", "B"});
    for (int y = 0; y < grey.height; ++y)
      for (int x = 0; x < grey.width; ++x)
        for (int c = 0; c < 3; ++c)
          colour.at(x, y, c) = grey.at(x, y, 0) * (c == 1 ? 1.0f : (c == 0) == (x < 160) ? 0.8f : 0.2f);
    io::write_png(folder_ / "left" / (std::to_string(f) + ".png"), colour, 16);
  }
  const Ended ended = measure({"--camera", "left", "--projector", "projector"}, pictures("left"));
  ASSERT_EQ(ended.status, 0) << ended.err;
  const io::TriangleMesh cloud =
      io::read_ply(folder_ / "scan/cosines.ply", {.properties = {"pixel_x", "red", "green", "blue"}});
  ASSERT_GT(cloud.positions_m.size(), 30000u);
  ASSERT_EQ(cloud.properties[1].size(), cloud.positions_m.size());
  for (std::size_t i = 0; i < cloud.positions_m.size(); i += 97) {
    const bool red = cloud.properties[0][i] < 160;
    EXPECT_NEAR(cloud.properties[1][i] / cloud.properties[2][i], red ? 0.8 : 0.2, 0.01);
    EXPECT_NEAR(cloud.properties[3][i] / cloud.properties[2][i], red ? 0.2 : 0.8, 0.01);
  }
}

TEST_F(StructuredLight, PatternsArePhotographedAndBecomeAPlane) {
  const io::Image shown = io::read_picture(folder_ / "patterns/cosines-004.png");
  EXPECT_EQ(shown.width, 480);
  EXPECT_NEAR(shown.at(0, 100, 0), 0.5 + 0.5 * std::cos(2 * pi * 6 * 0.5 / 480), 0.01);
  photograph(world_.left, "left"), photograph(world_.right, "right");
  const Ended one =
      measure({"--camera", "left", "--projector", "projector", "--codes", "--html", "page.html"}, pictures("left"));
  ASSERT_EQ(one.status, 0) << one.err;
  write_file(folder_ / "one.json", one.out);
  const manifest::Document d = manifest::parse_document(one.out, "one.json", folder_.path());
  const manifest::Cloud& cloud = d.clouds.at("cosines");
  EXPECT_GT(cloud.points, 60000);
  EXPECT_NEAR(cloud.epipolar_chi_square.value(), 1, 0.3);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "scan/cosines-left-codes.exr"));
  const std::string page = read_file(folder_ / "page.html");
  EXPECT_THAT(page, HasSubstr(format("<h1>%lld points, half of them to", static_cast<long long>(cloud.points))));
  EXPECT_THAT(page, HasSubstr("What should meet and does not"));
  const io::Image codes = io::read_picture(folder_ / "scan/cosines-left-codes.exr");
  EXPECT_NEAR(codes.at(160, 120, codes.channel("column")), lit_by(world_, world_.left, 160, 120)[0], 0.5);
  // The projector stands a little elsewhere than its rig says.
  std::string moved = read_file(folder_ / "cosines.json");
  const std::size_t at = moved.find("-0.02");
  ASSERT_NE(at, std::string::npos);
  write_file(folder_ / "moved.json", moved.replace(at, 5, "-0.018"));
  std::vector<std::string> words{"structured-light", "-i",   "moved.json",  "--out",    "m",
                                 "--camera",         "left", "--projector", "projector"};
  for (const std::string& p : pictures("left")) words.push_back(p);
  const Ended wrong = run(words, folder_.path());
  EXPECT_EQ(wrong.status, 2) << wrong.err;
  EXPECT_THAT(wrong.err, HasSubstr("what should meet misses by"));
  const Ended flat = run({"vdi2634", "--shape", "plane", "scan/cosines.ply"}, folder_.path());
  ASSERT_EQ(flat.status, 0) << flat.err;
  EXPECT_THAT(flat.out, HasSubstr("flatness"));
  const Ended two = measure({"--camera", "left", "--camera", "right"}, [&] {
    std::vector<std::string> all = pictures("left"), more = pictures("right");
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }());
  ASSERT_EQ(two.status, 0) << two.err;
  const io::TriangleMesh points =
      io::read_ply(folder_ / "scan/cosines.ply", {.properties = {"sigma", "pixel_x", "reflected"}});
  ASSERT_GT(points.positions_m.size(), 50000u);
  double squares = 0, stated = 0;
  for (std::size_t i = 0; i < points.positions_m.size(); ++i) {
    const Vec3 p = points.positions_m[i];
    squares += std::pow(off_shape(world_, {p.x, p.y, p.z}), 2), stated += std::pow(points.properties[0][i], 2);
  }
  EXPECT_LT(squares, 1.3 * stated);
}

struct Case {
  std::vector<std::string> words;
  int status;
  const char* says;
};

class Refusals : public StructuredLight {
 protected:
  void refuse(const std::vector<Case>& cases) {
    for (const Case& c : cases) {
      std::vector<std::string> words{"structured-light"};
      words.insert(words.end(), c.words.begin(), c.words.end());
      const Ended ended = run(words, folder_.path());
      EXPECT_EQ(ended.status, c.status) << c.says << ": " << ended.err;
      EXPECT_THAT(ended.err, HasSubstr(c.says));
      EXPECT_EQ(std::ranges::count(ended.err, '\n'), 1) << ended.err;
    }
    EXPECT_FALSE(std::filesystem::exists(folder_ / "s/cosines.ply"));
  }
  // cosines.json with one word changed.
  void with(const char* name, const std::string& from, const std::string& to) {
    std::string text = read_file(folder_ / "cosines.json");
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    write_file(folder_ / name, text.replace(at, from.size(), to));
  }
  static std::vector<std::string> by_projector(const char* manifest, const std::vector<std::string>& files = {}) {
    std::vector<std::string> words{"--out", "s", "--camera", "left", "--projector", "projector", "-i", manifest};
    words.insert(words.end(), files.begin(), files.end());
    return words;
  }
  static std::vector<std::string> by_two(const std::vector<std::string>& files = {}) {
    std::vector<std::string> words{"--out", "s", "--camera", "left", "--camera", "right", "-i", "cosines.json"};
    words.insert(words.end(), files.begin(), files.end());
    return words;
  }
};

TEST_F(Refusals, SequencesThatAreNotWholeOrNotOfTheCamera) {
  photograph(world_.left, "left");
  photograph({160, 120, 320, {0.06, 0, 0}, -0.0873}, "right");
  write_file(folder_ / "cut.png", read_file(folder_ / "left/3.png").substr(0, 500));
  const std::vector<std::string> left = pictures("left"), right = pictures("right");
  std::vector<std::string> both = left, cut = left, gone = left;
  both.insert(both.end(), right.begin(), right.end());
  cut[4] = "cut.png", gone[4] = "left/99.png";
  refuse({{by_projector("cosines.json", pictures("left", 23)), 65,
           "the last of 23 pictures by camera left, and the projection cosines has 24"},
          {by_projector("cosines.json", cut), 65, "cut.png"},
          {by_projector("cosines.json", gone), 66, "left/99.png"},
          {by_projector("cosines.json"), 66, "have no pictures of projection cosines by left"},
          {by_projector("nowhere.json", left), 66, "nowhere.json"},
          {by_two(), 66, "no pictures"},
          {by_two(both), 65, "has 160 x 120 pixels, and its camera 320 x 240"},
          {by_two(left), 65, "0 pictures by camera right"}});
}

TEST_F(Refusals, ManifestsThatSayTooLittle) {
  photograph(world_.left, "left");
  const std::vector<std::string> left = pictures("left");
  with("odd.json", "\"periods\": 40", "\"periods\": 39");
  with("stripe.json", "\"show\": \"cosine\"", "\"show\": \"stripe\"");
  with("diagonal.json", "\"axis\": \"column\"", "\"axis\": \"diagonal\"");
  with("loose.json", "\"rigs\"", "\"x-rigs\"");
  with("word.json", "\"shift_rad\": 0.0", "\"shift_rad\": \"no\"");
  const std::string size = "\"width_px\": 480,\n   \"height_px\": 360,\n   \"frames\"";
  with("wide.json", size, "\"width_px\": 640,\n   \"height_px\": 360,\n   \"frames\"");
  refuse({{by_projector("odd.json", left), 65, "at 1 shifts"},
          {by_projector("stripe.json", left), 65, "stripe"},
          {by_projector("diagonal.json", left), 65, "diagonal"},
          {by_projector("word.json", left), 65, "shift_rad"},
          {by_projector("wide.json", left), 65, "has 480 x 360 pixels, and what it shows 640 x 360"},
          {by_projector("loose.json", left), 65, "hold no rig of left, projector"},
          {by_projector("rig.json", left), 65, "has none"}});
}

TEST_F(Refusals, CallsThatDoNotGoTogether) {
  const std::vector<std::string> measure{"--out", "s", "-i", "cosines.json"}, gray{"--pattern", "gray"};
  const auto then = [](std::vector<std::string> words, const std::vector<std::string>& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  refuse(
      {{then(measure, {"--camera", "left"}), 64, "is given 1 times"},
       {measure, 64, "is given 0 times"},
       {then(measure, {"--camera", "up", "--projector", "projector"}), 64, "up is none"},
       {then(measure, {"--camera", "left", "--projector", "lamp"}), 64, "lamp is none"},
       {then(measure, {"--name", "gray", "--camera", "left", "--projector", "projector"}), 65, "has no gray"},
       {{"-i", "cosines.json", "--camera", "left", "--projector", "projector"}, 64, "--out"},
       {then(gray, {"--out", "g"}), 64, "--size"},
       {then(gray, {"--size", "1920", "--out", "g"}), 64, "is no size"},
       {then(gray, {"--size", "1920xq", "--out", "g"}), 64, "cannot be read"},
       {then(gray, {"--size", "1920x1080"}), 64, "--out"},
       {then(gray, {"--size", "480x360", "--out", "g", "left/0.png"}), 64, "stands beside --pattern"},
       {then(gray, {"--size", "480x360", "--name", "cosines", "--out", "g", "cosines.json"}), 65, "is there already"},
       {{"--pattern", "cosine", "--size", "480x360", "--periods", "1,400", "--out", "g"},
        64,
        "400 are finer than two pixels each"},
       {{"--pattern", "cosine", "--size", "480x360", "--shifts", "2", "--out", "g"}, 64, "--shifts"}});
}

}  // namespace
}  // namespace gonio::tests
