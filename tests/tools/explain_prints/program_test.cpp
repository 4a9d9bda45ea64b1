// explain on a print as a person runs it: a folder of pictures, a measured map, a manifest; what is wrong is said in
// one line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/atomic_file.h"
#include "base/text.h"
#include "data.h"
#include "explain/prints/sample.h"
#include "io/codes.h"
#include "io/height_map.h"
#include "manifest/document.h"
#include "manifest/sections/print.h"
#include "process.h"
#include "schema_check.h"

namespace gonio::tests {
namespace {

using explain::tests::side_px;
using testing::HasSubstr;

class ExplainPrints : public testing::Test {
 protected:
  void SetUp() override {
    const explain::prints::Sent sent = explain::tests::sample();
    for (std::size_t k = 0; k < sent.layers.size(); ++k) {
      io::Image image(side_px, side_px, {"Y"});
      image.data = sent.layers[k];
      io::write_png(folder_ / format("layer%zu.png", k + 1), image, 8);
    }
    map_ = explain::tests::measured(sent, explain::prints::stated(sent), 0.5e-6, 31).maps[0];
    io::write_surf(folder_ / "map.sur", map_.map);
  }
  void write_scene(double at_x_m, double at_y_m, int width_px = side_px, const char* layers = R"("layers": "l",)") {
    write_file(folder_ / "scene.json",
               format(R"({"gonio": 1, "files": {"m": {"path": "map.sur"}, "l": {"path": "layer1.png"}},
 "reliefs": {"sample": {"file": "m"}},
 "prints": {"p": {"pixel_m": [30e-6, 30e-6], "width_px": %d, "height_px": %d, "layer_m": 20e-6, %s
  "growth": {"alpha_m": 19.5e-6, "beta_m": 11e-6, "gamma": -0.01},
  "measured": [{"relief": "sample", "at_m": [%.17g, %.17g]}]}}})",
                      width_px, width_px, layers, at_x_m, at_y_m));
  }
  Ended explain() const { return run({"explain", "scene.json", "--log-level", "warning"}, folder_.path()); }
  ScratchFolder folder_;
  explain::PrintedMap map_;
};

TEST_F(ExplainPrints, SaysThatNothingIsLeftOut) {
  write_scene(map_.at_m.x, map_.at_m.y);
  const Ended ended = explain();
  EXPECT_EQ(ended.status, 0) << ended.err;
  expect_described(ended.out);
  const manifest::Document d = manifest::parse_document(ended.out, "o", folder_.path(), {.allow_outside = true});
  EXPECT_EQ(d.explanations.at(0).find("verdict")->as_string(), "null");
  EXPECT_THAT(d.explanations.at(0).find("sentence")->as_string(), HasSubstr("1600 pixels of 1 map were read"));
}

TEST_F(ExplainPrints, RefusesAMapBesideThePicture) {
  write_scene(1, 1);
  const Ended ended = explain();
  EXPECT_EQ(ended.status, 65);
  EXPECT_THAT(ended.err,
              HasSubstr("scene.json#/prints/p/measured/0/at_m: puts the map beside the projector's picture"));
}

TEST_F(ExplainPrints, RefusesPicturesOfAnotherSize) {
  write_scene(map_.at_m.x, map_.at_m.y, 2 * side_px);
  const Ended ended = explain();
  EXPECT_EQ(ended.status, 65);
  EXPECT_THAT(ended.err, HasSubstr("scene.json#/prints/p/layers: has pictures of 40 x 40 pixels, the print 80 x 80"));
}

TEST_F(ExplainPrints, AsksForWhatWasSent) {
  write_scene(map_.at_m.x, map_.at_m.y, side_px, "");
  const Ended ended = explain();
  EXPECT_EQ(ended.status, 65);
  EXPECT_THAT(ended.err, HasSubstr("scene.json#/prints/p/layers: is missing"));
}

TEST_F(ExplainPrints, RefusesAReliefThatIsNotThere) {
  write_file(folder_ / "scene.json", R"({"gonio": 1, "prints": {"p": {"pixel_m": [3e-5, 3e-5], "width_px": 40,
    "height_px": 40, "layer_m": 2e-5, "measured": [{"relief": "none", "at_m": [0, 0]}]}}})");
  const Ended ended = explain();
  EXPECT_EQ(ended.status, 65);
  EXPECT_THAT(ended.err, HasSubstr("scene.json#/prints/p/measured/0/relief"));
}

}  // namespace
}  // namespace gonio::tests
