// Flips that were planted are found, none where there are none (at the stated rate), and mirrored truth is said to be
// so.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "base/error.h"
#include "nrsfm/evaluate/errors.h"
#include "shapes.h"
#include "stats/distributions.h"

namespace gonio::nrsfm {
namespace {

struct Planted {
  Shapes x;
  std::vector<Eigen::Vector3d> depth;  // in x's frame
};

// Noise that neighbours share, as reconstructions have it: a smooth field over the points of each frame, changing
// slowly.
Shapes bent(const Shapes& q, double sigma, std::uint64_t seed) {
  Random random(seed, 31);
  Eigen::Matrix3d linear[4], change[4];
  for (int k = 0; k < 4; ++k)
    for (int i = 0; i < 9; ++i) linear[k](i / 3, i % 3) = random.normal(), change[k](i / 3, i % 3) = random.normal();
  Shapes x = q;
  const Eigen::Index frames = q.rows() / 3;
  for (Eigen::Index f = 0; f < frames; ++f) {
    const double t = 6.28 * static_cast<double>(f) / static_cast<double>(frames);
    const Eigen::Matrix3d a =
        std::sin(t + seed) * linear[0] + std::cos(2 * t) * linear[1] + std::sin(3 * t) * linear[2];
    shape_of(x, f) += sigma / 0.1 * (a * shape_of(q, f));
    for (Eigen::Index i = 0; i < 3 * q.cols(); ++i) x(3 * f + i % 3, i / 3) += 0.3 * sigma * random.normal();
  }
  return x;
}

Planted planted(const Shapes& q, double sigma, const std::set<Eigen::Index>& reversed,
                const std::set<Eigen::Index>& mirrored, std::uint64_t seed) {
  Planted out{bent(q, sigma, seed), {}};
  Random random(seed, 5);
  for (Eigen::Index f = 0; f < q.rows() / 3; ++f) {
    const double angle = 0.05 * static_cast<double>(f);  // a camera that goes around
    const Eigen::Vector3d n(std::cos(angle), std::sin(angle), 0.3);
    out.depth.push_back(n.normalized());
    const Eigen::Vector3d centre = shape_of(out.x, f).rowwise().mean();
    const Eigen::Matrix3d turn = Eigen::Matrix3d::Identity() - 2 * out.depth.back() * out.depth.back().transpose();
    if (reversed.contains(f))
      shape_of(out.x, f) = ((turn * (shape_of(out.x, f).colwise() - centre)).colwise() + centre).eval();
    if (mirrored.contains(f)) shape_of(out.x, f) = (-(shape_of(out.x, f).colwise() - centre)).colwise() + centre;
  }
  const Eigen::Matrix3d r = tests::any_rotation(random);  // the reconstruction's own frame of reference
  out.x = tests::moved_all(out.x, 0.1, r, {1, 2, 3});
  for (Eigen::Vector3d& n : out.depth) n = r * n;
  return out;
}

std::set<Eigen::Index> found(const Flips& flips, FlipKind kind) {
  std::set<Eigen::Index> frames;
  for (const Flip& flip : flips.frames)
    if (flip.kind == kind) frames.insert(flip.frame);
  return frames;
}

// Of 78 in six sequences at least 74; measured: 76, frame 41 of two sequences lies at the limit. A false one in one of
// six sequences has a probability of at most 0.06, in two of 0.0015.
TEST(Flips, PlantedOnesAreFoundAndUndone) {
  const Shapes q = tests::deforming(80, 30, 3);
  const std::set<Eigen::Index> reversed{3, 4, 5, 20, 41, 66, 67, 68, 69, 79}, mirrored{10, 11, 50};
  std::size_t right = 0, wrong = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Planted p = planted(q, 0.008, reversed, mirrored, seed);
    const Flips flips = find_flips(p.x, q, {.depth = p.depth});
    for (const Flip& flip : flips.frames) {
      ((flip.kind == FlipKind::mirror ? mirrored : reversed).contains(flip.frame) ? right : wrong) += 1;
      EXPECT_LT(flip.error_after, 0.6 * flip.error_before) << seed << " " << flip.frame;
    }
    EXPECT_FALSE(flips.whole_sequence_mirrored);
    const double without = robust_error(planted(q, 0.008, {}, {}, seed).x, q).value;
    EXPECT_NEAR(robust_error(without_flips(p.x, flips.frames), q).value / without, 1, 0.02);
    EXPECT_NEAR(flips.error.value / without, 1, 0.02);
    EXPECT_GT(robust_error(p.x, q).value, 1.1 * without);
  }
  EXPECT_GE(right, 74);
  EXPECT_LE(wrong, 1);
}

// Without directions of depth the plane of each frame is found, too.
TEST(Flips, AreFoundWithoutDirectionsOfDepth) {
  const Shapes q = tests::deforming(80, 30, 3);
  const std::set<Eigen::Index> reversed{3, 4, 20, 41, 66, 67, 79};
  const Planted p = planted(q, 0.01, reversed, {}, 2);
  const Flips flips = find_flips(p.x, q);
  EXPECT_EQ(found(flips, FlipKind::depth_reversal), reversed);
  EXPECT_TRUE(found(flips, FlipKind::mirror).empty());
}

// False alarms at a rate of 0.05 a sequence over sequences without flips, with small to large errors: of 60 sequences
// more than 8 would have a probability below 0.003 (binomial).
TEST(Flips, FalseAlarmsAreAsRareAsStated) {
  int alarms = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const Shapes q = tests::deforming(40, 16, seed);
    const Planted p = planted(q, 0.005 * static_cast<double>(1 + seed % 8), {}, {}, seed);
    if (!find_flips(p.x, q, {.depth = seed % 2 == 0 ? p.depth : std::vector<Eigen::Vector3d>{}, .false_alarm = 0.05})
             .frames.empty())
      ++alarms;
  }
  EXPECT_LE(alarms, 8);
  EXPECT_LT(stats::binomial_upper(9, 60, 0.05), 0.003);
}

TEST(Flips, MirroredTruthSaysSoAndReconstructionsDoNot) {
  const Shapes q = tests::deforming(40, 30, 8);
  const Shapes x = tests::noisy(q, 0.01, 0.05, 1);
  EXPECT_FALSE(find_flips(q, q).whole_sequence_mirrored);
  EXPECT_FALSE(find_flips(x, q).whole_sequence_mirrored);
  EXPECT_TRUE(find_flips(-q, q).whole_sequence_mirrored);
  EXPECT_TRUE(find_flips(-q, q).frames.empty());
  const Flips mirrored = find_flips(-x, q);
  EXPECT_TRUE(mirrored.whole_sequence_mirrored);
  EXPECT_GT(mirrored.mirrored_z, 4);
}

TEST(Flips, DirectionsAreOnePerFrame) {
  const Shapes q = tests::deforming(10, 30, 8);
  EXPECT_THROW(find_flips(q, q, {.depth = {Eigen::Vector3d::UnitZ()}}), Error);
}

}  // namespace
}  // namespace gonio::nrsfm
