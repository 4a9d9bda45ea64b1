// The page and the entry of an explanation, from a problem whose answer is known: what is there, in which order, and
// what is folded away.
#include "inference/report.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/atomic_file.h"
#include "data.h"
#include "explain/engine.h"
#include "inference/entry.h"
#include "inference/evidence.h"
#include "inference/law_world.h"
#include "manifest/document.h"
#include "manifest/sections/file.h"

namespace gonio::explain::tests {
namespace {

// The world of laws with two mechanisms beside it: one explains, one cannot be seen.
class NamedProblem : public LawProblem {
 public:
  NamedProblem(const World& world, std::uint64_t seed) : LawProblem(world, seed) {
    mechanisms_[0].id = "plate.bow", mechanisms_[1].id = "plate.tilt";
    for (mechanism::Mechanism& m : mechanisms_) m.stage = "plate", m.conditions = {"plate.height"};
    mechanisms_[0].mistaken_for = {{"plate.tilt", "turn the plate over"}};
    first_ = parameters_.size();
    parameters_.push_back(
        {.name = "plate.bow.sag_m", .unit = "m", .start = 0.01, .lower = -1, .upper = 1, .size = 0.01});
    parameters_.push_back({.name = "plate.tilt.t", .unit = "1", .start = 0.01, .lower = -1, .upper = 1, .size = 0.01});
    candidates_ = {{&mechanisms_[0], {}, {first_}, {}}, {&mechanisms_[1], {}, {first_ + 1}, {}}};
  }
  void predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const override {
    LawProblem::predict(values, group, prediction);
    for (std::size_t i = 0; i < prediction.size(); ++i) {
      const double x = observations_.conditions[0].values[observations_.first[group] + i];
      prediction[i] += 10 * values[first_] * x * x + values[first_ + 1] * x;  // the tilt is what the slope takes
    }
  }

 private:
  mechanism::Mechanism mechanisms_[2];
  std::size_t first_ = 0;
};

struct Told {
  NamedProblem problem;
  Explanation e;
  manifest::Value entry;
  std::string page;
  Told(const LawProblem::World& world, std::uint64_t seed) : problem(world, seed) {
    e = explain(problem, {.draws = 499});
    const Illustration nothing;
    entry = entry_of(problem, e, nothing);
    page = report_page("folder/plates.json", {{&problem, &e, &nothing}});
  }
};

TEST(Report, ANamedEffectIsReadFromTopToBottom) {
  const Told told({.law = [](double x, double) { return 0.3 * x * x; }}, 1);
  ASSERT_EQ(told.e.verdict, Verdict::named) << told.e.sentence;
  EXPECT_NE(told.e.sentence.find("(plate.bow: sag 29.8 ± 0.6 mm)"), std::string::npos) << told.e.sentence;
  EXPECT_NE(told.e.sentence.find("range of the height"), std::string::npos) << told.e.sentence;
  std::size_t at = 0;
  for (const char* part : {"<h1", "(plate.bow", "<h2>Where", "<h2>Which curve", "<h2>How sure",
                           "Verdict: named", "with the named physics", "<h2>What to measure next",
                           "turn the plate over", "<h2>What was weighed", "<details>", "All hypotheses",
                           "What these recordings could show", "Cannot be seen in these recordings: plate.tilt."}) {
    const std::size_t found = told.page.find(part, at);
    ASSERT_NE(found, std::string::npos) << part;
    at = found;
  }
  EXPECT_EQ(told.page.find("<h2>Outside"), std::string::npos);
  EXPECT_EQ(told.page.find("http"), told.page.find("http-equiv"));  // nothing is loaded from elsewhere
  EXPECT_NE(told.page.find("<title>explain: plates.json"), std::string::npos);
}

TEST(Report, WhatTheLibraryLacksIsToldAsALaw) {
  const Told told({.law = [](double x, double z) { return 0.3 * x * z; }}, 2);
  ASSERT_EQ(told.e.verdict, Verdict::unknown) << told.e.sentence;  // no curve over one condition alone sees x z
  EXPECT_NE(told.e.sentence.find("(plate.height / 1 m) * (clock.time / 1 s)"), std::string::npos) << told.e.sentence;
  const Told other({.law = [](double, double z) { return 0.3 * z; }}, 3);
  ASSERT_EQ(other.e.verdict, Verdict::unknown) << other.e.sentence;
  ASSERT_TRUE(other.e.outside.has_value());
  ASSERT_EQ(other.e.outside->terms.size(), 1u) << other.e.outside->law;
  EXPECT_NE(other.e.sentence.find("Outside the library, a law describes it: residual = (0.3"), std::string::npos)
      << other.e.sentence;
  EXPECT_NE(other.page.find("<h2>Outside the library"), std::string::npos);
  const manifest::Value* outside = other.entry.find("outside");
  ASSERT_NE(outside, nullptr);
  const manifest::Value& term = outside->find("terms")->as_array().at(0);
  EXPECT_EQ(term.find("unit")->as_string(), "px s^-1");
  EXPECT_NEAR(term.find("coefficient")->as_number(), 0.3, 4 * term.find("sigma")->as_number());
  EXPECT_NEAR(term.find("powers")->find("clock.time")->as_number(), 1, 0);
  EXPECT_LT(outside->find("held_out")->find("after")->as_number(),
            outside->find("held_out")->find("before")->as_number());
  EXPECT_TRUE(other.entry.find("named")->as_array().empty());  // never dressed up as a known effect
}

TEST(Report, SeveralKindsOfRecordingsShareOnePage) {
  const Told one({.law = [](double x, double) { return 0.3 * x * x; }}, 1), two({}, 4);
  const Illustration nothing;
  const std::string page =
      report_page("rig.json", {{&one.problem, &one.e, &nothing}, {&two.problem, &two.e, &nothing}});
  EXPECT_NE(page.find("plates: plate.bow is left out; plates: nothing that matters is left out</h1>"),
            std::string::npos);
  EXPECT_NE(page.find(one.e.sentence.substr(0, 60)), std::string::npos);
  EXPECT_NE(page.find("No mismatch beyond noise"), std::string::npos);
}

TEST(Report, NothingLeftOutNeedsNoPlan) {
  const Told told({}, 4);
  EXPECT_EQ(told.e.verdict, Verdict::null) << told.e.sentence;
  EXPECT_NE(told.page.find("nothing is left out, as far as these recordings can show"), std::string::npos);
  EXPECT_NE(told.e.next_measurement.find("cannot show plate.tilt"), std::string::npos) << told.e.next_measurement;
}

TEST(Evidence, TheTableHoldsEveryRow) {
  const Told told({.law = [](double x, double) { return 0.3 * x * x; }}, 5);
  const gonio::tests::ScratchFolder scratch;
  const std::filesystem::path folder = scratch.path();
  manifest::Document document;
  document.folder = folder;
  const std::string id = write_evidence(told.problem, told.e, "plates", folder, document);
  EXPECT_EQ(id, "evidence-plates");
  EXPECT_TRUE(document.files.contains(id));
  const std::string text = read_file(folder / "evidence-plates.csv");
  EXPECT_TRUE(text.starts_with("row,group,observed,before,after,sigma,effect\n0,take-0,"));
  EXPECT_EQ(static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')),
            1 + told.problem.observations().rows());
}

}  // namespace
}  // namespace gonio::explain::tests
