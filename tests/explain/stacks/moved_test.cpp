// What moved between the pictures of a stack: found where it was, and nowhere else, whatever the camera's response.
#include "explain/stacks/moved.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "base/error.h"
#include "data.h"
#include "explain/engine.h"
#include "explain/stacks/exposure_outcome.h"
#include "explain/stacks/exposures_problem.h"
#include "explain/stacks/stack_world.h"
#include "manifest/document.h"
#include "manifest/sections/mechanism_use.h"

namespace gonio::explain::stacks {
namespace {

Moved find(const ExposureWorld& world) {
  const tests::ScratchFolder folder;
  const manifest::Document document = record(world, folder.path());
  const Stack stack = read_stack(document, stacks_of(document, Kind::exposures).at(0), Kind::exposures);
  return find_moved(stack, ReadingNoise(stack));
}

// 40 stacks in which nothing moved, linear and on film, of floats and of codes, grey and in colour: none is found.
TEST(Moved, NothingIsFoundWhereNothingMoved) {
  for (int k = 0; k < 40; ++k) {
    ExposureWorld world;
    world.seed = 500 + k;
    world.channels = k % 5 == 0 ? 3 : 1;
    world.bits = k % 3 == 0 ? 8 : 0;
    if (k % 2 == 1) world.response = film;
    if (k % 4 == 2) world.longer = {0, 0.1, 0, 0, 0, 0};
    const Moved moved = find(world);
    EXPECT_TRUE(moved.regions.empty()) << k << ": picture " << moved.regions[0].image << ", p " << moved.p;
  }
}

// 20 stacks with a disc of ten pixels' radius somewhere in one picture, of a brightness that the scene has, too: four
// in five of its pixels are found (where it is as bright as what it hides, nobody could), and few others.
TEST(Moved, ADiscIsFoundWhereItIs) {
  int found = 0;
  double inside = 0, outside = 0;
  constexpr int runs = 20;
  for (int k = 0; k < runs; ++k) {
    ExposureWorld world;
    world.seed = 700 + k;
    if (k % 2 == 1) world.response = film, world.bits = 8;
    const ExposureWorld::Passer passer{static_cast<std::size_t>(1 + k % 4), 15 + 2 * k, 15 + k, 10,
                                       k % 3 == 0 ? 0.2 : 4.0};
    world.passers = {passer};
    const Moved moved = find(world);
    if (moved.regions.empty()) continue;
    ASSERT_EQ(moved.regions.size(), 1u) << k;
    const MovedRegion& r = moved.regions[0];
    EXPECT_EQ(r.image, passer.picture) << k;
    ++found;
    for (int y = 0; y < world.height; ++y)
      for (int x = 0; x < world.width; ++x) {
        const double away = std::hypot(x - passer.x, y - passer.y);
        const bool marked = r.inside[static_cast<std::size_t>(y * world.width + x)] != 0;
        inside += away < passer.radius && marked;
        outside += away > passer.radius + 3 && marked;
      }
  }
  EXPECT_GE(found, 19);  // of 20
  EXPECT_GT(inside, 0.8 * found * pi * 100);
  EXPECT_LT(outside, 0.05 * found * pi * 100);
}

TEST(Moved, ItIsNamedCarriedAndDoesNotHideTheResponse) {
  const tests::ScratchFolder folder;
  ExposureWorld world;
  world.response = [](double v) { return std::pow(v, 0.8); };
  world.bits = 16;
  world.passers = {{3, 30, 30, 10, 3}};
  manifest::Document document = record(world, folder.path());
  const Outcome first = run(document);
  EXPECT_EQ(first.named, (std::vector<std::string>{"sensor.non-linearity", "scene.moved"}))
      << first.explanation.sentence;
  first.problem->apply(first.explanation, document);
  const Outcome again = run(document);
  EXPECT_EQ(again.explanation.verdict, Verdict::null) << again.explanation.sentence;
}

TEST(Moved, AloneItIsNamedWithItsPlace) {
  const tests::ScratchFolder folder;
  ExposureWorld world;
  world.passers = {{4, 50, 20, 9, 4}};
  const Outcome r = run(record(world, folder.path()));
  ASSERT_EQ(r.named, (std::vector<std::string>{"scene.moved"})) << r.explanation.sentence;
  EXPECT_NE(r.explanation.sentence.find("moved"), std::string::npos) << r.explanation.sentence;
}

// Nothing moved in front of an industrial camera on its tripod; its longest exposures are clipped almost everywhere.
TEST(Moved, NothingIsFoundInARecordedStack) {
  GONIO_NEEDS_DATA("cases/crash-exposures.json");
  const manifest::Document document = manifest::read_document(gonio::tests::data("cases/crash-exposures.json"));
  const Stack stack = read_stack(document, stacks_of(document, Kind::exposures).at(0), Kind::exposures);
  EXPECT_TRUE(find_moved(stack, ReadingNoise(stack)).regions.empty());
}

TEST(Moved, ABoxOutsideThePictureIsRefused) {
  const tests::ScratchFolder folder;
  const manifest::Document whole = record(ExposureWorld{}, folder.path());
  const auto refused = [&](const std::string& name, std::optional<double> value) {
    manifest::Document document = whole;
    manifest::MechanismUse& use = document.mechanisms["scene.moved"];
    use.on = {"e2"};
    for (const char* number : {"relative", "left_px", "top_px", "width_px", "height_px"})
      use.parameters[number] = manifest::Parameter({8});
    use.parameters.erase(name);
    if (value) use.parameters[name] = manifest::Parameter({*value});
    try {
      exposures_problems(document);
    } catch (const Error& error) {
      return std::string(error.what()).find(name) != std::string::npos;
    }
    return false;
  };
  EXPECT_FALSE(refused("left_px", 8));
  EXPECT_TRUE(refused("left_px", -10));
  EXPECT_TRUE(refused("top_px", 5000));
  EXPECT_TRUE(refused("width_px", 0));
  EXPECT_TRUE(refused("height_px", std::nullopt));
}

}  // namespace
}  // namespace gonio::explain::stacks
