// What flows over from full pixels: found with intervals that cover, and nowhere else, whatever the camera's response.
#include "explain/stacks/overflow.h"

#include <gtest/gtest.h>

#include <cmath>

#include "data.h"
#include "explain/stacks/exposure_outcome.h"
#include "explain/stacks/stack_world.h"
#include "manifest/document.h"

namespace gonio::explain::stacks {
namespace {

ExposureWorld clipped_green(std::uint64_t seed) {
  ExposureWorld world;
  world.width = 144, world.height = 120;
  world.red = 0.2, world.blue = 0.15;
  world.bits = 16;
  world.seed = seed;
  return world;
}

Overflow find(const ExposureWorld& world) {
  const tests::ScratchFolder folder;
  const manifest::Document document = record(world, folder.path());
  const Stack stack = read_stack(document, stacks_of(document, Kind::exposures).at(0), Kind::exposures);
  return find_overflow(stack, ReadingNoise(stack));
}

// 24 stacks with clipped pixels that keep what is theirs, linear and on film, of codes of 8 and 16 bits, behind a grid
// and in colour. At a level of 1e-4 each, one is found with a chance of 0.2 % by a perfect tool.
TEST(Overflow, NothingIsFoundWhereNothingFlows) {
  for (std::uint64_t k = 0; k < 24; ++k) {
    ExposureWorld world = clipped_green(900 + k);
    if (k % 2 == 1) world.response = film;
    if (k % 3 == 0) world.bits = 8;
    if (k % 4 == 2) world.red = world.blue = 0, world.channels = 3;
    const Overflow found = find(world);
    EXPECT_FALSE(found.found()) << k << ": " << found.along << ", " << found.across << ", p " << found.p;
  }
}

// 20 stacks, 40 shares: of intervals at 95 % fewer than 33 cover with a chance of 0.4 %.
TEST(Overflow, IntervalsCoverTheShares) {
  int covered = 0;
  double along = 0, across = 0;
  constexpr int runs = 20;
  for (int k = 0; k < runs; ++k) {
    ExposureWorld world = clipped_green(950 + static_cast<std::uint64_t>(k));
    world.along = 0.012, world.across = 0.006;
    const Overflow found = find(world);
    ASSERT_TRUE(found.found()) << k;
    EXPECT_LT(found.without, 0.9 * found.with);
    EXPECT_GT(found.repaired, 0.9);
    covered += std::abs(found.along - world.along) < 1.96 * found.sigma_along;
    covered += std::abs(found.across - world.across) < 1.96 * found.sigma_across;
    along += found.along / runs, across += found.across / runs;
  }
  EXPECT_GE(covered, 33);
  EXPECT_NEAR(along, 0.012, 0.012 * 0.02);
  EXPECT_NEAR(across, 0.006, 0.006 * 0.03);
  std::cout << "covered " << covered << " of 40, in the mean " << along << " and " << across << "\n";
}

}  // namespace
}  // namespace gonio::explain::stacks
