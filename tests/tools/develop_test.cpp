// develop as people run it (GONIO_BIN): photographs and manifests in, pictures, masks and a pinhole out.
#include <gmock/gmock.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "base/atomic_file.h"
#include "data.h"
#include "io/codes.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/file.h"
#include "manifest/sections/image.h"
#include "manifest/sections/rendering.h"
#include "process.h"

namespace gonio::tests {
namespace {

using testing::HasSubstr;

constexpr const char* plain = R"({"gonio": 1, "cameras": {"c": {"model": "pinhole", "width_px": 96, "height_px": 64,
  "fx_px": 100, "fy_px": 100, "cx_px": 50, "cy_px": 30}}})";
constexpr const char* barrel = R"({"gonio": 1, "cameras": {"c": {"model": "radial-tangential", "width_px": 96,
  "height_px": 64, "fx_px": 100, "fy_px": 102, "cx_px": 50, "cy_px": 30, "distortion": {"k1": -0.2}}}})";

class Develop : public testing::Test {
 protected:
  void SetUp() override {
    write_file(folder_ / "plain.json", plain);
    write_file(folder_ / "barrel.json", barrel);
    io::Image image(96, 64, {"R", "G", "B"});
    for (std::size_t i = 0; i < image.data.size(); ++i)
      image.data[i] = static_cast<float>((i * 7919) % 60001) / 65535.0f;  // every second code or so, none saturated
    io::write_png(folder_ / "deep.png", image, 16);
    io::write_png(folder_ / "flat.png", image, 8);
    io::write_picture(folder_ / "linear.exr", image);
  }
  Ended develop(std::vector<std::string> words) const {
    words.insert(words.begin(), {"develop", "--undistort"});
    return run(words, folder_.path());
  }
  manifest::Document document(const Ended& ended) const {
    return manifest::parse_document(ended.out, "out", folder_.path());
  }
  io::Image picture(const char* name) const { return io::read_picture(folder_ / name); }
  ScratchFolder folder_;
};

TEST_F(Develop, WithoutDistortionEveryFormatComesBackExactly) {
  for (const char* response : {"", "linear", "srgb"}) {
    SCOPED_TRACE(response);
    std::vector<std::string> words = {"-i",      "plain.json", "--out",    "d",
                                      "--force", "deep.png",   "flat.png", "linear.exr"};
    if (*response != 0) words.insert(words.begin(), {"--response", response});
    if (std::string(response) == "srgb") words.pop_back();  // an EXR in sRGB is nothing to test with
    const Ended ended = develop(words);
    ASSERT_EQ(ended.status, 0) << ended.err;
    EXPECT_EQ(picture("d/deep.png").data, picture("deep.png").data);
    EXPECT_EQ(io::code_bits(folder_ / "d/deep.png"), 16);
    EXPECT_EQ(picture("d/flat.png").data, picture("flat.png").data);
    EXPECT_EQ(io::code_bits(folder_ / "d/flat.png"), 8);
    EXPECT_EQ(picture("d/linear.exr").data, picture("linear.exr").data);
    const manifest::Document out = document(ended);
    EXPECT_EQ(out.images.at(0).camera, "c-undistorted");
    EXPECT_EQ(out.cameras.at("c-undistorted").width_px, 96);
    EXPECT_TRUE(out.cameras.contains("c"));
    EXPECT_EQ(out.files.at(out.images[0].file).path, "d/deep.png");
    EXPECT_EQ(out.files.at(out.images[0].mask).path, "d/deep-mask.png");
  }
}

TEST_F(Develop, APictureIsUndistortedOnce) {
  const Ended ended = develop({"-i", "barrel.json", "--out", "d", "--kernel", "mitchell", "linear.exr"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const manifest::Document out = document(ended);
  ASSERT_EQ(out.images.at(0).developed.size(), 1u);
  EXPECT_EQ(out.images[0].developed[0].step, "undistort");
  EXPECT_EQ(out.images[0].developed[0].by, "mitchell");
  write_file(folder_ / "straight.json", ended.out);
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"straight.json", "--out", "e"},
        {"-i", "straight.json", "--camera", "c", "--out", "e", "d/linear.exr"}}) {
    const Ended again = develop(words);
    EXPECT_EQ(again.status, 65);
    EXPECT_THAT(again.err, HasSubstr("has no lens distortion any more (developed: undistort by mitchell)"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "e/linear.exr"));
  }
}

