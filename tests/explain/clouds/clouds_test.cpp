// explain on clouds: what the rig left out is named with its size, and nothing where nothing is left out.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "data.h"
#include "explain/clouds/clouds_problem.h"
#include "explain/engine.h"
#include "inference/explanation.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/cloud.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/rig.h"
#include "mechanism/mechanism.h"
#include "scan/clouds_world.h"
#include "scan/told_place.h"

namespace gonio::mechanism {
const Mechanism& structured_light_defocus();
}  // namespace gonio::mechanism

namespace gonio::tests {
namespace {

using namespace explain;
using Shape = CloudsWorld::Shape;

struct Answer {
  manifest::Document document;
  std::unique_ptr<Problem> problem;
  Explanation e{};
  std::vector<std::string> named{};
  const Estimate* estimate(const std::string& name) const {
    for (const Estimate& x : e.estimates)
      if (problem->parameters()[x.parameter].name == name) return &x;
    return nullptr;
  }
};

Answer explained(manifest::Document document) {
  Answer a{std::move(document), nullptr};
  a.problem = clouds_problem(std::move(clouds_inputs(a.document).at(0)));
  a.e = inference::explain(*a.problem, {.negative_controls = 8});
  for (const std::size_t c : a.e.named) a.named.push_back(a.problem->candidates()[c].id());
  a.problem->apply(a.e, a.document);
  return a;
}

Answer explained(const CloudsWorld& world) {
  ScratchFolder folder;
  return explained(measured_clouds(world, folder.path()));
}

// A light that no model here knows stretches intervals by a twentieth of the number: projectors blend their pixels.
void expect_covered(const Answer& a, const std::string& name, double truth, double blend = 0) {
  const Estimate* e = a.estimate(name);
  ASSERT_NE(e, nullptr) << name << "\n" << a.e.sentence;
  EXPECT_NEAR(e->value, truth, 3.3 * e->sigma + blend * std::abs(truth)) << name;  // once in a thousand
}

TEST(Clouds, OfARigThatLeavesNothingOutShowNothing) {
  for (const Shape shape : {Shape::planes, Shape::balls}) {
    const Answer a = explained({.shape = shape, .seed = 3});
    EXPECT_THAT(a.named, testing::IsEmpty()) << a.e.sentence;
  }
}

TEST(Clouds, TellTheProjectorsGamma) {
  ScratchFolder folder;
  const manifest::Document measured =
      measured_clouds({.shape = Shape::planes, .clouds = 4, .gamma = 1.3, .seed = 5}, folder.path());
  const Answer a = explained(measured);
  EXPECT_THAT(a.named, testing::ElementsAre("projector.gamma")) << a.e.sentence;
  expect_covered(a, "projector.gamma.gamma", 1.3, 0.01);
  EXPECT_EQ(a.document.mechanisms.at("projector.gamma").on, std::vector<std::string>{"projector"});
  // Asked again with it switched on, they show nothing more.
  manifest::Document again = measured;
  again.mechanisms = a.document.mechanisms;
  EXPECT_THAT(explained(std::move(again)).named, testing::IsEmpty());
}

TEST(Clouds, TellThatTheProjectorWasTurned) {
  const Answer a = explained({.shape = Shape::planes, .turned_rad = 0.002, .seed = 6});
  EXPECT_THAT(a.named, testing::ElementsAre("projector.moved")) << a.e.sentence;
  expect_covered(a, "projector.moved.turn_y_rad", 0.002);
  // The rig says so now: clouds measured by it anew lie on their shapes.
  const auto& pose = a.document.rigs.at("rig").cameras.at(1).rig_from_camera;
  EXPECT_NEAR(2 * std::asin(pose.rotation.y), -0.08 + 0.002, 2e-4);
}

TEST(Clouds, TellTheProjectorsLens) {
  const Answer a = explained({.shape = Shape::balls, .k1 = 0.05, .seed = 7});
  EXPECT_THAT(a.named, testing::ElementsAre("projector.lens")) << a.e.sentence;
  expect_covered(a, "projector.lens.k1", 0.05);
  EXPECT_NEAR(a.document.cameras.at("projector").distortion.at("k1").scalar(), 0.05, 0.02);
}

TEST(Clouds, TellThatLightComesBackFromBelow) {
  const Answer a = explained({.shape = Shape::balls, .depth_m = 3e-4, .seed = 8});
  EXPECT_THAT(a.named, testing::ElementsAre("structured-light.subsurface")) << a.e.sentence;
  expect_covered(a, "structured-light.subsurface.depth_m", 3e-4, 0.05);
  EXPECT_THAT(a.e.sentence + a.problem->remarks(a.e), testing::HasSubstr("behind the surface"));
}

TEST(Clouds, TellThatLightSpreadsBeneath) {
  const Answer a =
      explained({.shape = Shape::balls, .clouds = 4, .scatter_m = 1e-3, .read = 5e-4, .gain = 1e5, .seed = 14});
  EXPECT_THAT(a.named, testing::ElementsAre("structured-light.subsurface")) << a.e.sentence;
  expect_covered(a, "structured-light.subsurface.spread_m", 1e-3, 0.1);
}

TEST(Clouds, TellThatThingsMovedMeanwhile) {
  const Answer a = explained({.shape = Shape::planes, .clouds = 8, .moves_m = 2e-3, .seed = 9});
  EXPECT_THAT(a.named, testing::ElementsAre("structured-light.motion")) << a.e.sentence;
  expect_covered(a, "c0/along_m", 2e-3, 0.1);
  expect_covered(a, "c1/along_m", -3e-3, 0.1);
}

TEST(Clouds, TellThatTheCameraBlursPrint) {
  const Answer a = explained({.shape = Shape::planes, .print_m = 0.02, .blur_px = 1, .seed = 11});
  EXPECT_THAT(a.named, testing::ElementsAre("structured-light.edge")) << a.e.sentence;
  // A pixel's own square counts along x, and not along y, where the world takes it as a line.
  expect_covered(a, "structured-light.edge.spread_px2", 1 + 1.0 / 12, 0.03);
}

// Of a projector whose tone curve is known.
TEST(Clouds, TellThatTheProjectorIsOutOfFocus) {
  const Answer a = explained({.shape = Shape::planes, .gamma = 2, .gamma_known = true, .spot_px = 1, .seed = 13});
  EXPECT_THAT(a.named, testing::Contains(mechanism::structured_light_defocus().id)) << a.e.sentence;
  // Light between two of its pixels is theirs, by distance: a twelfth of a pixel's square more than its own square.
  expect_covered(a, "structured-light.defocus.spot_px2", 1 + 1.0 / 12, 0.1);
}

// A principal point that drifts does nearly the same.
TEST(Clouds, TellThatTheRigDrifts) {
  const Answer a = explained({.shape = Shape::balls, .turns_rad_per_s = 2e-7, .seed = 10});
  std::set<std::string> listed(a.named.begin(), a.named.end());
  for (const auto& set : a.e.not_told_apart)
    for (const std::size_t c : set) listed.insert(a.problem->candidates()[c].id());
  EXPECT_THAT(listed, testing::Contains("rig.drift")) << a.e.sentence;
}

// Of things whose shape nobody knows. A point's own noise once stood in what physics would do to it.
TEST(Clouds, AgainstEachOtherShowNothingWhereNothingIsLeftOut) {
  const Answer a = explained({.shape = Shape::balls, .overlaps = true, .seed = 15});
  EXPECT_THAT(a.named, testing::IsEmpty()) << a.e.sentence;
  EXPECT_GT(a.e.global_p, 0.001);
}

TEST(Clouds, TellAgainstEachOtherTheProjectorsGamma) {
  const Answer a = explained({.shape = Shape::balls, .clouds = 4, .gamma = 1.3, .overlaps = true, .seed = 12});
  EXPECT_THAT(a.named, testing::ElementsAre("projector.gamma")) << a.e.sentence;
  expect_covered(a, "projector.gamma.gamma", 1.3, 0.01);
  EXPECT_EQ(a.problem->observations().groups(), 6U);
}

TEST(Clouds, ThatDoNotOverlapAreRefused) {
  ScratchFolder folder;
  const manifest::Document document =
      measured_clouds({.shape = Shape::balls, .clouds = 4, .overlaps = true, .apart_m = 1}, folder.path());
  ASSERT_TRUE(has_clouds_to_ask(document));
  EXPECT_THROW((void)clouds_inputs(document), Error);
}

TEST(Clouds, OfBitsAloneAreRefused) {
  ScratchFolder folder;
  const manifest::Document document = measured_clouds({.clouds = 4, .gray = true}, folder.path());
  EXPECT_THROW((void)clouds_inputs(document), Error);
}

TEST(Clouds, AreEnoughOrRefused) {
  ScratchFolder folder;
  manifest::Document document = measured_clouds({.clouds = 4}, folder.path());
  document.clouds.at("c3").shape.reset();
  EXPECT_THROW((void)clouds_inputs(document), Error);
}

// Against light summed sample by sample.
TEST(ToldPlace, IsWhatLeastSquaresMakeOfBentLight) {
  const scan::Axis columns[] = {scan::Axis::column};
  const double periods[] = {16};
  for (const int shifts : {3, 4, 5})
    for (const double gamma : {0.7, 1.0, 2.2}) {
      const scan::Sequence s = scan::cosine_sequence(640, 480, columns, periods, shifts);
      const scan::ToldPlace told(s, scan::Axis::column);
      const double half = pi * 16 / 640, contrast = std::sin(half) / half;  // of a picture whose pixels are means
      for (double place = 100; place < 140; place += 3.7) {
        double c = 0, sine = 0;
        constexpr int samples = 4000;
        for (int k = 0; k < shifts; ++k) {
          const double shift = 2 * pi * k / shifts, moved = 4 * (k / (shifts - 1.0) - 0.5);
          double read = 0;  // squares of the projector, under a pixel that covers three of them
          for (int i = 0; i < samples; ++i) {
            const double a = (i + 0.5) / samples - 0.5,
                         b = 3 * ((i * 0.6180339887498949) - std::floor(i * 0.6180339887498949) - 0.5);
            read += std::pow(0.5 + 0.5 * contrast * std::cos(2 * pi * 16 * (place + moved + a + b + 0.5) / 640 - shift),
                             gamma) /
                    samples;
          }
          c += read * std::cos(shift), sine += read * std::sin(shift);
        }
        const double px = 640 / (2 * pi * 16),
                     expected = place + px * std::remainder(std::atan2(sine, c) - (place + 0.5) / px, 2 * pi);
        EXPECT_NEAR(told(place, {gamma, 4, 3}), expected, 2e-3) << shifts << " shifts, gamma " << gamma;
      }
    }
}

}  // namespace
}  // namespace gonio::tests
