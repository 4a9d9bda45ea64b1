// Cases that another renderer recorded: truths, names that count, questions, and the draw itself.
#include "sealed/wild.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <numbers>

#include "base/atomic_file.h"
#include "data.h"
#include "sealed/reliability.h"

namespace gonio::sealed {
namespace {

using std::filesystem::path;

struct WildFolder : testing::Test {
  tests::ScratchFolder scratch;
  path folder = scratch.path();
  void SetUp() override {
    write_file(folder / "right.json",
               R"({"lamp": ["light.position", "light.direction"], "tone": ["sensor.non-linearity"], "bump": []})");
  }
  Case truth(const std::string& kind, const std::string& effects) {
    write_file(folder / "007.json", R"({"seed": 7, "kind": ")" + kind + R"(", "effects": [)" + effects +
                                        R"(], "distractors": [{"name": "dust"}], "floor": 0.02,
                                        "pictures": [{"id": "p00", "width": 2, "height": 1}]})");
    return read_wild_truth(folder, "007", read_rights(folder / "right.json"));
  }
  static std::string effect(const std::string& name, double share, double length) {
    return R"({"name": ")" + name + R"(", "fair_relative_rms": )" + std::to_string(share) + R"(, "fair_length": )" +
           std::to_string(length) + R"(, "values": [{"mechanism": "sensor.non-linearity", "parameter": "gamma",
           "value": 0.9, "exact": true, "is_size": true}]})";
  }
  Judged judged(const Case& made, const std::vector<std::string>& named) {
    Judged j{made.spec, made.truth, made.id, {}};
    j.answer.ran = true;
    j.answer.verdict = named.empty() ? "null" : "named";
    j.answer.named = j.answer.reported = named;
    j.answer.set_size = named.size();
    use_first_names(made, read_rights(folder / "right.json"), j.answer);
    return j;
  }
  static const Question& asked(const Judgement& j, const std::string& measure) {
    for (const Question& q : j.questions)
      if (q.measure.starts_with(measure)) return q;
    throw std::runtime_error("no question " + measure);
  }
};

TEST_F(WildFolder, ATruthBearsTheFirstNameThatCountsAndItsChanges) {
  const float changes[6] = {1, 3, 2, 0.5F, 0, 0};
  write_file(folder / "007.effect", std::string(reinterpret_cast<const char*>(changes), sizeof changes));
  const Case made = truth("single", effect("tone", 0.05, 40));
  EXPECT_EQ(made.truth.kind, Kind::single);
  EXPECT_EQ(made.truth.mechanisms, std::vector<std::string>{"sensor.non-linearity"});
  ASSERT_EQ(made.truth.values.size(), 1u);
  EXPECT_DOUBLE_EQ(made.truth.values[0].value, 0.9);
  EXPECT_EQ(made.pixels.at("p00"), (std::vector<float>{3, 0.5F}));
  EXPECT_EQ(made.truth.world, "tone, with dust");
}

TEST_F(WildFolder, AnyNameThatCountsIsRight) {
  const Case made = truth("single", effect("lamp", 0.05, 40));
  const Judgement j = judge({judged(made, {"light.direction"})}, wild_asking());
  EXPECT_EQ(asked(j, "named first, or").all().right, 1);
  EXPECT_EQ(asked(j, "named alone").all().right, 0);
}

TEST_F(WildFolder, AnEffectThatNoNameCountsForIsOutside) {
  const Case made = truth("single", effect("bump", 0.05, 40));
  EXPECT_EQ(made.truth.kind, Kind::outside);
  const Judgement j = judge({judged(made, {"light.direction"}), judged(made, {})}, wild_asking());
  EXPECT_EQ(asked(j, "wrongly named as a known one").all().right, 1);
  EXPECT_EQ(asked(j, "wrongly named as a known one").all().asked, 2);
  EXPECT_EQ(asked(j, "named alone").all().right, 1);
}

