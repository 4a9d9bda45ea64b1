// Stacks of exposures made by other code: what was left out is named with its numbers, nothing where nothing was, and
// the upgraded manifest has nothing left to explain. Null tests run at the level 0.01: of five stacks one is
// called a mismatch with a chance of 5 % even by a perfect tool; with the seeds fixed here there is none.
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "data.h"
#include "explain/engine.h"
#include "explain/stacks/exposure_outcome.h"
#include "explain/stacks/exposures_problem.h"
#include "explain/stacks/stack_world.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mechanism_use.h"

namespace gonio::explain::stacks {
namespace {

// The sentence and what else ran: for whoever looks at a failure.
std::string told(const Outcome& o) {
  std::string text = o.explanation.sentence + " noise factor " + std::to_string(o.explanation.noise_factor) + "\n";
  for (const Hypothesis& h : o.explanation.scoreboard) {
    text += "  " + h.name + ": held out " + std::to_string(h.held_out) + ", gain " + std::to_string(h.gain) + " +- " +
            std::to_string(h.gain_sigma) + ", effect " + std::to_string(h.effect) + " " + h.refused;
    for (const Estimate& e : h.parameters)
      text += " " + o.problem->parameters()[e.parameter].name + "=" + std::to_string(e.value);
    text += "\n";
  }
  return text;
}

using Names = std::vector<std::string>;

TEST(Exposures, ToneCurveIsNamedAndItsInverseLeavesNothing) {
  const tests::ScratchFolder folder;
  ExposureWorld world;
  world.response = film;
  world.bits = 8;
  const Outcome first = run(record(world, folder.path()));
  ASSERT_EQ(first.named, (Names{"sensor.non-linearity"})) << told(first);
  EXPECT_NE(first.explanation.sentence.find("tone curve"), std::string::npos) << told(first);
  EXPECT_LT(first.explanation.held_out_after, 0.2 * first.explanation.held_out_before);
  const auto& problem = dynamic_cast<const ExposuresProblem&>(*first.problem);
  const render::Response response = problem.chain(first.explanation.values).response[0];
  const double middle = film(0.1);  // light is known up to a factor
  for (const double light : {0.02, 0.05, 0.1, 0.2, 0.4, 0.7})
    EXPECT_NEAR(response.light(film(light)) / response.light(middle) / (light / 0.1), 1, 0.04) << light;

  manifest::Document upgraded = first.document;
  first.problem->apply(first.explanation, upgraded);
  const Outcome second = run(upgraded);
  EXPECT_EQ(second.explanation.verdict, Verdict::null) << told(second);
  EXPECT_NEAR(second.explanation.held_out_before, first.explanation.held_out_after,
              0.05 * first.explanation.held_out_after);
}

// Without a stated noise the table is a part of the model, and readings are codes, as they were the first time.
TEST(Exposures, ACurveIsCarriedWhereNoNoiseIsStated) {
  const tests::ScratchFolder folder;
  ExposureWorld world;
  world.response = film;
  world.bits = 8;
  manifest::Document document = record(world, folder.path());
  for (manifest::ImageEntry& image : document.images) image.noise.reset();
  const Outcome first = run(document);
  ASSERT_EQ(first.named, (Names{"sensor.non-linearity"})) << told(first);
  manifest::Document upgraded = first.document;
  first.problem->apply(first.explanation, upgraded);
  const Outcome second = run(upgraded);
  ASSERT_FALSE(dynamic_cast<const ExposuresProblem&>(*second.problem).stack().stated.empty());
  EXPECT_TRUE(second.named.empty()) << told(second);
  EXPECT_NEAR(second.explanation.held_out_before, first.explanation.held_out_after,
              0.05 * first.explanation.held_out_after);
}

// A table that is flat somewhere has no way back to codes: it is undone where the pictures are read, as ever.
TEST(Exposures, ATableWithoutAnInverseIsUndone) {
  const tests::ScratchFolder folder;
  ExposureWorld world;
  world.bits = 8;
  manifest::Document document = record(world, folder.path());
  for (manifest::ImageEntry& image : document.images)
    image.noise.reset(), image.response = manifest::parse_json("[[0, 0], [0.004, 0], [1, 1]]", "response");
  const Stack flat = read_stack(document, stacks_of(document, Kind::exposures).at(0), Kind::exposures);
  EXPECT_TRUE(flat.stated.empty());
  for (manifest::ImageEntry& image : document.images)
    image.response = manifest::parse_json("[[0, 0], [0.5, 0.2], [1, 1]]", "response");
  const Stack rising = read_stack(document, stacks_of(document, Kind::exposures).at(0), Kind::exposures);
  ASSERT_EQ(rising.stated.size(), rising.channels.size());
  EXPECT_NEAR(rising.linear(0, 0.25), 0.1, 1e-12);
  EXPECT_NEAR(rising.reading(0, 0.1), 0.25, 1e-12);
}

TEST(Exposures, ColourChannelsHaveCurvesOfTheirOwnWhereTheyDiffer) {
  ExposureWorld world;
  world.channels = 3;
  world.response = film;
  world.bits = 8;
  const Outcome same = run(world);
  ASSERT_EQ(same.named, (Names{"sensor.non-linearity"})) << told(same);
}

TEST(Exposures, PowerLawIsFoundWithItsExponent) {
  ExposureWorld world;
  world.response = [](double v) { return std::pow(v, 0.8); };
  world.bits = 16;
  const Outcome r = run(world);
  ASSERT_EQ(r.named, (Names{"sensor.non-linearity"})) << told(r);
  const auto& problem = dynamic_cast<const ExposuresProblem&>(*r.problem);
  const render::Response response = problem.chain(r.explanation.values).response[0];
  EXPECT_NEAR(std::log(response.light(0.6) / response.light(0.1)) / std::log(6.0), 1 / 0.8, 0.02);
}

TEST(Exposures, OffsetIsFoundAndItsIntervalsCover) {
  int covered = 0, found = 0;
  constexpr int runs = 4;
  for (int k = 0; k < runs; ++k) {
    ExposureWorld world;
    world.offset = 0.012;
    world.bits = 16;
    world.seed = 40 + k;
    const Outcome r = run(world, 0.003);
    if (r.named != Names{"sensor.black-offset"}) {
      ADD_FAILURE() << told(r);
      continue;
    }
    ++found;
    const Estimate& e = r.explanation.estimates.at(0);
    EXPECT_NEAR(e.value, world.offset, 0.1 * world.offset);
    covered += e.lower_95 <= world.offset && world.offset <= e.upper_95;
  }
  EXPECT_EQ(found, runs);
  EXPECT_GE(covered, 2);  // of 4 at 95 %: one or none with probability 0.0005
}

// Three apertures, each at three times, of a lens whose rim shades the widest most.
ExposureWorld through_apertures() {
  ExposureWorld world;
  world.exposures_s = {0.002, 0.006, 0.018, 0.004, 0.012, 0.036, 0.016, 0.048, 0.144};
  world.f_numbers = {2, 2, 2, 2.8, 2.8, 2.8, 5.6, 5.6, 5.6};
  world.stopped_down = 0.94;
  world.bits = 16;
  return world;
}

TEST(Exposures, ShadingThatGoesWithTheApertureIsFoundAndCarried) {
  const tests::ScratchFolder folder;
  ExposureWorld world = through_apertures();
  world.rim = 2.2, world.rim_shift = 0.5;
  const Outcome first = run(record(world, folder.path()));
  ASSERT_EQ(first.named, (Names{"optics.lens-shading"})) << told(first);
  ASSERT_EQ(first.explanation.estimates.size(), 2u);
  for (const Estimate& e : first.explanation.estimates) {
    const bool shift = first.problem->parameters()[e.parameter].name.ends_with("shift");
    EXPECT_NEAR(e.value, shift ? world.rim_shift : world.rim, shift ? 0.05 : 0.15) << told(first);
  }
  manifest::Document upgraded = first.document;
  first.problem->apply(first.explanation, upgraded);
  const Outcome second = run(upgraded);
  EXPECT_EQ(second.explanation.verdict, Verdict::null) << told(second);
}

TEST(Exposures, ApertureThatShadesNothingAndPassesLessThanItSaysIsNoMismatch) {
  const Outcome none = run(through_apertures());
  EXPECT_EQ(none.explanation.verdict, Verdict::null) << told(none);
}

// Intervals over other seeds, rims and shifts: of 10 at 95 % fewer than 8 with probability 0.012.
TEST(Exposures, IntervalsOfTheRimCover) {
  int covered = 0, asked = 0;
  for (int k = 0; k < 15; k += 3) {
    ExposureWorld world = through_apertures();
    world.seed = 300 + k;
    world.rim = 2 + 0.04 * k, world.rim_shift = 0.35 + 0.02 * ((k * 7) % 15);
    const Outcome r = run(world);
    if (r.named != Names{"optics.lens-shading"}) {
      ADD_FAILURE() << told(r);
      continue;
    }
    for (const Estimate& e : r.explanation.estimates) {
      const bool shift = r.problem->parameters()[e.parameter].name.ends_with("shift");
      const double truth = shift ? world.rim_shift : world.rim;
      covered += e.lower_95 <= truth && truth <= e.upper_95, ++asked;
    }
  }
  EXPECT_EQ(asked, 10);
  EXPECT_GE(covered, 8);
}

TEST(Exposures, AnApertureOfSomePicturesAloneIsRefused) {
  const tests::ScratchFolder folder;
  manifest::Document document = record(through_apertures(), folder.path());
  document.images[4].f_number.reset();
  try {
    run(document);
    FAIL() << "taken";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("/images/4"), std::string::npos) << e.what();
  }
}

// Red and blue beside clipped green read too much: named beside nothing else, carried, and found no second time.
TEST(Exposures, BloomingIsFoundBesideClippedGreen) {
  const tests::ScratchFolder folder;
  ExposureWorld world;
  world.width = 144, world.height = 120;
  world.red = 0.2, world.blue = 0.15, world.along = 0.012, world.across = 0.006;
  world.bits = 16;
  const Outcome r = run(record(world, folder.path()));
  ASSERT_EQ(r.named, Names{"sensor.blooming"}) << told(r);
  EXPECT_NEAR(r.value("sensor.blooming.along"), 0.012, 0.0004);
  EXPECT_NEAR(r.value("sensor.blooming.across"), 0.006, 0.0004);
  EXPECT_NE(r.explanation.sentence.find("What flows over from clipped pixels"), std::string::npos) << told(r);
  manifest::Document upgraded = r.document;
  r.problem->apply(r.explanation, upgraded);
  const manifest::MechanismUse& use = upgraded.mechanisms.at("sensor.blooming");
  EXPECT_NEAR(use.parameters.at("full_scale").scalar(), 1, 1e-9);
  EXPECT_EQ(run(upgraded).explanation.verdict, Verdict::null);
}

TEST(Exposures, SaturationIsFoundWhereReadingsStopBelowFullScale) {
  ExposureWorld world;
  world.full_scale = 0.6;
  const Outcome r = run(world);
  ASSERT_EQ(r.named, (Names{"sensor.saturation"})) << told(r);
  EXPECT_NEAR(r.value("sensor.saturation.full_scale"), 0.6, 0.006);
}

TEST(Exposures, ShutterIsFound) {
  if (mechanism::find_mechanism("sensor.shutter") == nullptr) GTEST_SKIP() << "sensor.shutter is not declared";
  ExposureWorld world;
  world.extra_s = 0.0008;
  world.bits = 16;
  const Outcome r = run(world, 0.003);
  ASSERT_EQ(r.named, (Names{"sensor.shutter"})) << told(r);
  EXPECT_NEAR(r.value("sensor.shutter.extra_s"), world.extra_s, 0.1 * world.extra_s);
}

// One picture of seven whose shutter was open longer or shorter than was written down, now this one and now that.
TEST(Exposures, OneWrongShutterTimeIsFoundAndItsIntervalsCover) {
  constexpr int runs = 6;
  int covered = 0;
  for (int k = 0; k < runs; ++k) {
    const std::size_t odd = static_cast<std::size_t>(k + 1) % 7;
    ExposureWorld world;
    world.exposures_s.push_back(0.256);
    world.longer.assign(7, 0);
    world.longer[odd] = k % 2 == 0 ? 0.05 : -0.08;
    world.seed = 60 + k;
    world.electrons = 1e7;
    world.read = 1e-5;
    const Outcome r = run(world, 0.001);  // a short exposure is a small part of all light
    ASSERT_EQ(r.named, (Names{"sensor.exposure"})) << k << ": " << told(r);
    ASSERT_EQ(r.explanation.estimates.size(), 1u) << told(r);
    const Estimate& e = r.explanation.estimates[0];
    EXPECT_EQ(r.problem->parameters()[e.parameter].name, "e" + std::to_string(odd) + "/relative");
    EXPECT_NEAR(e.value, world.longer[odd], 0.01);
    covered += e.lower_95 <= world.longer[odd] && world.longer[odd] <= e.upper_95;
  }
  EXPECT_GE(covered, 4);  // of 6 at 95 %: three or fewer with probability 0.002
}

TEST(Exposures, AWrongShutterTimeIsCarried) {
  const tests::ScratchFolder folder;
  ExposureWorld world;
  world.exposures_s.push_back(0.256);
  world.longer = {0, 0, 0.06, 0, 0, 0, 0};
  Outcome first = run(record(world, folder.path()), 0.003);
  ASSERT_EQ(first.named, (Names{"sensor.exposure"})) << told(first);
  first.problem->apply(first.explanation, first.document);
  const Outcome again = run(first.document, 0.003);
  EXPECT_EQ(again.explanation.verdict, Verdict::null) << told(again);
}

TEST(Exposures, NothingIsNamedOfALinearSensor) {
  for (int k = 0; k < 5; ++k) {
    ExposureWorld world;
    world.seed = 100 + k;
    world.channels = k % 4 == 0 ? 3 : 1;
    world.bits = k % 2 == 0 ? 8 : 0;
    const Outcome r = run(world);
    EXPECT_EQ(r.explanation.verdict, Verdict::null) << k << ": " << told(r);
  }
}

// A veil in proportion to the picture's mean is one with the radiances: said before anything is judged.
TEST(Exposures, VeilingGlareCannotBeSeen) {
  const Outcome r = run(ExposureWorld{});
  for (const Isolability& i : r.explanation.isolability)
    if (r.problem->candidates()[i.candidate].id() == "optics.veiling-glare") {
      EXPECT_FALSE(i.visible) << i.surviving_share;
    }
}

// What is proposed is what a camera would record: the world's own picture at that exposure, which the stack lacks.
TEST(Exposures, AProposedPictureIsWhatWouldBeRecorded) {
  const tests::ScratchFolder folder;
  ExposureWorld world;
  world.exposures_s.push_back(2 * world.exposures_s.back());
  const manifest::Document whole = record(world, folder.path());
  manifest::Document six = whole;
  six.images.pop_back();
  const Outcome r = run(six);
  const auto& problem = dynamic_cast<const ExposuresProblem&>(*r.problem);
  const std::vector<Proposal> proposals = problem.proposals();
  ASSERT_EQ(proposals.size(), 3u);  // no gap is wide
  EXPECT_NE(proposals[0].sentence.find("again at 0.256 s"), std::string::npos) << proposals[0].sentence;
  EXPECT_DOUBLE_EQ(proposals[0].setup.find("exposure_s")->as_number(), world.exposures_s.back());
  const std::vector<std::vector<std::size_t>> stacks = stacks_of(whole, Kind::exposures);
  const Stack recorded = read_stack(whole, stacks.at(0), Kind::exposures);
  const ProposedRows rows = problem.propose(r.explanation.values, 0);
  double squares = 0, n = 0;
  for (std::size_t s = 0; s < problem.sites().size(); ++s) {
    if (rows.sigma[s] > 1) continue;  // clipped
    const Site& site = problem.sites()[s];
    const double z =
        (recorded.images.back().picture.at(site.x, site.y, site.channel) - rows.prediction[s]) / rows.sigma[s];
    squares += z * z, n += 1;
  }
  ASSERT_GT(n, 40);
  EXPECT_GT(std::sqrt(squares / n), 0.5);
  EXPECT_LT(std::sqrt(squares / n), 1.5);
  const ProposedRows dark = problem.propose(r.explanation.values, 2);
  for (const double v : dark.prediction) EXPECT_NEAR(v, 0, 1e-9);
}

TEST(Exposures, EveryDeclaredConditionOfACandidateIsThere) {
  ExposureWorld world;
  world.times_s = {0, 10, 20, 30, 40, 50};
  const Outcome r = run(world);
  const std::vector<Condition>& conditions = r.problem->observations().conditions;
  for (const Candidate& c : r.problem->candidates())
    for (const std::string& name : c.mechanism->conditions)
      EXPECT_TRUE(std::any_of(conditions.begin(), conditions.end(), [&](const Condition& x) { return x.name == name; }))
          << c.id() << " is seen in " << name;
}

// A recorded stack whose longest exposure is clipped throughout: it takes no part, which is said, and the others are
// explained. The file's resampling averaged readings that were clipped, so that they end below full scale.
TEST(Exposures, APictureOfWhichNothingCountsTakesNoPart) {
  GONIO_NEEDS_DATA("cases/crash-exposures.json");
  const Outcome r = run(manifest::read_document(gonio::tests::data("cases/crash-exposures.json")));
  EXPECT_NE(r.explanation.sentence.find("Exposure 3916 takes no part"), std::string::npos) << r.explanation.sentence;
  EXPECT_EQ(r.explanation.groups.size(), 6u);
  for (const std::string& id : r.named) EXPECT_EQ(id, "sensor.saturation");
}

}  // namespace
}  // namespace gonio::explain::stacks
