// What light-probe, from GONIO_BIN, refuses: in one line that says where, what and how to mend it, nothing written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "probe_scene.h"

namespace gonio::tests {
namespace {

using testing::HasSubstr;
using Words = std::vector<std::string>;

class Refusals : public testing::Test {
 protected:
  static constexpr int size = 64;
  Refusals() {
    // A bright disc on dark ground, with a highlight.
    picture_ = io::Image(size, size, {"R", "G", "B"});
    mask_ = io::Image(size, size, {"Y"});
    draw(picture_, mask_, {32, 31}, 18);
    write("ball.exr", picture_);
    write("mask.exr", mask_);
    io::Image flat(size, size, {"R", "G", "B"});
    write("flat.exr", flat);
    write("black.exr", io::Image(size, size, {"Y"}));
    io::Image white(size, size, {"R", "G", "B"});
    for (float& v : white.data) v = 1;
    io::write_picture(folder_ / "white.png", white);
    io::Image cut(size, size, {"Y"}), ignored(size, size, {"R", "G", "B"});
    draw(ignored, cut, {58, 31}, 18);
    write("cut.exr", cut);
    write("small.exr", io::Image(32, 32, {"Y"}));
    write("camera.json", manifest("ball.exr"));
  }
  void draw(io::Image& picture, io::Image& mask, Vec2 centre, double radius) {
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        const double inside = std::clamp(radius - norm(Vec2{double(x), double(y)} - centre) + 0.5, 0.0, 1.0);
        mask.at(x, y, 0) = static_cast<float>(inside);
        for (int c = 0; c < 3; ++c) picture.at(x, y, c) = static_cast<float>(0.05 + inside);
      }
  }
  void write(const std::string& name, const io::Image& image) { io::write_picture(folder_ / name, image); }
  void write(const std::string& name, const std::string& text) { write_file(folder_ / name, text); }
  static std::string manifest(const std::string& file, const std::string& camera = "\"camera\": \"c\"",
                              const std::string& more = {}) {
    return R"({"gonio": 1, "files": {"a": {"path": ")" + file +
           R"("}, "m": {"path": "black.exr"}}, "cameras": {"c": {"model": "pinhole", "width_px": 64, "height_px": 64,
  "fx_px": 200, "fy_px": 200, "cx_px": 31.5, "cy_px": 31.5}}, "images": [{"id": "v", "file": "a", )" +
           camera + more + "}]}";
  }
  void refused(Words words, int status, const std::string& part) {
    words.insert(words.begin(), {"light-probe", "--out", "o"});
    const Ended ended = run(words, folder_.path());
    EXPECT_EQ(ended.status, status) << testing::PrintToString(words) << "\n" << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(part)) << testing::PrintToString(words);
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
    EXPECT_TRUE(ended.out.empty());
    EXPECT_FALSE(std::filesystem::exists(folder_ / "o/probe.exr"));
  }
  io::Image picture_, mask_;
  ScratchFolder folder_;
};

TEST_F(Refusals, WhatIsRefusedHereWorksOtherwise) {
  const Ended ended = run(
      {"light-probe", "--radius", "20mm", "--silhouette", "mask.exr", "--columns", "32", "--out", "o", "camera.json"},
      folder_.path());
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_TRUE(std::filesystem::exists(folder_ / "o/probe-weight.exr"));
}

TEST_F(Refusals, CommandLines) {
  refused({"camera.json"}, 64, "--radius: is missing");
  refused({"--radius", "-20mm", "camera.json"}, 64, "--radius");
  refused({"--radius", "20", "camera.json"}, 64, "--radius");
  refused({"--radius", "20mm", "--metal", "unobtainium", "camera.json"}, 64, "neither a known metal nor a file");
  refused({"--radius", "20mm", "--circle", "1,2", "camera.json"}, 64, "is not X,Y,RADIUS");
  refused({"--radius", "20mm", "--circle", "32,31,-18", "camera.json"}, 64, "is not X,Y,RADIUS");
  refused({"--radius", "20mm", "--circle", "32,31,18", "--balls", "2", "camera.json"}, 64, "--balls says 2");
  refused({"--radius", "20mm", "--columns", "33", "camera.json"}, 64, "33 is odd");
  refused({"--radius", "20mm", "--image", "w", "camera.json"}, 64, "is no image of");
  refused({"--radius", "20mm", "--silhouette", "mask.exr", "--silhouette", "mask.exr", "camera.json"}, 64,
          "2 of them for 1 photographs");
  refused({"--radius", "20mm", "--mask", "mask.exr", "--mask", "mask.exr", "camera.json"}, 64,
          "--mask: 2 of them for 1 photographs");
  refused({"--orthographic", "ball.exr", "ball.exr"}, 64, "has no poses");
  refused({"--radius", "20mm", "ball.exr"}, 66, "has no manifest");
  refused({"--orthographic", "white.png"}, 65, "response is not stated");
  refused({"--convert", "angular", "--to", "lat-long", "ball.exr"}, 64, "--convert takes two");
  refused({"--convert", "lat-long", "--to", "angular", "ball.exr", "new.exr"}, 65, "64 x 64 pixels, and a picture");
  refused({"--convert", "angular", "--to", "lat-long", "white.png", "new.exr"}, 65, "codes of 8 or 16 bits");
  refused({"--convert", "angular", "--to", "lat-long", "ball.exr", "new.png"}, 64, "no name of an OpenEXR file");
  refused({"--convert", "angular", "--to", "lat-long", "ball.exr", "mask.exr"}, 73, "exists");
}

