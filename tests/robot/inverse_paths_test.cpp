// Along paths: branches that go on, singular postures, the edge of reach; whole turns; what singular values say.
#include <gmock/gmock.h>

#include "base/error.h"
#include "inverse_world.h"
#include "robot/inverse/singularity.h"
#include "robot/inverse/turns.h"

namespace gonio::robot {
namespace {

using namespace inverse_world;

Joints between_joints(const Joints& a, const Joints& b, double t) {
  Joints q;
  for (std::size_t i = 0; i < 6; ++i) q[i] = a[i] + (b[i] - a[i]) * t;
  return q;
}

// Joints move in a straight line; the answer of the branch that they stand in must be they, and that branch must change
// only where a factor of the determinant changes its sign.
TEST(InversePaths, BranchesGoOnUntilASingularPosture) {
  for (const Arm& arm : known_arms()) {
    const InverseKinematics inverse(arm.links);
    Random random(53, 1);
    int changes = 0;
    for (int path = 0; path < 20; ++path) {
      const Joints from = random_joints(random), to = random_joints(random);
      int branch = inverse.branch_of(from);
      for (int i = 0; i <= 40; ++i) {
        const Joints q = between_joints(from, to, i / 40.0);
        const auto f = *inverse.factors_at(q),
                   before = *inverse.factors_at(between_joints(from, to, (i - (i > 0)) / 40.0));
        const bool crossed =
            f.shoulder_m * before.shoulder_m < 0 || f.elbow * before.elbow < 0 || f.wrist * before.wrist < 0;
        EXPECT_EQ(inverse.branch_of(q) != branch, crossed) << arm.name;
        branch = inverse.branch_of(q);
        changes += crossed;
        const auto answers = inverse.solve(flange(arm.links, q));
        const auto own =
            std::find_if(answers.begin(), answers.end(), [&](const auto& a) { return a.branch == branch; });
        ASSERT_NE(own, answers.end()) << arm.name;
        EXPECT_LT(wrapped_difference(own->joints_rad, q), 1e-6) << arm.name << " " << branch_name(branch);
      }
    }
    EXPECT_GT(changes, 20);
  }
}

// The factors are the determinant's: their product and det J have one ratio in all postures.
TEST(InversePaths, FactorsMakeTheDeterminant) {
  for (const Arm& arm : known_arms()) {
    const InverseKinematics inverse(arm.links);
    Random random(59, 1);
    double least = 1e300, most = -1e300;
    for (int i = 0; i < 50; ++i) {
      const Joints q = random_joints(random);
      const auto f = *inverse.factors_at(q);
      const std::vector<Motion> m = joint_motions(arm.links, q);
      std::array<std::array<double, 6>, 6> a;
      for (std::size_t k = 0; k < 6; ++k)
        a[k] = {m[k].shift_m.x, m[k].shift_m.y, m[k].shift_m.z, m[k].turn_rad.x, m[k].turn_rad.y, m[k].turn_rad.z};
      double det = 1;
      for (std::size_t c = 0; c < 6; ++c) {  // Gauss
        std::size_t pivot = c;
        for (std::size_t r = c; r < 6; ++r)
          if (std::abs(a[r][c]) > std::abs(a[pivot][c])) pivot = r;
        if (pivot != c) std::swap(a[pivot], a[c]), det = -det;
        det *= a[c][c];
        for (std::size_t r = c + 1; r < 6; ++r) {
          const double by = a[r][c] / a[c][c];
          for (std::size_t k = c; k < 6; ++k) a[r][k] -= by * a[c][k];
        }
      }
      const double ratio = det / (f.shoulder_m * f.elbow * f.wrist);
      least = std::min(least, ratio), most = std::max(most, ratio);
    }
    EXPECT_LT(most - least, 1e-6 * std::abs(most)) << arm.name;
  }
}

// Through a straight wrist: with the last answer as hint joints go on by small steps, the singular pose itself among
// them; without, the pose leaves a joint free and says so.
TEST(InversePaths, ThroughAStraightWrist) {
  for (const Arm& arm : known_arms()) {
    const InverseKinematics inverse(arm.links);
    constexpr int half = 50;
    const Joints start{0.4, -1.1, 0.9, 0.7, -0.2, 0.5}, end{0.6, -0.9, 1.1, 0.9, 0.2, 0.7};
    Joints last = start;
    for (int i = 0; i <= 2 * half; ++i) {
      Joints q = between_joints(start, end, i / (2.0 * half));
      if (i == half) q[4] = 0;
      const auto answers = inverse.solve(flange(arm.links, q), last);
      const JointAnswer* now = nearest(answers, last);
      ASSERT_NE(now, nullptr);
      EXPECT_TRUE(now->exact);
      // UR's twist of 1.570796327 leaves the axes 4e-10 rad apart at joint 5 = 0.
      if (i == half) {
        EXPECT_TRUE(now->undetermined || wrapped_difference(now->joints_rad, q) < 1e-5) << arm.name;
      }
      EXPECT_LT(wrapped_difference(now->joints_rad, last), 0.05) << arm.name << " at " << i;
      last = now->joints_rad;
      for (std::size_t k = 0; k < 6; ++k) last[k] = q[k] + std::remainder(last[k] - q[k], 2 * pi);
    }
    EXPECT_LT(wrapped_difference(last, end), 0.05) << arm.name;
  }
}

// A target that comes into reach: the arm, stretched towards it, says by how much it misses, and bends without a jump.
TEST(InversePaths, OverTheEdgeOfReach) {
  for (const Arm& arm : known_arms()) {
    const InverseKinematics inverse(arm.links);
    const auto pose = flange(arm.links, Joints{0.3, arm.name[0] == 'u' ? -0.8 : 0.8, 0.5, 0.2, 1.0, 0.3});
    const Vec3 outward = normalized(Vec3{pose.translation_m.x, pose.translation_m.y, 0.2});
    Joints last{};
    bool within = false;
    double missed_m = 10;
    for (int i = 400; i >= 0; --i) {
      auto target = pose;
      target.translation_m += outward * (0.004 * i);
      const auto answers = inverse.solve(target);
      ASSERT_FALSE(answers.empty());
      const JointAnswer* now = i == 400 ? &answers.front() : nearest(answers, last);
      // The elbow opens by the root of the distance to the edge.
      if (i < 400) {
        EXPECT_LT(wrapped_difference(now->joints_rad, last), 0.35) << arm.name << " at " << i;
      }
      if (!now->exact) {
        EXPECT_FALSE(within) << arm.name;
        EXPECT_LE(now->position_error_m, missed_m) << arm.name;
        if (i == 400) {
          EXPECT_GT(now->position_error_m, 0.1) << arm.name;
        }
        EXPECT_LT(now->rotation_error_rad, 1e-6);  // turned as asked for
        missed_m = now->position_error_m;
      }
      within |= now->exact;
      last = now->joints_rad;
    }
    EXPECT_TRUE(within) << arm.name;
    EXPECT_LT(missed_m, 0.005) << arm.name;
  }
}

TEST(InversePaths, WholeTurns) {
  const Joints answer{3.0, 0.1, -3.0, 1, 2, 3};
  const std::vector<JointLimit> wide(6, JointLimit{-2 * pi, 2 * pi, 3, 5});
  const Joints near{-3.2, 0, 3.1, 7, -4, -3.4};
  const auto turned = with_turns(answer, near, wide);
  ASSERT_TRUE(turned.has_value());
  const double expected[] = {3.0 - 2 * pi, 0.1, -3.0 + 2 * pi, 1, 2 - 2 * pi, 3 - 2 * pi};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR((*turned)[i], expected[i], 1e-12);
  const auto all = all_turns(answer, near, wide);
  EXPECT_EQ(all.size(), 64u);
  EXPECT_EQ(all.front(), *turned);
  auto narrow = wide;
  narrow[2] = {-1, 1, 3, 5};
  EXPECT_FALSE(with_turns(answer, near, narrow).has_value());
  EXPECT_TRUE(all_turns(answer, near, narrow).empty());
  narrow[2] = {};  // endless: the nearest
  narrow[1] = {0, 2 * pi, 3, 5};
  EXPECT_EQ(all_turns(answer, {0, 0, 40, 0, 0, 0}, narrow).size(), 16u);
  EXPECT_NEAR((*with_turns(answer, {0, 0, 40, 0, 0, 0}, narrow))[2], 40, pi);
}

TEST(InversePaths, SingularPosturesHaveNames) {
  const Arm& arm = known_arm("abb-irb-1600", "test");
  const InverseKinematics inverse(arm.links);
  const Joints good{0.2, 0.3, -0.2, 0.5, 1.0, 0.1};
  const Dexterity fine = dexterity_at(inverse, arm.links, good, 0.1);
  EXPECT_GT(fine.smallest_m, 0.02);
  Joints straight = good;
  straight[4] = 0.01;
  const Dexterity wrist = dexterity_at(inverse, arm.links, straight, 0.1);
  EXPECT_EQ(wrist.nearest, Singular::wrist);
  EXPECT_EQ(wrist.words, "wrist: axis 6 is 0.6 deg from in line with axis 4");
  EXPECT_LT(wrist.smallest_m, 0.002);
  EXPECT_GT(std::abs(wrist.worst[3] * wrist.worst[5]), 0.4);
  EXPECT_DOUBLE_EQ(smallest_singular_m(arm.links, straight, 0.1), wrist.smallest_m);
  Joints stretched = good;
  stretched[2] = -pi / 2 + 0.02;
  EXPECT_EQ(dexterity_at(inverse, arm.links, stretched, 0.1).nearest, Singular::elbow);
  const Arm& universal = known_arm("ur5e", "test");
  const InverseKinematics other(universal.links);
  EXPECT_THAT(dexterity_at(other, universal.links, {0.3, -1.2, 1.1, 0.4, 0.02, 0.2}, 0.1).words,
              testing::StartsWith("wrist: axis 6 is 1.1 deg from parallel"));
  // Another length: turns weigh more, the smallest singular value grows with them.
  EXPECT_GT(dexterity_at(inverse, arm.links, straight, 1).smallest_m, wrist.smallest_m);
}

TEST(InversePaths, RefusesWhatIsNoSixJointArm) {
  std::vector<Link> five(5, Link{0.1, 0.1, 0.1, 0});
  try {
    InverseKinematics inverse(five, "lab.json#/robots/left");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::data);
    EXPECT_STREQ(e.what(), "lab.json#/robots/left: has 5 joints, inverse kinematics are for 6");
  }
  five.push_back({0.1, std::nan(""), 0.1, 0});
  EXPECT_THROW(InverseKinematics{five}, Error);
}

}  // namespace
}  // namespace gonio::robot