TEST_F(WildFolder, OfAPairTheWeakerOneCounts) {
  const Case made = truth("pair", effect("tone", 0.05, 40) + ", " + effect("lamp", 0.002, 20));
  EXPECT_DOUBLE_EQ(made.truth.share, 0.002);
  const Judgement weak = judge({judged(made, {"sensor.non-linearity"})}, wild_asking());
  EXPECT_EQ(asked(weak, "both named").all().asked, 0);
  const Case strong = truth("pair", effect("tone", 0.05, 40) + ", " + effect("lamp", 0.03, 20));
  const Judgement both = judge({judged(strong, {"light.direction", "sensor.non-linearity"})}, wild_asking());
  EXPECT_EQ(asked(both, "both named").all().right, 1);
}

TEST_F(WildFolder, EffectsTooSmallToMatterAreNotAsked) {
  const Judgement j = judge({judged(truth("single", effect("tone", 0.004, 40)), {})}, wild_asking());
  EXPECT_EQ(asked(j, "found").all().asked, 0);
  EXPECT_EQ(j.cases, 1u);
}

TEST_F(WildFolder, StatedProbabilitiesAreOfTheVerdict) {
  const Case lamp = truth("single", effect("lamp", 0.05, 40)), tone = truth("single", effect("tone", 0.004, 40)),
             bump = truth("single", effect("bump", 0.05, 40));
  std::vector<Judged> cases = {judged(lamp, {"sensor.black-offset"}), judged(lamp, {}), judged(tone, {}),
                               judged(bump, {}), judged(bump, {})};
  cases[0].answer.reported.push_back("light.position");  // listed beside what was named
  cases[3].answer.verdict = "unknown";
  for (Judged& j : cases) j.answer.probability = 0.8;
  cases.push_back(judged(lamp, {"light.position"}));  // states none
  const std::vector<Stated> stated = judge(cases, wild_asking()).stated;
  ASSERT_EQ(stated.size(), 5u);
  const bool right[] = {true, false, true, true, false};
  for (std::size_t k = 0; k < stated.size(); ++k) EXPECT_EQ(stated[k].right, right[k]) << k;
}

TEST(Reliability, IsTheMeanDistanceBetweenWhatIsStatedAndWhatHappens) {
  std::vector<Stated> stated;
  for (int k = 0; k < 10; ++k) stated.push_back({0.95, k < 9});  // 0.9 right
  for (int k = 0; k < 10; ++k) stated.push_back({0.25, k < 5});  // 0.5 right
  stated.push_back({1.0, true});
  const Reliability r = reliability_of(stated);
  ASSERT_EQ(r.bins.size(), 2u);
  EXPECT_EQ(r.bins[1].asked, 11);  // certainty belongs to the uppermost bin
  EXPECT_NEAR(r.error, (11 * std::abs(10.0 / 11 - 10.5 / 11) + 10 * 0.25) / 21, 1e-12);
  EXPECT_NE(report::svg(reliability_plot(r)).find("<svg"), std::string::npos);
}

// True statements have an error by chance: sum_b n_b E|share - mean| / n, with E|.| = sqrt(2 p (1 - p) / (pi n_b)) of a
// bin of many. Here 400 at 0.75 and 400 at 0.95.
TEST(Reliability, SaysWhatChanceAloneDoes) {
  std::vector<Stated> stated;
  for (int k = 0; k < 800; ++k) stated.push_back({k % 2 == 0 ? 0.75 : 0.95, k % 2 != 0 || k % 8 != 0});
  const Reliability r = reliability_of(stated);
  const auto share = [](double p) { return std::sqrt(2 * p * (1 - p) / (std::numbers::pi * 400)); };
  EXPECT_NEAR(r.error_by_chance, (share(0.75) + share(0.95)) / 2, 0.0008);
  EXPECT_GT(r.error_by_chance_95, r.error_by_chance);
  EXPECT_LT(r.error_by_chance_95, 2.5 * r.error_by_chance);
}

TEST(WildDraw, SeedsGiveWhatTheProofPromises) {
  if (std::system("python3 --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "no python3";
  EXPECT_EQ(std::system("PYTHONDONTWRITEBYTECODE=1 python3 '" GONIO_SOURCE "/tests/wild/check.py' >/dev/null"), 0);
}

}  // namespace
}  // namespace gonio::sealed