TEST_F(Develop, SixteenBitsStaySixteen) {
  const Ended ended = develop({"-i", "barrel.json", "--response", "linear", "--out", "d", "deep.png"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  int fine = 0;  // codes that eight bits do not have
  for (const float v : picture("d/deep.png").data)
    if (std::abs(v * 255 - std::round(v * 255)) > 0.01) ++fine;
  EXPECT_GT(fine, 1000);
  const manifest::Camera camera = document(ended).cameras.at("c-undistorted");
  EXPECT_EQ(picture("d/deep.png").width, camera.width_px);
  EXPECT_EQ(camera.fx_px.scalar(), camera.fy_px.scalar());
}

TEST_F(Develop, LightIsInterpolatedNotCodes) {
  io::Image stripes(96, 64, {"Y"});
  for (std::size_t i = 0; i < stripes.data.size(); ++i) stripes.data[i] = i % 2 == 0 ? 0.8f : 0.0f;
  io::write_png(folder_ / "stripes.png", stripes, 16);
  ASSERT_EQ(develop({"-i", "plain.json", "--scale", "0.5", "--response", "srgb", "--out", "a", "stripes.png"}).status,
            0);
  ASSERT_EQ(develop({"-i", "plain.json", "--scale", "0.5", "--out", "b", "stripes.png"}).status, 0);
  EXPECT_NEAR(picture("a/stripes.png").at(24, 16, 0), io::srgb_from_linear(io::linear_from_srgb(0.8f) / 2), 0.01);
  EXPECT_NEAR(picture("b/stripes.png").at(24, 16, 0), 0.4, 0.01);
  ASSERT_EQ(develop({"-i", "plain.json", "--format", "exr", "--response", "srgb", "--out", "c", "stripes.png"}).status,
            0);
  EXPECT_NEAR(picture("c/stripes.exr").at(24, 16, 0), io::linear_from_srgb(0.8f), 1e-5);
}

TEST_F(Develop, SaturatedPixelsAreMaskedWithTheirNeighbours) {
  io::Image bright(96, 64, {"Y"});
  for (float& v : bright.data) v = 0.5f;
  bright.at(60, 40, 0) = 1;
  io::write_png(folder_ / "bright.png", bright, 8);
  ASSERT_EQ(develop({"-i", "barrel.json", "--keep", "same", "--out", "d", "bright.png"}).status, 0);
  const io::Image mask = picture("d/bright-mask.png");
  int invalid = 0;
  for (int y = 30; y < 50; ++y)
    for (int x = 50; x < 70; ++x) invalid += mask.at(x, y, 0) < 0.5f;
  EXPECT_GE(invalid, 9);
  EXPECT_LE(invalid, 25);
  ASSERT_EQ(develop({"-i", "barrel.json", "--keep", "same", "--saturation", "0.4", "--out", "e", "bright.png"}).status,
            0);
  for (const float v : picture("e/bright-mask.png").data) ASSERT_EQ(v, 0);
}

// What polarizers said of the light is interpolated as the light is; ids are not.
TEST_F(Develop, StokesVectorsAreCarriedAlong) {
  io::Image seen(96, 64, {"Y", "s1.Y", "s2.Y", "variance.Y", "variance.s1.Y", "object"});
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 96; ++x) {
      const float light = 0.2f + 0.005f * static_cast<float>(x);
      const float values[] = {light, 0.5f * light, -0.25f * light, 4, 2, 1};
      for (int c = 0; c < 6; ++c) seen.at(x, y, c) = values[c];
    }
  io::write_picture(folder_ / "stokes.exr", seen);
  const Ended ended = develop({"-i", "barrel.json", "--out", "d", "stokes.exr"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const io::Image out = picture("d/stokes.exr"), mask = picture("d/stokes-mask.png");
  EXPECT_EQ(out.channel("object"), -1);
  int seen_pixels = 0;
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      if (mask.at(x, y, 0) < 0.5f) continue;
      const float light = out.at(x, y, out.channel("Y"));
      EXPECT_NEAR(out.at(x, y, out.channel("s1.Y")), 0.5f * light, 1e-5);
      EXPECT_NEAR(out.at(x, y, out.channel("s2.Y")), -0.25f * light, 1e-5);
      EXPECT_NEAR(out.at(x, y, out.channel("variance.s1.Y")), 0.5f * out.at(x, y, out.channel("variance.Y")), 1e-4);
      ++seen_pixels;
    }
  EXPECT_GT(seen_pixels, 1000);
}

TEST_F(Develop, ReadsTiffAndJpegAndRefusesWhatItCannotUse) {
  const cv::Mat grey(64, 96, CV_16U, cv::Scalar(20000)), colour(64, 96, CV_8UC3, cv::Scalar(10, 120, 200));
  cv::imwrite((folder_ / "grey.tif").string(), grey);
  cv::imwrite((folder_ / "colour.jpg").string(), colour);
  const Ended ended = develop({"-i", "barrel.json", "--out", "d", "grey.tif", "colour.jpg"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(io::code_bits(folder_ / "d/grey.png"), 16);
  EXPECT_NEAR(picture("d/grey.png").at(40, 30, 0) * 65535, 20000, 0.6);
  EXPECT_NEAR(picture("d/colour.png").at(40, 30, 0) * 255, 200, 3);
  EXPECT_EQ(develop({"-i", "barrel.json", "--out", "d", "grey.tif"}).status, 73);  // is there already
  EXPECT_EQ(develop({"-i", "barrel.json", "--out", "x", "--format", "exr", "grey.tif"}).status, 65);
  EXPECT_EQ(develop({"-i", "barrel.json", "--out", "x", "--response", "srgb"}).status, 64);
  EXPECT_EQ(develop({"-i", "barrel.json", "--out", "x", "--camera", "d", "grey.tif"}).status, 65);
  EXPECT_EQ(develop({"-i", "barrel.json", "--out", "x"}).status, 65);  // no images
  EXPECT_EQ(develop({"-i", "barrel.json", "grey.tif"}).status, 64);
  EXPECT_EQ(run({"develop", "-i", "barrel.json", "--out", "x", "grey.tif"}, folder_.path()).status, 64);
  io::write_png(folder_ / "small.png", io::Image(50, 40, {"Y"}), 8);
  const Ended small = develop({"-i", "barrel.json", "--out", "x", "small.png"});
  EXPECT_EQ(small.status, 65);
  EXPECT_THAT(small.err, HasSubstr("50 x 40"));
}

// Four readings behind four filters are the same four afterwards, each behind its own; three interpolated colours are
// developed as colours; what cannot be known is refused.
TEST_F(Develop, AMosaicStaysAMosaic) {
  const auto camera = [](const std::string& mosaic) {
    std::string text = barrel;
    text.insert(text.find("\"width_px\""), "\"mosaic\": \"" + mosaic + "\", ");
    return text;
  };
  write_file(folder_ / "bayer.json", camera("GRBG"));
  write_file(folder_ / "polarized.json", camera("polarizers"));
  io::Image raw(96, 64, {"Y"}), thrice(96, 64, {"R", "G", "B"});
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 96; ++x) {
      const float v = static_cast<float>(40 + 50 * (2 * (y % 2) + x % 2)) / 255;
      raw.at(x, y, 0) = v;
      for (int c = 0; c < 3; ++c) thrice.at(x, y, c) = v;
    }
  io::write_png(folder_ / "raw.png", raw, 8);
  io::write_png(folder_ / "thrice.png", thrice, 8);
  for (const char* manifest : {"bayer.json", "polarized.json"})
    for (const char* file : {"raw", "thrice"}) {
      SCOPED_TRACE(std::string(manifest) + " " + file);
      const Ended ended = develop({"-i", manifest, "--force", "--out", "d", std::string(file) + ".png"});
      ASSERT_EQ(ended.status, 0) << ended.err;
      EXPECT_EQ(document(ended).cameras.at("c-undistorted").mosaic, manifest[0] == 'b' ? "GRBG" : "polarizers");
      const io::Image out = picture(("d/" + std::string(file) + ".png").c_str());
      for (int y = 0; y < out.height; ++y)
        for (int x = 0; x < out.width; ++x) ASSERT_EQ(out.at(x, y, 0), raw.at(x % 2, y % 2, 0)) << x << " " << y;
      for (const float v : picture(("d/" + std::string(file) + "-mask.png").c_str()).data) ASSERT_EQ(v, 1);
    }
  const Ended colours = develop({"-i", "bayer.json", "--out", "e", "flat.png"});
  ASSERT_EQ(colours.status, 0) << colours.err;
  EXPECT_EQ(document(colours).cameras.at("c-undistorted").mosaic, "");
  const Ended either = develop({"-i", "polarized.json", "--out", "e", "flat.png"});
  EXPECT_EQ(either.status, 65);
  EXPECT_THAT(either.err, HasSubstr("flat.png: has three colours of a camera with polarizers"));
  const Ended both = develop({"-i", "bayer.json", "--out", "f", "raw.png", "flat.png"});
  EXPECT_EQ(both.status, 65);
  EXPECT_THAT(both.err, HasSubstr("flat.png: has three colours a pixel, other pictures of its camera are mosaics"));
}

struct Part {
  int left, right, top, bottom;
};

// Shift in pixels that carries `a` into `b`, least squares over the pixels that count (Lucas & Kanade 1981).
double shift_between(const io::Image& a, const io::Image& b, const io::Image& mask, Part part) {
  double xx = 0, xy = 0, yy = 0, xt = 0, yt = 0;
  for (int y = std::max(2, part.top); y < std::min(a.height - 2, part.bottom); ++y)
    for (int x = std::max(2, part.left); x < std::min(a.width - 2, part.right); ++x) {
      if (mask.at(x, y, 0) < 0.5f) continue;
      const double gx = 0.5 * (a.at(x + 1, y, 0) - a.at(x - 1, y, 0)),
                   gy = 0.5 * (a.at(x, y + 1, 0) - a.at(x, y - 1, 0));
      const double t = b.at(x, y, 0) - a.at(x, y, 0);
      xx += gx * gx, xy += gx * gy, yy += gy * gy, xt += gx * t, yt += gy * t;
    }
  const double det = xx * yy - xy * xy;
  return std::hypot(yy * xt - xy * yt, xx * yt - xy * xt) / det;
}

// render with the lens, develop, and render with the pinhole that develop made: the same picture, in every quarter.
// Direct light alone, with 64 samples: the noise moves the whole by about 0.0025 px and a quarter by 0.005 px.
TEST_F(Develop, RenderedThroughTheLensAndStraightenedIsRenderedWithoutIt) {
  ASSERT_EQ(run({"render", "--specimen", "board", "--out", "s", "-o", "s/scene.json"}, folder_.path()).status, 0);
  manifest::Document scene = manifest::read_document(folder_ / "s/scene.json");
  std::erase_if(scene.images, [](const manifest::ImageEntry& image) { return image.id != "board-01"; });
  scene.images[0].noise.reset();
  manifest::Camera& camera = scene.cameras.begin()->second;  // half the size, for speed
  camera.width_px /= 2;
  camera.height_px /= 2;
  for (manifest::Parameter* p : {&camera.fx_px, &camera.fy_px, &camera.cx_px, &camera.cy_px}) *p = p->scalar() / 2;
  write_file(folder_ / "scene.json", manifest::print_document(scene, folder_.path()));
  const auto render = [&](const std::string& from, const std::string& to) {
    const Ended ended =
        run({"render", from, "--spp", "64", "--max-bounces", "1", "--aov", "off", "--out", to, "-o", to + ".json"},
            folder_.path());
    ASSERT_EQ(ended.status, 0) << ended.err;
  };
  render("scene.json", "bent");
  manifest::Document bent = manifest::read_document(folder_ / "bent.json");
  bent.images[0].file = bent.renderings[0].file;
  bent.renderings.clear();
  write_file(folder_ / "bent.json", manifest::print_document(bent, folder_.path()));
  const Ended ended = develop({"bent.json", "--out", "straight", "-o", "straight.json"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  render("straight.json", "again");
  const io::Image straight = picture("straight/board-01.exr"), again = picture("again/board-01.exr");
  const io::Image mask = picture("straight/board-01-mask.png");
  ASSERT_EQ(straight.width, again.width);
  const int w = again.width, h = again.height;
  EXPECT_LT(shift_between(again, straight, mask, {0, w, 0, h}), 0.01);
  for (const Part part : {Part{0, w / 2, 0, h / 2}, {w / 2, w, 0, h / 2}, {0, w / 2, h / 2, h}, {w / 2, w, h / 2, h}})
    EXPECT_LT(shift_between(again, straight, mask, part), 0.02);
  EXPECT_GT(shift_between(again, picture("bent/board-01.exr"), mask, {0, w / 2, 0, h / 2}), 0.1);  // the lens bends
}

}  // namespace
}  // namespace gonio::tests
