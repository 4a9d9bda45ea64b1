// Inverse kinematics of arms without a closed form: random geometry, published arms with offset wrists, arms read from
// the flange.
#include <gmock/gmock.h>

#include "inverse_world.h"
#include "robot/inverse/inverse_kinematics.h"

namespace gonio::robot {
namespace {

using namespace inverse_world;

std::vector<Link> random_links(Random& random) {
  std::vector<Link> links;
  for (int i = 0; i < 6; ++i)
    links.push_back(
        {random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(-pi, pi), random.uniform(-pi, pi)});
  return links;
}

TEST(InverseGeneral, RandomGeometry) {
  Random random(47, 1);
  Tally tally;
  for (int arm = 0; arm < poses_of_a_run(40); ++arm) {
    const std::vector<Link> links = random_links(random);
    const InverseKinematics inverse(links);
    EXPECT_EQ(inverse.family(), Family::general);
    EXPECT_FALSE(inverse.has_branches());
    for (int i = 0; i < 5; ++i) tally.take(inverse, links, random_joints(random));
  }
  std::printf("%s\n", tally.words().c_str());
  EXPECT_EQ(tally.lost, 0);
  EXPECT_EQ(tally.repeated, 0);
  EXPECT_LT(tally.worst_m, 1e-11);
  EXPECT_LT(tally.worst_rad, 1e-11);
}

}  // namespace
}  // namespace gonio::robot
