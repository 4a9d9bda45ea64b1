// What solvers refuse, in which words.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "base/error.h"
#include "synthetic.h"

namespace gonio::nrsfm::testing {
namespace {

using ::testing::HasSubstr;

template <class Call>
void refused(Call call, Exit code, const std::string& words) {
  try {
    call();
    FAIL() << "nothing refused; expected: " << words;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    EXPECT_THAT(error.what(), HasSubstr(words));
    EXPECT_FALSE(error.remedy().empty()) << error.what();
  }
}

TEST(Registry, names_every_solver_once_with_source_and_bounds) {
  std::set<std::string> ids;
  for (const Solver* solver : all_solvers()) {
    const SolverInfo& info = solver->info();
    EXPECT_TRUE(ids.insert(info.id).second) << info.id;
    EXPECT_EQ(find_solver(info.id), solver);
    EXPECT_FALSE(info.title.empty() || info.sentence.empty() || info.source.empty()) << info.id;
    EXPECT_TRUE(info.orthographic || info.perspective) << info.id;
    for (const SolverParameter& p : info.parameters) {
      EXPECT_LE(p.lower, p.preset) << info.id << " " << p.name;
      EXPECT_LE(p.preset, p.upper) << info.id << " " << p.name;
      EXPECT_FALSE(p.meaning.empty()) << info.id << " " << p.name;
    }
  }
  EXPECT_EQ(find_solver("no-such"), nullptr);
}

TEST(Refusals, missing_tracks_where_a_solver_needs_all) {
  Sequence s = made({.shapes = 2, .cosines = 2});
  hide(s, 3, 4);
  refused([&] { answer("pta", s); }, Exit::data, "of the tracks are missing, and pta needs all of them");
}

TEST(Refusals, a_rank_that_the_tracks_cannot_have) {
  const Sequence s = made({.frames = 20, .points = 12});
  refused([&] { answer("pta", s, {{"terms", 5}}); }, Exit::data, "12 points in 20 frames have no rank of 3 x 5");
}

TEST(Refusals, unknown_and_impossible_parameters) {
  const Sequence s = made({});
  refused([&] { answer("pta", s, {{"ranks", 5}}); }, Exit::usage, "no parameter ranks; pta has terms");
  refused([&] { answer("csf", s, {{"rank", 2.5}}); }, Exit::usage, "rank=2.5 is out of bounds; whole numbers from 0");
  refused([&] { answer("csf", s, {{"rank", -1}}); }, Exit::usage, "rank=-1 is out of bounds");
  refused([&] { answer("csf", s, {{"rank", 4}, {"dct_terms", 3}}); }, Exit::data, "dct_terms=3 with rank 4");
}

TEST(Refusals, views_that_never_turn_out_of_the_plane) {
  const Sequence s = made({.turn_rad = 0});
  refused([&] { answer("rigid", s); }, Exit::data, "no view turns out of it");
}

TEST(Refusals, points_and_frames_that_are_seen_too_rarely) {
  Sequence s = made({});
  for (Eigen::Index f = 1; f < s.frames(); ++f) hide(s, f, 7);
  refused([&] { answer("rigid", s); }, Exit::data, "point 8 is seen in 1 frames, and rank 3 needs 2");
  s.visible.col(7).setConstant(false);
  for (const char* solver : {"rigid", "csf"})
    refused([&] { answer(solver, s); }, Exit::data, "point 8 is seen in 0 frames, and rank 3 needs 2");
  Sequence t = made({});
  for (Eigen::Index p = 3; p < t.points(); ++p) hide(t, 5, p);
  refused([&] { answer("rigid", t); }, Exit::data, "frame 6 sees 3 points, and rank 3 needs 4");
}

TEST(Refusals, sequences_whose_sizes_do_not_fit) {
  Sequence s = made({});
  s.visible.conservativeResize(s.frames() - 1, s.points());
  EXPECT_THROW(answer("rigid", s), Error);
}

TEST(Solver, enters_names_factors_and_values) {
  Sequence s = made({.shapes = 2, .cosines = 2});
  s.factors = {{"deformation", "bending"}};
  const Solution solution = answer("pta", s, {{"terms", 2}});
  EXPECT_EQ(solution.reconstruction.name, "pta");
  EXPECT_EQ(solution.reconstruction.sequence, "made");
  EXPECT_EQ(solution.reconstruction.factors, (Factors{{"algorithm", "pta"}, {"deformation", "bending"}}));
  EXPECT_EQ(solution.values.at("terms"), 2);
  EXPECT_TRUE(solution.reconstruction.rotations.front().isApprox(CameraRows(CameraRows::Identity()), 1e-9));
}

TEST(Solver, does_not_look_at_the_truth) {
  Sequence s = made({.shapes = 2, .cosines = 2, .noise = 0.01});
  const SolverValues values{{"rank", 2}, {"camera_rank", 2}};
  const Solution with = answer("csf", s, values);
  s.truth.reset();
  s.cameras.clear();
  const Solution without = answer("csf", s, values);
  EXPECT_TRUE((with.reconstruction.shapes.array() == without.reconstruction.shapes.array()).all());
}

}  // namespace
}  // namespace gonio::nrsfm::testing
