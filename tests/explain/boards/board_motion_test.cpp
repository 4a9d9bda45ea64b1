// Motions of a rolling shutter that follow from where the board stands are none (explain/boards/boards_motion.cpp).
#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "explain/boards/board_world.h"
#include "explain/boards/boards_problem.h"
#include "manifest/document.h"

namespace gonio::explain::tests {
namespace {

struct Shutter {
  BoardsInput input;
  std::unique_ptr<Problem> problem;
  std::size_t candidate = 0;
  Explanation e;

  explicit Shutter(std::size_t views, std::uint64_t seed) {
    const prove::BoardCase made = prove::board_case("c", {}, views, seed);
    input = boards_input(manifest::parse_document(made.manifest, "c.json", "."));
    problem = boards_problem(input);
    for (const Parameter& p : problem->parameters()) e.values.push_back(p.neutral);
    for (const std::size_t p : problem->base()) e.values[p] = problem->parameters()[p].start;
    while (problem->candidates()[candidate].id() != "camera.rolling-shutter") ++candidate;
  }
  // `motion` of each view, m per readout; a number drawn for it comes with it.
  template <class Motion>
  bool contradicted(std::uint64_t seed, Motion motion) {
    Random random(seed, 3);
    for (const std::size_t p : problem->candidates()[candidate].parameters)
      e.values[p] = motion(input.views[problem->parameters()[p].groups.at(0)].camera_from_board, random.normal());
    const auto told = boards_objection(*problem, e, candidate);
    return told && told->contradicts();
  }
};

TEST(BoardMotion, ThatGoesWithTheBoardsTiltIsContradicted) {
  for (const std::size_t views : {9u, 14u, 30u}) {
    Shutter shutter(views, 4);
    EXPECT_TRUE(shutter.contradicted(1, [](const camera::BoardPose& pose, double drawn) {
      return 3e-4 * pose.rotate({0, 0, 1}).x + 2e-5 * drawn;
    })) << views;
  }
}

// A print that is stretched along one axis: every view is stretched along the board's, wherever that points.
TEST(BoardMotion, ThatGoesWithTheBoardsRollIsContradicted) {
  Shutter shutter(8, 8);
  EXPECT_TRUE(shutter.contradicted(1, [](const camera::BoardPose& pose, double drawn) {
    const Vec3 along = pose.rotate({1, 0, 0});
    return 3e-4 * std::sin(2 * std::atan2(along.y, along.x)) + 1e-5 * drawn;
  }));
}

// A hand's motions: of two hundred sets of fourteen views at most four are contradicted.
TEST(BoardMotion, OfAHandIsNot) {
  Shutter shutter(14, 5);
  std::size_t wrong = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed)
    wrong += shutter.contradicted(seed, [](const camera::BoardPose&, double drawn) { return 1e-4 * drawn; });
  EXPECT_LE(wrong, 4u);
}

TEST(BoardMotion, OfFewViewsIsNotAsked) {
  Shutter shutter(7, 6);
  EXPECT_FALSE(shutter.contradicted(1, [](const camera::BoardPose& pose, double) { return pose.rotate({0, 0, 1}).x; }));
}

TEST(BoardMotion, OtherCandidatesAreNotAsked) {
  Shutter shutter(10, 7);
  shutter.contradicted(1, [](const camera::BoardPose&, double drawn) { return 1e-4 * drawn; });  // all views move
  for (std::size_t c = 0; c < shutter.problem->candidates().size(); ++c)
    EXPECT_EQ(boards_objection(*shutter.problem, shutter.e, c).has_value(), c == shutter.candidate) << c;
}

}  // namespace
}  // namespace gonio::explain::tests
