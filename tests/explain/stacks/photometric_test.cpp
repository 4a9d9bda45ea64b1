// Stacks of lights made by other code: gloss, rough matte surfaces, lamps that stand elsewhere, and nothing. Of the
// glossy ball two things are asked, of one answer.
// One process: Photometric.*
#include <gtest/gtest.h>

#include <cmath>

#include "data.h"
#include "explain/engine.h"
#include "explain/stacks/photometric_problem.h"
#include "explain/stacks/stack_world.h"
#include "manifest/codec.h"
#include "manifest/document.h"

namespace gonio::explain::stacks {
namespace {

using tests::LightWorld;
using Names = std::vector<std::string>;

struct Outcome {
  std::unique_ptr<Problem> problem;
  Explanation explanation;
  Names named;
  double value(const std::string& parameter) const {
    for (const Estimate& e : explanation.estimates)
      if (problem->parameters()[e.parameter].name == parameter) return e.value;
    return std::nan("");
  }
  std::string told() const {
    std::string text = explanation.sentence + "\n";
    for (const Hypothesis& h : explanation.scoreboard) {
      text += "  " + h.name + ": held out " + std::to_string(h.held_out) + ", gain " + std::to_string(h.gain) + " +- " +
              std::to_string(h.gain_sigma) + ", effect " + std::to_string(h.effect) + " " + h.refused;
      for (std::size_t k = 0; k < std::min<std::size_t>(3, h.parameters.size()); ++k)
        text +=
            " " + problem->parameters()[h.parameters[k].parameter].name + "=" + std::to_string(h.parameters[k].value);
      text += "\n";
    }
    return text;
  }
};

Outcome run(const LightWorld& world) {
  const tests::ScratchFolder folder;
  Outcome o;
  std::vector<std::unique_ptr<Problem>> problems = photometric_problems(record(world, folder.path()));
  o.problem = std::move(problems.at(0));
  o.explanation = explain(*o.problem, Options{});
  for (const std::size_t c : o.explanation.named) o.named.push_back(o.problem->candidates()[c].id());
  return o;
}

LightWorld glossy_world() {
  LightWorld world;
  world.f0 = 0.05;
  return world;
}
const Outcome& glossy() {
  static const Outcome outcome = run(glossy_world());
  return outcome;
}

TEST(Photometric, NothingIsNamedOfAMatteBall) {
  const Outcome o = run({});
  EXPECT_EQ(o.explanation.verdict, Verdict::null) << o.told();
}

// Lamps are proposed where none stood, and what they would show of a gloss is seen in some and not in the dark.
TEST(Photometric, LampsAreProposedWhereNoneStood) {
  const LightWorld world = glossy_world();
  const Outcome& o = glossy();
  const std::vector<Proposal> proposals = o.problem->proposals();
  ASSERT_GT(proposals.size(), 3u);
  const auto& problem = dynamic_cast<const PhotometricProblem&>(*o.problem);
  const std::vector<PatchLight> lamps = problem.lights(o.explanation.base_values, world.size / 2, world.size / 2);
  std::vector<double> matte = o.explanation.values;
  for (const std::size_t p : o.problem->candidates()[o.explanation.named.at(0)].parameters)
    matte[p] = o.problem->parameters()[p].neutral;
  std::size_t telling = 0;
  for (std::size_t k = 0; k < proposals.size(); ++k) {
    const ProposedRows glossy = problem.propose(o.explanation.values, k), plain = problem.propose(matte, k);
    double z = 0;
    for (std::size_t i = 0; i < glossy.prediction.size(); ++i)
      z = std::max(z, std::abs(glossy.prediction[i] - plain.prediction[i]) / glossy.sigma[i]);
    telling += z > 3;
    const manifest::Value* towards = proposals[k].setup.find("light_towards");
    if (towards == nullptr) {
      EXPECT_EQ(z, 0) << proposals[k].sentence;
      continue;
    }
    const Vec3 direction = manifest::Codec<Vec3>::read(*towards, "");
    EXPECT_NEAR(norm(direction), 1, 1e-12);
    for (const PatchLight& lamp : lamps)
      EXPECT_LT(dot(lamp.towards, direction), std::cos(0.2)) << proposals[k].sentence;
  }
  EXPECT_GT(telling, 0u);
}

TEST(Photometric, GlossIsNamedWithItsNumbers) {
  const LightWorld world = glossy_world();
  const Outcome& o = glossy();
  ASSERT_EQ(o.named, (Names{"surface.interface"})) << o.told();
  // The ball's masking is separable and takes more than the height-correlated one that explains it.
  EXPECT_NEAR(o.value("surface.interface.f0"), world.f0, 0.15 * world.f0);
  EXPECT_NEAR(o.value("surface.interface.alpha"), world.alpha, 0.15 * world.alpha);
}

TEST(Photometric, RoughMatteSurfaceIsNamed) {
  LightWorld world;
  world.sigma_rad = 0.4;
  const Outcome o = run(world);
  ASSERT_EQ(o.named, (Names{"surface.diffuse-roughness"})) << o.told();
  EXPECT_NEAR(o.value("surface.diffuse-roughness.sigma_rad"), world.sigma_rad, 0.1 * world.sigma_rad);
}

TEST(Photometric, LampsElsewhereAreNamed) {
  LightWorld world;
  world.turn_rad = 0.08;
  const Outcome o = run(world);
  EXPECT_EQ(o.named, (Names{"light.direction"})) << o.told();
}

// Lamps that nobody measured lie unevenly over the picture: no missing physics, and gloss is found beside it.
TEST(Photometric, UnevenLampsOfFreeStrengthAreNotNamed) {
  LightWorld world;
  world.uneven = 0.15;
  const Outcome o = run(world);
  EXPECT_EQ(o.explanation.verdict, Verdict::null) << o.told();
  const auto slope = [&](const std::string& lamp) {
    for (std::size_t p = 0; p < o.problem->parameters().size(); ++p)
      if (o.problem->parameters()[p].name == "lights/" + lamp + "/slope_down") return o.explanation.base_values[p];
    return std::nan("");
  };
  // What all lamps have in common belongs to the albedo.
  EXPECT_NEAR(slope("l0") - slope("l1"), -world.uneven, 0.1 * world.uneven);
}

TEST(Photometric, NearLampIsAPointSource) {
  const PatchLight far{normalized(Vec3{0.3, -0.5, -0.8}), 0.9};
  const Vec3 at{0.4, -0.7, 0};
  EXPECT_EQ(seen_from(far, at, 0).white, far.white);
  EXPECT_EQ(seen_from(far, at, 0).towards.x, far.towards.x);
  const double distance = 4;
  const Vec3 there = far.towards * distance - at;
  const PatchLight near = seen_from(far, at, 1 / distance);
  EXPECT_NEAR(norm(near.towards - normalized(there)), 0, 1e-12);
  EXPECT_NEAR(near.white, far.white * distance * distance / dot(there, there), 1e-12);
}

TEST(Photometric, BlackOffsetIsNamed) {
  LightWorld world;
  world.offset = 0.03;
  const Outcome o = run(world);
  ASSERT_EQ(o.named, (Names{"sensor.black-offset"})) << o.told();
  EXPECT_NEAR(o.value("sensor.black-offset.offset"), world.offset, 0.1 * world.offset);
}

}  // namespace
}  // namespace gonio::explain::stacks
