// Inverse kinematics of arms without a closed form: random geometry, published arms with offset wrists, arms read from
// the flange.
#include <gmock/gmock.h>

#include "inverse_world.h"
#include "robot/axis_rows.h"
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

// Six random axes in the base.
std::vector<AxisLine> random_axes(Random& random) {
  std::vector<AxisLine> axes;
  for (int i = 0; i < 6; ++i)
    axes.push_back({normalized(Vec3{random.normal(), random.normal(), random.normal()}),
                    {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}});
  return axes;
}

// Arms of one special kind, ten of them, and their answers.
template <class Change>
Tally tally_of(const char* what, Family family, const Change& change) {
  Random random(73, 1);
  Tally tally;
  for (int arm = 0; arm < 10; ++arm) {
    std::vector<AxisLine> axes = random_axes(random);
    change(axes);
    const ChainRows rows = rows_of(axes, {{}, {0.1, 0.2, 0.3}});
    const InverseKinematics inverse(rows.links);
    EXPECT_EQ(inverse.family(), family) << what;
    for (int i = 0; i < 20; ++i) tally.take(inverse, rows.links, random_joints(random));
  }
  std::printf("%s: %s\n", what, tally.words().c_str());
  // Near double roots, where two branches meet, an answer is as good as the root of its error.
  EXPECT_LT(tally.worst_m, 1e-9) << what;
  EXPECT_LT(tally.worst_rad, 1e-9) << what;
  return tally;
}

TEST(InverseGeneral, ArmsReadFromTheFlange) {
  const auto parallel = tally_of("axes 3, 4, 5 parallel", Family::three_parallel,
                                 [](auto& axes) { axes[3].direction = axes[4].direction = axes[2].direction; });
  EXPECT_EQ(parallel.lost, 0);
  const auto meeting = tally_of("axes 1, 2, 3 meet", Family::spherical_wrist,
                                [](auto& axes) { axes[1].through_m = axes[2].through_m = axes[0].through_m; });
  EXPECT_EQ(meeting.lost, 0);
}

TEST(InverseGeneral, SphericalWristsOnAnyArm) {
  const auto meet = [](auto& axes) { axes[4].through_m = axes[5].through_m = axes[3].through_m; };
  EXPECT_EQ(tally_of("spherical wrist", Family::spherical_wrist, meet).lost, 0);
  EXPECT_EQ(tally_of("spherical wrist, axes 1, 2 parallel", Family::spherical_wrist,
                     [&](auto& axes) {
                       meet(axes);
                       axes[1].direction = axes[0].direction;
                     })
                .lost,
            0);
  EXPECT_EQ(tally_of("spherical wrist, axes 1, 2 meet", Family::spherical_wrist,
                     [&](auto& axes) {
                       meet(axes);
                       axes[1].through_m = axes[0].through_m;
                     })
                .lost,
            0);
}

TEST(InverseGeneral, TwoAxesParallelOrMeeting) {
  EXPECT_EQ(
      tally_of("axes 2, 3 parallel", Family::general, [](auto& axes) { axes[2].direction = axes[1].direction; }).lost,
      0);
  EXPECT_EQ(tally_of("axes 5, 6 meet", Family::general, [](auto& axes) { axes[5].through_m = axes[4].through_m; }).lost,
            0);
  EXPECT_EQ(tally_of("axes 1, 2 meet, 2, 3 parallel, 4, 5 meet", Family::general,
                     [](auto& axes) {
                       axes[1].through_m = axes[0].through_m;
                       axes[2].direction = axes[1].direction;
                       axes[4].through_m = axes[3].through_m;
                     })
                .lost,
            0);
}

}  // namespace
}  // namespace gonio::robot
