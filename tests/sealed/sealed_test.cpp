// The proof's own parts: makers that share no code with what they test, cases that say nothing about themselves, and a
// judge that can fail.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

#include "sealed/film.h"
#include "sealed/judge.h"
#include "sealed/matter.h"
#include "sealed/surviving.h"
#include "sealed/traced_lens.h"
#include "sealed/worlds.h"

namespace gonio::sealed {
namespace {

TEST(Sealed, MakersIncludeNothingOfTheSimulators) {
  const std::set<std::string> allowed{"base", "ct", "geom", "io", "manifest", "sealed", "stats", "report"};
  const std::set<std::string> of_tests{"data.h\"", "process.h\""};
  std::size_t includes = 0;
  for (const auto& file : std::filesystem::directory_iterator(GONIO_SOURCE "/tests/sealed")) {
    std::ifstream text(file.path());
    for (std::string line; std::getline(text, line);) {
      if (!line.starts_with("#include \"")) continue;
      const std::string name = line.substr(10);
      EXPECT_TRUE(of_tests.contains(name) || allowed.contains(name.substr(0, name.find('/'))))
          << file.path() << ": " << line;
      ++includes;
    }
  }
  EXPECT_GT(includes, 20u);
}

TEST(Sealed, ThereAreAtLeastThreeHundredCasesOfAllKindsAndTheirNamesAreUnique) {
  std::set<std::string> ids;
  std::set<Kind> kinds;
  for (const Spec& s : all_specs()) {
    ids.insert(case_id(s));
    kinds.insert(s.kind);
  }
  EXPECT_EQ(ids.size(), all_specs().size());
  EXPECT_GE(ids.size(), 300u);
  EXPECT_EQ(kinds.size(), 7u);
}

TEST(Sealed, EqualSpecsGiveEqualBytesAndNothingInThemTellsTheEffect) {
  const std::vector<Spec> specs = all_specs();
  const auto spec = std::find_if(specs.begin(), specs.end(), [](const Spec& s) { return s.kind == Kind::single; });
  ASSERT_NE(spec, specs.end());
  const Case a = make_case(*spec), b = make_case(*spec);
  EXPECT_EQ(a.files, b.files);
  for (const auto& [name, bytes] : a.files)
    for (const std::string& effect : spec->effects)
      EXPECT_EQ(bytes.find("\"" + effect + "\""), std::string::npos) << name;
}

TEST(Surviving, TakesAwayWhatTheRefitSwallows) {
  const std::vector<Numbers> line{{1, 1, 1, 1}, {0, 1, 2, 3}};
  const FreeParameters free(line, {0.1, 0.1, 0.1, 0.1});
  EXPECT_NEAR(length(free.surviving({3, 5, 7, 9})), 0, 1e-9);
  EXPECT_NEAR(length(free.surviving({1, -1, -1, 1})), 20, 1e-9);
  EXPECT_NEAR(left_beside({3, 4}, {{1, 0}}), 4, 1e-12);
}

// Third-order barrel distortion of a thin lens grows with its distance from the stop; without a distance a thin one has
// none (Kingslake & Johnson 2010, 12.3).
TEST(TracedLens, BarrelGrowsWithTheDistanceToTheStop) {
  const Singlet thin{.stop_m = 1e-9, .front_m = 6e-3, .back_m = -6e-3, .thickness_m = 1e-8};
  EXPECT_NEAR(image_height_ratio(thin, 0.4), 1, 1e-5);
  double last = 1;
  for (const double stop : {0.3e-3, 0.6e-3, 1.2e-3}) {
    const double ratio = image_height_ratio({.stop_m = stop}, 0.4);
    EXPECT_LT(ratio, last);
    last = ratio;
  }
  EXPECT_LT(last, 0.99);
}

// Schott's data sheet: n = 1.51680 at 587.56 nm. Colour shifts grow with the lens's distance from the stop, and the
// pupil moves with the square of the angle first.
TEST(TracedLens, ColoursPartAndThePupilMoves) {
  EXPECT_NEAR(crown_glass(0.58756), 1.51680, 1e-5);
  const Singlet lens{.stop_m = 2e-3};
  EXPECT_NEAR(colour_ratio(lens, lens.index, 0.5), 1, 1e-12);
  const double red = colour_ratio(lens, crown_glass(0.65), 0.3), blue = colour_ratio(lens, crown_glass(0.45), 0.3);
  EXPECT_GT(red, 1);
  EXPECT_LT(blue, 1);
  EXPECT_LT(colour_ratio({.stop_m = 1e-3}, crown_glass(0.65), 0.3), red);
  const Singlet front{.stop_m = 1e-3, .front_m = -8e-3, .back_m = 8e-3};
  EXPECT_NEAR(pupil_shift(front, 0.1) / pupil_shift(front, 0.05), 4, 0.1);
}

// A film half a wave thick is not there; a quarter of a wave of the root of the glass's index reflects nothing (Born &
// Wolf 1999, section 1.6.4). The band of 20 nm leaves a little.
TEST(Film, VanishesAtHalfAWaveAndCoatsAtAQuarter) {
  const double f0 = 0.04, glass = 1.5;
  EXPECT_NEAR(film_reflectance({0, 1.9}, f0, 0.6, 5.5e-7), fresnel(0.6, f0), 1e-12);
  EXPECT_NEAR(film_reflectance({5.5e-7 / (2 * 1.9), 1.9}, f0, 1, 5.5e-7), f0, 1e-3);
  EXPECT_NEAR(film_reflectance({5.5e-7 / (4 * std::sqrt(glass)), std::sqrt(glass)}, f0, 1, 5.5e-7), 0, 1e-4);
  EXPECT_NEAR(film_reflectance({5.5e-7 / (4 * 1.9), 1.9}, f0, 1, 5.5e-7),
              std::pow((1.9 * 1.9 - glass) / (1.9 * 1.9 + glass), 2), 1e-3);
}

TEST(Sealed, EveryDesignHasCases) {
  std::map<std::string, int> numbers;
  for (const Spec& s : all_specs()) numbers[s.domain + "/" + s.variant + "/" + std::string(kind_name(s.kind))] += 1;
  EXPECT_GE(numbers.size(), 40u);
  for (const WorldEntry& w : all_worlds())
    for (const Special& special : w.specials)
      EXPECT_TRUE(numbers.contains(w.domain + "/" + special.variant + "/" + std::string(kind_name(special.kind))))
          << w.domain << " " << special.variant;
}

TEST(AreaUnderCurve, IsOneForAPerfectOrderAndAHalfForNone) {
  Numbers score;
  std::vector<bool> affected;
  Random random(7);
  for (int k = 0; k < 400; ++k) {
    affected.push_back(k % 3 == 0);
    score.push_back(k % 3 == 0 ? 10 + k : k / 1000.0);
  }
  EXPECT_NEAR(*area_under_curve(score, affected), 1, 1e-12);
  for (double& s : score) s = random.uniform();
  EXPECT_NEAR(*area_under_curve(score, affected), 0.5, 0.1);
  EXPECT_NEAR(*area_under_curve(Numbers(400, 1.0), affected), 0.5, 1e-12);
  EXPECT_FALSE(area_under_curve(score, std::vector<bool>(400, true)).has_value());
}

// An effect that a refit balances crosses zero somewhere; what is left there does not say that the place was missed.
TEST(Affected, IsWhatHoldsMostOfTheEffectAndAtLeastTheNoise) {
  const Numbers effect{0.2, 0.9, 1.5, 2, 10, 12};
  EXPECT_EQ(affected(effect, false), (std::vector<bool>{false, false, true, true, true, true}));
  EXPECT_EQ(affected(effect, true), (std::vector<bool>{false, false, false, false, true, true}));
  EXPECT_EQ(affected({0.1, 0.3}, true), (std::vector<bool>{false, false}));
}

TEST(Declared, ConditionsAreReadFromTheListAsItIsPrinted) {
  const Declared d = declared_conditions(
      "Lights: what leaves the lamps\n\nlight.ambient\n    Weak light arrives.\n    seen in: light.visibility, "
      "image.radiance,\n      scene.depth\n    mistaken for a, told apart by: b\n      c, d\n\nlens.radial\n"
      "    seen in: camera.image-radius\n");
  ASSERT_EQ(d.size(), 2u);
  EXPECT_EQ(d.at("light.ambient"), (std::vector<std::string>{"light.visibility", "image.radiance", "scene.depth"}));
  EXPECT_EQ(d.at("lens.radial"), (std::vector<std::string>{"camera.image-radius"}));
}

Judged answered(Kind kind, const std::string& effect, const std::vector<std::string>& named) {
  Judged j;
  j.spec.domain = "boards";
  j.id = "case";
  j.truth = {.kind = kind, .strength = 100, .share = 0.5, .floor = 1, .floor_known = true};
  if (!effect.empty()) {
    j.truth.mechanisms = {effect};
    j.truth.values = {{effect, "p", 2.0}};
  }
  j.answer = {.ran = true,
              .verdict = named.empty() ? "null" : "named",
              .named = named,
              .reported = named,
              .before = 3,
              .after = 1.1};
  j.answer.set_size = named.size();
  for (const std::string& n : named) j.answer.fitted.push_back({n, "p", 2.1, 1.9, 2.3});
  if (!effect.empty()) j.answer.limit[effect]["p"] = 0.1;
  return j;
}

const Question& question(const Judgement& j, const std::string& name, const std::string& measure) {
  for (const Question& q : j.questions)
    if (q.question.starts_with(name) && q.measure.starts_with(measure)) return q;
  throw std::runtime_error("no question " + name);
}

TEST(Judge, CountsWhatIsRightAndWhatIsWrong) {
  std::vector<Judged> cases;
  for (int k = 0; k < 99; ++k) cases.push_back(answered(Kind::null, "", {}));
  cases.push_back(answered(Kind::null, "", {"lens.radial"}));
  for (int k = 0; k < 9; ++k) cases.push_back(answered(Kind::single, "lens.radial", {"lens.radial"}));
  cases.push_back(answered(Kind::single, "lens.radial", {"board.warp"}));
  cases.push_back(answered(Kind::outside, "", {"board.warp"}));
  const Judgement j = judge(cases);
  EXPECT_EQ(question(j, "nothing left out", "").all().right, 1);
  EXPECT_EQ(question(j, "nothing left out", "").all().asked, 100);
  EXPECT_TRUE(question(j, "nothing left out", "").met());
  EXPECT_EQ(question(j, "which, where it can be", "").all().right, 9);
  EXPECT_EQ(question(j, "outside the library", "wrongly").all().right, 1);
  EXPECT_FALSE(question(j, "outside the library", "wrongly").met());
  EXPECT_NEAR(question(j, "how much", "parameter").figure(), 0.05, 1e-9);
  EXPECT_EQ(question(j, "how much", "95 %").all().right, 9);
  EXPECT_NEAR(question(j, "repaired", "(before").figure(), 0.95, 1e-9);
  EXPECT_EQ(question(j, "falsely certain", "").all().right, 3);
  EXPECT_EQ(j.failures.size(), 6u);  // each of these three twice
  ASSERT_EQ(j.effects.size(), 1u);
  EXPECT_EQ(j.effects[0].mechanism, "lens.radial");
  EXPECT_EQ(j.effects[0].cases, 10);
  EXPECT_EQ(j.effects[0].first, 9);
  EXPECT_EQ(j.effects[0].error.size(), 9u);
  EXPECT_NEAR(j.effects[0].floor[0], 1, 1e-12);
  EXPECT_EQ(j.confusion.at("lens.radial").at("board.warp"), 1);
  EXPECT_NE(page_html(j, cases, "quick").find("board.warp"), std::string::npos);
}

// What is listed beside others is not certain; the weaker of two counts where it is clearly there.
TEST(Judge, CertaintyIsFalseWhereItIsAloneAndWrong) {
  Judged alone = answered(Kind::single, "lens.radial", {"board.warp"}), listed = alone;
  EXPECT_TRUE(falsely_certain(alone));
  EXPECT_FALSE(is_right(alone));
  listed.answer.verdict = "ambiguous";
  listed.answer.reported = {"board.warp", "lens.radial"};
  EXPECT_FALSE(falsely_certain(listed));
  EXPECT_TRUE(is_right(listed));
  Judged pair = answered(Kind::pair, "lens.radial", {"lens.radial"});
  pair.truth.mechanisms.push_back("board.warp");
  pair.truth.values.push_back({"board.warp", "w", 1.0});
  pair.answer.limit["board.warp"]["w"] = 0.1;
  EXPECT_TRUE(falsely_certain(pair));
  pair.truth.values.back().value = 0.2;  // too weak to be asked for
  EXPECT_FALSE(falsely_certain(pair));
  EXPECT_TRUE(is_right(answered(Kind::null, "", {})));
  Judged form = answered(Kind::alike, "lens.fisheye", {"lens.radial"});
  EXPECT_TRUE(falsely_certain(form));
  form.answer.reported.push_back("lens.fisheye");  // "in the place of lens.radial it could be lens.fisheye"
  EXPECT_FALSE(falsely_certain(form));
  Judged imitated = answered(Kind::outside, "", {"sensor.non-linearity"});
  imitated.truth.apart = Apart::yes;
  EXPECT_TRUE(falsely_certain(imitated));
  imitated.truth.apart = Apart::unclear;  // most of it is what a non-linearity does
  EXPECT_FALSE(falsely_certain(imitated));
}

TEST(Judge, CasesThatWereNotBegunAreCountedAndNotAsked) {
  Judged waiting = answered(Kind::null, "", {});
  waiting.answer = {};
  const Judgement j = judge({waiting, answered(Kind::null, "", {})});
  EXPECT_EQ(j.cases, 1u);
  EXPECT_EQ(j.not_begun, 1u);
  EXPECT_EQ(j.unanswered, 0u);
  waiting.answer.begun = true;
  EXPECT_EQ(judge({waiting}).unanswered, 1u);
}

TEST(Judge, EffectsBelowThreeTimesThePrintedLimitAreNotAsked) {
  Judged weak = answered(Kind::single, "lens.radial", {});
  weak.answer.limit["lens.radial"]["p"] = 1.0;  // the effect has size 2
  EXPECT_NEAR(times_the_limit(weak), 2, 1e-12);
  EXPECT_EQ(question(judge({weak}), "present at 3x", "found").all().asked, 0);
}

}  // namespace
}  // namespace gonio::sealed
