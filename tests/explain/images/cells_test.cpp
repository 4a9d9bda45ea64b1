// One photograph alone: its cells are left out in turn.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <string>

#include "ball_world.h"
#include "explain/engine.h"
#include "explain/images/images_problem.h"
#include "manifest/document.h"

namespace gonio::explain {
namespace {

// Of six pictures of the ball, some.
manifest::Document few(const tests::ScratchFolder& folder, std::size_t images, const std::string& truth,
                       std::uint64_t seed) {
  manifest::Document document = tests::record_ball(folder, truth, "", 256, seed);
  document.images.resize(images);
  return document;
}

TEST(ImageCells, CoverThePictureAndShareNoBlock) {
  const tests::ScratchFolder folder;
  const images::ImagesProblem problem(few(folder, 2, "", 21), {.pixels = 1800});
  const Observations& o = problem.observations();
  ASSERT_EQ(o.groups(), 12u);
  EXPECT_EQ(o.group[0], problem.recordings().images[0].id + ", part 1");
  EXPECT_EQ(o.rows(), 3 * (problem.picked(0).size() + problem.picked(1).size()));
  std::map<std::uint32_t, std::size_t> group_of;
  for (std::size_t g = 0; g < o.groups(); ++g)
    for (std::size_t i = o.first[g]; i < o.first[g + 1]; ++i) {
      const auto [at, fresh] = group_of.try_emplace(o.block[i], g);
      EXPECT_EQ(at->second, g);
    }
}

TEST(ImageCells, ArePredictedAndDifferentiatedAsTheWholePicture) {
  const tests::ScratchFolder folder;
  const images::ImagesProblem problem(few(folder, 1, "", 22), {.pixels = 900});
  const Observations& o = problem.observations();
  std::vector<double> values;
  std::vector<std::size_t> columns = problem.base();
  for (const Parameter& p : problem.parameters()) values.push_back(p.neutral);
  for (const Candidate& c : problem.candidates())
    if (c.id() == "optics.vignetting" || c.id() == "light.ambient")
      columns.insert(columns.end(), c.parameters.begin(), c.parameters.end());
  std::vector<double> whole(o.rows());
  problem.model().predict(problem.model().layout().start, 0, problem.picked(0), whole);
  for (std::size_t g = 0; g < o.groups(); ++g) {
    const std::size_t rows = o.first[g + 1] - o.first[g];
    std::vector<double> mine(rows), slopes(rows * columns.size()), differences(slopes.size());
    problem.predict(values, g, mine);
    EXPECT_TRUE(std::equal(mine.begin(), mine.end(), whole.begin() + static_cast<std::ptrdiff_t>(o.first[g])));
    problem.jacobian(values, g, columns, slopes);
    problem.Problem::jacobian(values, g, columns, differences);
    double largest = 0;
    for (const double d : differences) largest = std::max(largest, std::abs(d));
    for (std::size_t i = 0; i < slopes.size(); ++i) EXPECT_NEAR(slopes[i], differences[i], 1e-4 * largest);
  }
}

// What acts on one picture acts on all its cells.
TEST(ImageCells, NumbersOfAPictureBelongToItsCells) {
  const tests::ScratchFolder folder;
  const images::ImagesProblem problem(few(folder, 2, "", 23), {.pixels = 900});
  std::size_t bound = 0;
  for (const Parameter& p : problem.parameters()) {
    if (p.groups.empty()) continue;
    ++bound;
    for (std::size_t image = 0; image < 2; ++image) {
      std::vector<std::size_t> cells(6);
      std::iota(cells.begin(), cells.end(), 6 * image);
      const bool first = std::ranges::count(p.groups, cells[0]) > 0;
      for (const std::size_t g : cells) EXPECT_EQ(std::ranges::count(p.groups, g) > 0, first) << p.name;
    }
    EXPECT_LT(p.groups.back(), 12u);
  }
  EXPECT_GT(bound, 0u);
}

TEST(ImageCells, OnePictureNamesWhatIsMissing) {
  const tests::ScratchFolder folder;
  const images::ImagesProblem problem(few(folder, 1, R"("optics.vignetting":{"falloff":0.2})", 24), {.pixels = 1200});
  const Explanation e = explain(problem, Options{});
  ASSERT_FALSE(e.named.empty()) << e.sentence;
  EXPECT_EQ(problem.candidates()[e.named[0]].id(), "optics.vignetting") << e.sentence;
}

TEST(ImageCells, OnePictureOfNothingNamesNothing) {
  const tests::ScratchFolder folder;
  const images::ImagesProblem problem(few(folder, 1, "", 25), {.pixels = 1200});
  const Explanation e = explain(problem, Options{});
  EXPECT_TRUE(e.named.empty()) << e.sentence;
}

}  // namespace
}  // namespace gonio::explain
