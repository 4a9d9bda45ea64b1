// compare as people run it (GONIO_BIN): quick form and pipe form, exits, what is written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

#include "data.h"
#include "io/picture.h"
#include "manifest/value.h"
#include "process.h"

namespace gonio::tests {
namespace {

using testing::HasSubstr;

class Compare : public testing::Test {
 protected:
  void SetUp() override {
    write("photo.exr", 1.0f, 0);
    write("same.exr", 1.0f, 0);
    write("half.exr", 0.5f, 0);
    write("nan.exr", 1.0f, std::numeric_limits<float>::quiet_NaN());
  }
  void write(const char* name, float scale, float first) const {
    io::Image image(48, 32, {"R", "G", "B"});
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 48; ++x)
        for (int c = 0; c < 3; ++c)
          image.at(x, y, c) = scale * static_cast<float>(0.3 + 0.2 * std::sin(0.3 * x + c) * std::cos(0.2 * y));
    image.data[0] += first;
    io::write_picture(folder_ / name, image);
  }
  Ended compare(std::vector<std::string> words, const std::string& input = {}) const {
    words.insert(words.begin(), "compare");
    return run(words, folder_.path(), input);
  }
  static manifest::Value comparison(const Ended& ended) {
    return manifest::parse_json(ended.out, "out").find("comparisons")->as_array().at(0);
  }
  std::string content(const char* name) const {
    std::ostringstream text;
    text << std::ifstream(folder_ / name).rdbuf();
    return text.str();
  }
  ScratchFolder folder_;
};

TEST_F(Compare, EqualPicturesPassEveryLimit) {
  const Ended ended = compare({"--reference", "photo.exr", "--rendered", "same.exr", "--max-rmse", "0", "--min-ssim",
                               "0.999", "--html", "r.html"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(comparison(ended).find("rmse")->as_number(), 0);
  EXPECT_THAT(content("r.html"), HasSubstr("</html>"));
}

TEST_F(Compare, LimitsSetTheExit) {
  const Ended ended = compare({"--reference", "photo.exr", "--rendered", "half.exr", "--max-relative-rmse", "10%"});
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.err, HasSubstr("above the limit"));
  EXPECT_NEAR(comparison(ended).find("relative_rmse")->as_number(), 0.5, 1e-6);
}

TEST_F(Compare, ExposureIsFittedOnRequest) {
  const Ended ended =
      compare({"--reference", "photo.exr", "--rendered", "half.exr", "--fit-exposure", "--max-relative-rmse", "0.1%"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_NEAR(comparison(ended).find("exposure_scale")->as_number(), 2, 1e-6);
  EXPECT_NE(comparison(ended).find("sigma")->find("exposure_scale"), nullptr);
}

TEST_F(Compare, NotANumberAlwaysFailsAndIsWritten) {
  for (const bool reference : {true, false}) {
    const Ended ended = compare({"--reference", reference ? "nan.exr" : "photo.exr", "--rendered",
                                 reference ? "photo.exr" : "nan.exr", "--fit-exposure", "--html", "r.html"});
    EXPECT_EQ(ended.status, 1);
    EXPECT_THAT(ended.err, HasSubstr("(0, 0)"));
    EXPECT_EQ(comparison(ended).find("not_finite")->as_integer(), 1);
    EXPECT_EQ(comparison(ended).find("rmse"), nullptr);
  }
}

TEST_F(Compare, RefusesWhatItCannotAnswer) {
  EXPECT_EQ(compare({"--reference", "photo.exr", "--rendered", "same.exr", "--max-rmse", "nan"}).status, 64);
  EXPECT_EQ(compare({"--reference", "photo.exr"}).status, 64);
  EXPECT_EQ(compare({"--reference", "absent.exr", "--rendered", "same.exr"}).status, 66);
  EXPECT_EQ(
      compare({"--reference", "photo.exr", "--rendered", "same.exr", "--fit-exposure", "--exposure-scale", "2"}).status,
      64);
  const Ended ended = compare({}, R"({"gonio": 1, "images": []})");
  EXPECT_EQ(ended.status, 65);
  EXPECT_THAT(ended.err, HasSubstr("nothing to compare"));
}

// The rendering shows colours, the photograph what the camera reads: green and blue exchanged, red half as bright. The
// stated noise goes through the correction, too: a difference of one standard deviation in red stays one.
TEST_F(Compare, PhotographsBecomeColours) {
  io::Image photograph = io::read_picture(folder_ / "photo.exr"), colours = photograph;
  for (std::size_t i = 0; i < photograph.pixels(); ++i) {
    float* c = &colours.data[3 * i];
    const float* v = &photograph.data[3 * i];
    c[0] = 2 * (v[0] + (i % 2 == 0 ? 0.01f : -0.01f)), c[1] = v[2], c[2] = v[1];
  }
  io::write_picture(folder_ / "colours.exr", colours);
  const auto manifest = [](const std::string& image) {
    return R"({"gonio": 1, "files": {"p": {"path": "photo.exr"}, "r": {"path": "colours.exr"}},
      "colour": {"c": {"model": "linear", "matrix": [[2, 0, 0], [0, 0, 1], [0, 1, 0]], "white": [1, 1, 1],
                       "to": "srgb"}},
      "images": [{"id": "view", "file": "p", )" +
           image + R"(}], "renderings": [{"image": "view", "file": "r"}]})";
  };
  const std::string plain = manifest(R"("noise": {"gain": 1e12, "read": 0.01})");
  EXPECT_GT(comparison(compare({}, plain)).find("rmse")->as_number(), 0.05);
  const Ended ended = compare({"--colour", "c"}, plain);
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_NEAR(comparison(ended).find("rmse")->as_number(), 0.02 / std::sqrt(3.0), 1e-4);
  EXPECT_NEAR(comparison(ended).find("z_rms")->as_number(), 1 / std::sqrt(3.0), 1e-3);
  const auto refusal = [&](const std::string& name, const std::string& image) {
    const Ended refused = compare({"--colour", name}, manifest(image));
    EXPECT_EQ(refused.status, 65);
    return refused.err;
  };
  EXPECT_THAT(refusal("d", R"("weight": 1)"), HasSubstr("has no \"d\""));
  EXPECT_THAT(refusal("c", R"("developed": [{"step": "colour", "by": "c"}])"), HasSubstr("is corrected already"));
}

TEST_F(Compare, ReadsThePipeAndWritesPictures) {
  const std::string manifest = R"({"gonio": 1, "files": {"p": {"path": "photo.exr"}, "r": {"path": "half.exr"}},
    "images": [{"id": "view", "file": "p", "noise": {"gain": 1000, "read": 0.001}}],
    "renderings": [{"image": "view", "file": "r"}]})";
  const Ended ended = compare({"--one-exposure", "--out", "d", "--html", "r.html"}, manifest);
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(comparison(ended).find("image")->as_string(), "view");
  EXPECT_NEAR(comparison(ended).find("z_rms")->as_number(), 0, 1e-3);
  const io::Image planes = io::read_picture(folder_ / "d/view-difference.exr");
  EXPECT_GE(planes.channel("difference.G"), 0);
  EXPECT_GE(planes.channel("z.G"), 0);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "d/view-positive.png"));
  EXPECT_EQ(compare({"--one-exposure", "--out", "d"}, manifest).status, 73);  // exists, no --force
  EXPECT_EQ(compare({}, ended.out).status, 0);                                // its own output is a manifest
}

}  // namespace
}  // namespace gonio::tests
