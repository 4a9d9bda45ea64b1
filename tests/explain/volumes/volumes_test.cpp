// explain on small CT volumes that tests/ct makes of a ball with a hollow: nothing is named where nothing was left out,
// a surface that was cut elsewhere and voxels of another size are named and measured, and a solid ball, on which the
// two look alike, is said not to tell them apart.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "base/random.h"
#include "ct/scanner.h"
#include "explain/engine.h"
#include "explain/volumes/ball_mesh.h"
#include "explain/volumes/volumes_problem.h"
#include "inference/explanation.h"

namespace gonio::explain {
namespace {

constexpr double voxel_m = 3e-4, outer_m = 25 * voxel_m, hollow_m = 11 * voxel_m;
const Vec3 centre{0.9 * voxel_m, -0.7 * voxel_m, 1.2 * voxel_m}, hollow{-5 * voxel_m, 4 * voxel_m, 3 * voxel_m};

// `cut`: how far the walls lie outside of the believed surface, voxels. `told`: the voxels' size over the true one.
struct Left {
  double cut = 0, told = 1;
  bool solid = false;
};

VolumesInput scanned(const Left& left) {
  ct::Scanner s;
  s.voxels = 64, s.voxel_m = voxel_m;
  s.spectrum = ct::mono(60);
  ct::ShapePtr shape = ct::ball(centre, outer_m);
  if (!left.solid) shape = ct::without(shape, ct::ball(hollow, hollow_m));
  VolumesInput input;
  input.name = "v", input.place = "test", input.mesh_name = "piece", input.attenuation = true;
  input.volume = ct::scan({"piece", {{"piece", shape, ct::plastic()}}, {}}, s);
  Random random(7, 1);
  for (float& v : input.volume.values) v += static_cast<float>(0.5 * random.normal());
  input.spacing_m = Vec3{1, 1, 1} * (voxel_m * left.told);
  namespace made = volumes::tests;
  input.mesh = made::ball_mesh(centre, outer_m - left.cut * voxel_m, false);
  if (!left.solid) made::join(input.mesh, made::ball_mesh(hollow, hollow_m + left.cut * voxel_m, true));
  return input;
}

struct Answer {
  std::unique_ptr<Problem> problem;
  Explanation e;
  std::vector<std::string> named, alike;
  double value = 0, sigma = 0;
};

Answer asked(const Left& left) {
  Answer a;
  a.problem = volumes_problem(scanned(left));
  inference::Options options;
  options.draws = 199, options.negative_controls = 12;
  a.e = inference::explain(*a.problem, options);
  for (const std::size_t c : a.e.named) a.named.push_back(a.problem->candidates()[c].id());
  for (const auto& set : a.e.not_told_apart)
    for (const std::size_t c : set) a.alike.push_back(a.problem->candidates()[c].id());
  if (!a.e.estimates.empty()) a.value = a.e.estimates[0].value, a.sigma = a.e.estimates[0].sigma;
  return a;
}

TEST(ExplainVolumes, NothingIsNamedWhereNothingWasLeftOut) {
  const Answer a = asked({});
  EXPECT_TRUE(a.named.empty()) << a.e.sentence;
}

TEST(ExplainVolumes, ASurfaceCutElsewhereIsNamed) {
  const Answer a = asked({.cut = 0.25});
  ASSERT_THAT(a.named, testing::ElementsAre("ct.threshold")) << a.e.sentence;
  EXPECT_NEAR(a.value, 0.25, 0.06);
}

TEST(ExplainVolumes, VoxelsOfAnotherSizeAreNamed) {
  const Answer a = asked({.told = 1.008});
  ASSERT_THAT(a.named, testing::ElementsAre("ct.scale")) << a.e.sentence;
  EXPECT_NEAR(a.value, 0.008, 0.0015);
}

// A solid ball has one radius: longer by a share is longer by a distance.
TEST(ExplainVolumes, OnASolidBallTheTwoAreNotToldApart) {
  const Answer a = asked({.cut = 0.25, .solid = true});
  EXPECT_THAT(a.named, testing::SizeIs(1)) << a.e.sentence;
  EXPECT_THAT(a.alike, testing::IsSupersetOf({"ct.threshold", "ct.scale"})) << a.e.sentence;
}

}  // namespace
}  // namespace gonio::explain
