// The registry of terms: each belongs to a mechanism of images, leaves the prediction alone at neutral and changes it
// otherwise, and the conditions that carry its signature are among those of the problem.
// One process: BallOnATable.*
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "ball_world.h"
#include "explain/images/images_problem.h"
#include "manifest/document.h"
#include "relighting/uses.h"
#include "scene/mechanisms.h"

namespace gonio::explain {
namespace {

using images::ImagesProblem;

TEST(ImageTerms, EveryOneIsAMechanismOfImages) {
  for (const images::Term* term : images::all_terms()) {
    const mechanism::Mechanism& m = term->mechanism();
    EXPECT_NE(std::find(m.domains.begin(), m.domains.end(), "images"), m.domains.end()) << m.id;
    EXPECT_TRUE(term->edit || term->shade || term->add || term->record) << m.id;
    EXPECT_FALSE(m.typical.empty()) << m.id;
  }
}

class BallOnATable : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new tests::ScratchFolder;
    problem_ = new ImagesProblem(tests::record_ball(*folder_, "", "", 16, 3), {.pixels = 900});
  }
  static void TearDownTestSuite() {
    delete problem_;
    delete folder_;
  }
  static std::vector<double> neutral() {
    std::vector<double> values;
    for (const Parameter& p : problem_->parameters()) values.push_back(p.neutral);
    return values;
  }
  static void expect_differences(const std::vector<double>& values, const std::vector<std::size_t>& columns);
  static std::vector<double> predicted(const std::vector<double>& values) {
    const Observations& o = problem_->observations();
    std::vector<double> all(o.rows());
    for (std::size_t g = 0; g < o.groups(); ++g)
      problem_->predict(values, g, {all.data() + o.first[g], o.first[g + 1] - o.first[g]});
    return all;
  }
  static tests::ScratchFolder* folder_;
  static ImagesProblem* problem_;
};
tests::ScratchFolder* BallOnATable::folder_ = nullptr;
ImagesProblem* BallOnATable::problem_ = nullptr;

TEST_F(BallOnATable, EveryCandidateActsAndVanishes) {
  const std::vector<double> values = neutral(), plain = predicted(values);
  for (const Candidate& c : problem_->candidates()) {
    std::vector<double> there = values;
    double moved = 0;
    for (const std::size_t p : c.parameters) {
      const Parameter& q = problem_->parameters()[p];
      there[p] = q.start != q.neutral ? q.start : 0.9 * q.neutral + 0.1 * q.upper;
      moved += there[p] != q.neutral;
    }
    EXPECT_GT(moved, 0) << c.id();
    const std::vector<double> with = predicted(there);
    if (c.id() == "surface.specular") continue;  // a second lobe of a gloss that is not there
    EXPECT_NE(with, plain) << c.id();
    for (const double v : with) ASSERT_TRUE(std::isfinite(v)) << c.id();
    for (const std::size_t p : c.parameters) there[p] = problem_->parameters()[p].neutral;
    EXPECT_EQ(predicted(there), plain) << c.id();
  }
  EXPECT_GE(problem_->candidates().size(), 18u);
}

TEST_F(BallOnATable, TheFirstConditionOfEveryCandidateIsThere) {
  for (const Candidate& c : problem_->candidates()) {
    const auto& known = problem_->observations().conditions;
    EXPECT_TRUE(std::any_of(c.mechanism->conditions.begin(), c.mechanism->conditions.end(), [&](const std::string& id) {
      return std::any_of(known.begin(), known.end(), [&](const Condition& k) { return k.name == id; });
    })) << c.id();
  }
}

// Within what the response's slope, which stands for its difference (derivatives.h), leaves.
void BallOnATable::expect_differences(const std::vector<double>& values, const std::vector<std::size_t>& columns) {
  const Observations& o = problem_->observations();
  const std::size_t rows = o.first[1] - o.first[0];
  std::vector<double> kept(rows * columns.size()), plain(kept.size());
  problem_->jacobian(values, 0, columns, kept);
  problem_->Problem::jacobian(values, 0, columns, plain);
  for (std::size_t k = 0; k < columns.size(); ++k)
    for (std::size_t i = 0; i < rows; ++i)
      ASSERT_NEAR(kept[k * rows + i], plain[k * rows + i], 1e-8 + 1e-4 * std::abs(plain[k * rows + i]))
          << problem_->parameters()[columns[k]].name;
}

// The derivatives that keep parts of a prediction against differences of whole predictions, with several terms in play.
// What adds to the picture from scenes of its own is differentiated at neutral alone: elsewhere it is taken to go along
// with the rest. Slopes of what moves pixels are those of differences as wide as their cells (displaced_test.cpp).
TEST_F(BallOnATable, JacobianIsTheDifferenceOfPredictions) {
  std::vector<double> values = neutral();
  std::vector<std::size_t> columns;
  for (const Candidate& c : problem_->candidates()) {
    if (scene::moves_pixels(*c.mechanism) || c.id() == "lens.lateral-colour") continue;
    for (const std::size_t p : c.parameters) {
      const Parameter& q = problem_->parameters()[p];
      if (c.id() != "surface.interface" && c.id() != "light.finite-size" && c.id() != "light.direction" &&
          c.id() != "sensor.saturation" && c.id() != "surface.specular" && c.mechanism->stage != "geometry" &&
          c.id() != "light.second-source" && c.id() != "optics.defocus")
        values[p] = q.neutral + 0.3 * (q.start - q.neutral);
      columns.push_back(p);
    }
  }
  expect_differences(values, columns);
  // What terms add goes along with what it is added to instead of being simulated anew: the base model's own columns
  // are exact where nothing is added.
  expect_differences(neutral(), problem_->base());
}

}  // namespace
}  // namespace gonio::explain
