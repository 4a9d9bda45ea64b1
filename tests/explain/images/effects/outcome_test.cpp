// What comes with the verdict on pictures: measurements that could be taken next, noise from further takes, pictures of
// where an effect acts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "base/text.h"
#include "effect_world.h"
#include "geom/angle.h"
#include "io/picture.h"
#include "manifest/codec.h"
#include "manifest/document.h"
#include "manifest/explanation_tables.h"

namespace gonio::tests {
namespace {

using explain::images::ImagesProblem;

std::vector<double> neutral_values(const ImagesProblem& problem) {
  std::vector<double> values;
  for (const explain::Parameter& p : problem.parameters()) values.push_back(p.neutral);
  return values;
}

// Four times the exposure multiplies the light and leaves an offset; lamps off leave the offset alone.
TEST(Proposals, FollowTheExposureAndTheLamps) {
  EffectWorld world;
  world.views = 2;
  world.spp = 16;
  const ScratchFolder folder;
  const ImagesProblem problem(world.record(folder), {.pixels = 1200});
  const std::vector<explain::Proposal> proposals = problem.proposals();
  ASSERT_EQ(proposals.size(), 13u);  // three pictures, and two lamps either way
  std::vector<double> values = neutral_values(problem);
  constexpr double offset = 0.01;
  for (const explain::Candidate& c : problem.candidates())
    if (c.id() == "sensor.black-offset")
      for (const std::size_t p : c.parameters) values[p] = offset;
  std::vector<double> now(problem.observations().first[1]);
  problem.predict(values, 0, now);
  const explain::ProposedRows more = problem.propose(values, 0), less = problem.propose(values, 1),
                              dark = problem.propose(values, 2);
  ASSERT_EQ(more.prediction.size(), now.size());
  ASSERT_EQ(dark.sigma.size(), now.size());
  for (std::size_t i = 0; i < now.size(); ++i) {
    EXPECT_NEAR(more.prediction[i], 4 * (now[i] - offset) + offset, 1e-12);
    EXPECT_NEAR(less.prediction[i], 0.25 * (now[i] - offset) + offset, 1e-12);
    EXPECT_NEAR(dark.prediction[i], offset, 1e-12);
    EXPECT_NEAR(dark.sigma[i], world.noise, 0.01 * world.noise);
  }
  EXPECT_EQ(proposals[2].setup.find("light")->as_array().size(), 0u) << proposals[2].sentence;
  for (const explain::Proposal& each : proposals)  // a document that holds them can be read again
    EXPECT_NO_THROW(manifest::Codec<manifest::PlannedMeasurement>::read(
        manifest::Value::object({{"sentence", each.sentence}, {"setup", each.setup}}), "plan"))
        << each.sentence;
}

// A lamp that is turned about the scene shows what a scene with the lamp there shows: within the shadows' table.
TEST(Proposals, TurnTheLamp) {
  EffectWorld world;
  world.views = 2;
  world.spp = 16;
  const ScratchFolder here, there;
  const ImagesProblem problem(world.record(here), {.pixels = 1200});
  const explain::Proposal turned = problem.proposals()[9];
  EXPECT_EQ(turned.sentence, "image 00 again with lamp-0 12 degrees further right");
  const auto place = manifest::Codec<Vec3>::read(*turned.setup.find("light_position_m"), "setup");
  world.lights = {format(R"({"model":"point","position_m":[%.17g,%.17g,%.17g],"watt_per_sr":[0.6,0.6,0.6]})", place.x,
                         place.y, place.z),
                  R"({"model":"point","position_m":[-0.35,-0.1,0.45],"watt_per_sr":[0.6,0.6,0.6]})"};
  const ImagesProblem moved(world.record(there), {.pixels = 1200});
  const explain::ProposedRows rows = problem.propose(neutral_values(problem), 9);
  std::vector<double> direct(moved.observations().first[1]), today(direct.size());
  ASSERT_EQ(rows.prediction.size(), direct.size());
  moved.predict(neutral_values(moved), 0, direct);
  problem.predict(neutral_values(problem), 0, today);
  double error = 0, change = 0;
  for (std::size_t i = 0; i < direct.size(); ++i) {
    error += std::pow(rows.prediction[i] - direct[i], 2);
    change += std::pow(today[i] - direct[i], 2);
  }
  EXPECT_LT(std::sqrt(error / change), 0.1);
  const report::FloorPlan& plan = *turned.floor_plan;
  EXPECT_LT(plan.from.right_m, plan.to.right_m);
  const auto apart = [](const auto& a, const auto& b) {
    return std::hypot(a.right_m - b.right_m, a.away_m - b.away_m);
  };
  EXPECT_NEAR(apart(plan.from, plan.to), 2 * std::sin(6 * degree) * apart(plan.from, plan.centre), 1e-9);
}

// The manifest states half of the noise that is there; a further take of all pictures tells.
TEST(Repeats, TellTheNoise) {
  EffectWorld world;
  world.views = 2;
  world.spp = 16;
  world.noise = 0.004;
  const ScratchFolder first, second;
  world.record(first);
  EffectWorld again = world, claimed = world;
  again.noise_seed = 8;
  again.record(second);
  claimed.noise = 0.002;
  std::ofstream(second / "take.json") << again.manifest("");
  const manifest::Document document = manifest::parse_document(claimed.manifest(""), "believed", first.path());
  const ImagesProblem alone(document, {.pixels = 600}),
      both(document, {.pixels = 600, .repeats = {second / "take.json"}});
  for (std::size_t i = 0; i < both.recordings().images.size(); ++i) {
    const double level = both.recordings().images[i].mean.y;
    EXPECT_NEAR(noise_sigma(alone.recordings().images[i], level), 0.002, 1e-4);
    EXPECT_NEAR(noise_sigma(both.recordings().images[i], level), 0.004, 0.0004);  // 6900 pairs: 1.2 % in one bin's
  }
}

// The mask holds what the named physics changes, over the noise, at pixels that the fit has seen as at others: here the
// change of the fitted model's own prediction, e / (e + 3).
void expect_mask(const EffectOutcome& outcome, std::size_t g, const io::Image& mask) {
  const ImagesProblem& problem = outcome.problem;
  const explain::Observations& o = problem.observations();
  std::vector<double> before(o.first[g + 1] - o.first[g]), after(before.size());
  problem.predict(outcome.explanation.base_values, g, before);
  problem.predict(outcome.explanation.values, g, after);
  double off = 0, n = 0, lowest = 1, highest = 0;
  for (std::size_t i = 0; i + 2 < before.size(); i += 3) {
    const auto& pixel = problem.model().cache(problem.recordings().images[g].view).pixels[problem.picked(g)[i / 3]];
    if (pixel.facets != 1) continue;
    double e = 0;
    for (std::size_t c = i; c < i + 3; ++c) e += std::abs(after[c] - before[c]) / o.sigma[o.first[g] + c] / 3;
    off += std::abs(mask.at(pixel.x, pixel.y, 0) - e / (e + 3)), n += 1;
    lowest = std::min(lowest, e / (e + 3)), highest = std::max(highest, e / (e + 3));
  }
  EXPECT_LT(off / n, 0.1);  // whole pictures are simulated coarser, and their own variance joins the noise
  EXPECT_GT(highest - lowest, 0.5);
}

// Boxes are drawn on the photographs, and on nothing else.
TEST(Pictures, ShowWhereTheEffectActs) {
  EffectWorld world;
  world.views = 2;
  world.spp = 64;
  world.truth = R"("optics.vignetting":{"falloff":0.35})";
  const EffectOutcome outcome(world, {"optics.vignetting", "light.ambient"});
  ASSERT_EQ(outcome.named(), std::vector<std::string>{"optics.vignetting"}) << outcome.explanation.sentence;
  const ScratchFolder out;
  manifest::Document document = manifest::parse_document(world.manifest(""), "believed", outcome.folder.path());
  const explain::Illustration shown = outcome.problem.illustrate(outcome.explanation, out.path(), document);
  ASSERT_EQ(shown.masks.size(), outcome.problem.recordings().images.size());
  const auto& images = outcome.problem.recordings().images;
  for (std::size_t g = 0; g < images.size(); ++g) {
    const explain::images::Recording& image = images[g];
    const io::Image mask = io::read_picture(out / ("effect-" + image.id + ".exr"));
    ASSERT_EQ(mask.width, world.size_px);
    ASSERT_EQ(mask.channels, std::vector<std::string>{"Y"});
    expect_mask(outcome, g, mask);
    for (const float v : mask.data) ASSERT_TRUE(v >= 0 && v <= 1);
  }
  ASSERT_FALSE(shown.boxes.empty());
  ASSERT_FALSE(shown.pictures.empty());
  const auto yellow_in = [&](const std::string& png) {
    std::ofstream(out / "shown.png", std::ios::binary) << png;
    const io::Image drawn = io::read_picture(out / "shown.png");
    std::size_t yellow = 0;
    for (std::size_t i = 0; i + 2 < drawn.data.size(); i += 3)
      yellow += drawn.data[i] > 0.99f && drawn.data[i + 1] > 0.99f && drawn.data[i + 2] < 0.01f;
    return yellow;
  };
  // The worst photograph comes first, then what was simulated and what differs, each without and with the answer.
  ASSERT_GE(shown.pictures.size(), 3u);
  EXPECT_EQ(shown.seen_at_once, 3u);
  EXPECT_EQ(shown.pictures[0].title, outcome.explanation.groups[0].name);
  EXPECT_TRUE(shown.pictures[0].over_png.empty());
  std::size_t outlined = 0, others = 0, pairs = 0;
  for (const explain::Picture& picture : shown.pictures) {
    const bool photograph = std::ranges::count(images, picture.title, &explain::images::Recording::id) > 0;
    (photograph ? outlined : others) += yellow_in(picture.png);
    if (picture.over_png.empty()) continue;
    ++pairs;
    EXPECT_NE(picture.png, picture.over_png);
    others += yellow_in(picture.over_png);
  }
  EXPECT_GT(outlined, 100u);
  EXPECT_EQ(others, 0u);
  EXPECT_GE(pairs, 2u);
}

}  // namespace
}  // namespace gonio::tests