TEST_F(Refusals, Pictures) {
  const Words radius{"--radius", "20mm"};
  const auto with = [&](Words more) {
    more.insert(more.begin(), radius.begin(), radius.end());
    return more;
  };
  write("flat.json", manifest("flat.exr"));
  refused(with({"flat.json"}), 65, "shows 0 of 1 outlines");
  refused(with({"--circle", "32,31,18", "flat.json"}), 65, "shows 0 of 1 outlines");
  refused(with({"--silhouette", "black.exr", "camera.json"}), 65, "is the same everywhere");
  refused(with({"--silhouette", "small.exr", "camera.json"}), 65, "is 32 x 32 pixels");
  refused(with({"--silhouette", "cut.exr", "camera.json"}), 65, "is cut by the border");
  refused(with({"--circle", "55,31,18", "camera.json"}), 65, "leaves the picture");
  refused(with({"--circle", "32,31,2", "camera.json"}), 65, "is too small");
  refused(with({"--balls", "2", "--silhouette", "mask.exr", "camera.json"}), 65, "shows 1 of 2 outlines");
  write("masked.json", manifest("ball.exr", "\"camera\": \"c\"", ", \"mask\": \"m\""));
  refused(with({"--silhouette", "mask.exr", "masked.json"}), 65, "counts no pixel");
  refused(with({"--silhouette", "mask.exr", "--mask", "mask.exr", "masked.json"}), 64, "has a mask in the manifest");
  refused(with({"--silhouette", "mask.exr", "--mask", "black.exr", "camera.json"}), 65, "counts no pixel");
  refused(with({"--silhouette", "mask.exr", "--mask", "small.exr", "camera.json"}), 65,
          "small.exr: has another size than the picture");
  write("nobody.json", manifest("ball.exr", "\"camera\": \"d\""));
  refused(with({"nobody.json"}), 65, "camera");
  write("gone.json", manifest("gone.exr"));
  refused(with({"gone.json"}), 66, "gone.exr");
  write("white.json", manifest("white.png", "\"camera\": \"c\"", ", \"response\": \"linear\""));
  refused(with({"--silhouette", "mask.exr", "white.json"}), 65, "is saturated all over the ball");
  write("none.json", std::string(R"({"gonio": 1})"));
  refused(with({"none.json"}), 65, "has no image with a file");
}

// One ball of one size cannot be seen at two places; and views without poses do not say where they stand.
TEST_F(Refusals, ViewsThatContradictEachOther) {
  const auto two = [&](const char* first, const char* second) {
    std::string text = manifest("ball.exr", "\"camera\": \"c\"", first);
    text.insert(text.size() - 2, std::string(R"(, {"id": "w", "file": "a", "camera": "c")") + second + "}");
    return text;
  };
  const char* at = R"(, "world_from_camera": {"rotation": [1, 0, 0, 0], "translation_m": [0, 0, 0]})";
  const char* aside = R"(, "world_from_camera": {"rotation": [1, 0, 0, 0], "translation_m": [0.3, 0, 0]})";
  write("two.json", two(at, aside));
  refused({"--radius", "20mm", "--silhouette", "mask.exr", "two.json"}, 65, "belong to 2 places");
  write("poseless.json", two(at, ""));
  refused({"--radius", "20mm", "--silhouette", "mask.exr", "poseless.json"}, 65,
          "/images/1/world_from_camera: missing");
}

}  // namespace
}  // namespace gonio::tests
