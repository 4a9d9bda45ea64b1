// explain on mosaic photographs: what is left out of render's own camera and scene is found in them.
// One process: Mosaics.*
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "explain/polarization/known_light.h"
#include "explain/polarization/polarization_problem.h"
#include "explain/polarization/polarization_term.h"
#include "inference/explanation.h"
#include "inference/fit.h"
#include "inference/system.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/surface.h"
#include "mosaic_scene.h"

namespace gonio::explain::tests {
namespace {

using gonio::tests::ScratchFolder;
using testing::HasSubstr;

// What the stated scene sends is the same in all tests, and traced once.
std::unique_ptr<Problem> problem_of(const std::string& stated, const std::filesystem::path& folder) {
  static polarization::KnownLight known;
  return std::move(polarization_problems(manifest::parse_document(stated, "scene.json", folder), {}, known).at(0));
}

// The candidate's fit where the scene `made` was photographed and the plain one is stated.
struct Fitted {
  std::vector<double> values, sigma;  // of its parameters
};
Fitted fitted(const std::string& made, const std::string& id, std::size_t which = 0) {
  ScratchFolder folder;
  photograph_mosaics(made, folder.path(), 5);
  const auto problem = problem_of(mosaic_scene(), folder.path());
  std::vector<double> values;
  for (const Parameter& p : problem->parameters()) values.push_back(p.neutral);
  std::vector<std::size_t> active = problem->base(), own;
  for (const Candidate& c : problem->candidates())
    if (c.id() == id && which-- == 0) {
      own = c.parameters;
      break;
    }
  EXPECT_FALSE(own.empty()) << id;
  for (const std::size_t p : own) values[p] = problem->parameters()[p].start;
  active.insert(active.end(), own.begin(), own.end());
  const inference::System system(*problem, 1);
  const auto fit = inference::fit(system, values, active);
  Fitted result;
  for (const std::size_t p : own) result.values.push_back(fit.values[p]);
  return result;
}

std::string with(const std::string& mechanism) {
  return mosaic_scene(R"(, "mechanisms": {)" + mechanism + "}");
}

TEST(Mosaics, FindTheLeakThatMadeThem) {
  EXPECT_NEAR(fitted(with(R"("polarizer.leak": {"leak": 0.05})"), "polarizer.leak").values.at(0), 0.05, 0.004);
}
TEST(Mosaics, FindTheTurnThatMadeThem) {
  EXPECT_NEAR(fitted(with(R"("polarizer.angle": {"turn_rad": -0.05})"), "polarizer.angle").values.at(0), -0.05, 0.003);
}
TEST(Mosaics, FindTheTurnsOfEachThatMadeThem) {
  const auto found =
      fitted(with(R"("polarizer.angle": {"turn_rad": 0.02, "turn_45_rad": 0.03, "turn_135_rad": -0.02})"),
             "polarizer.angle", 1)
          .values;
  ASSERT_EQ(found.size(), 4U);
  EXPECT_NEAR(found[0], 0.02, 0.01);
  EXPECT_NEAR(found[1], 0.03, 0.01);
  EXPECT_NEAR(found[2], 0, 0.01);
  EXPECT_NEAR(found[3], -0.02, 0.01);
}
TEST(Mosaics, FindTheCrosstalkThatMadeThem) {
  EXPECT_NEAR(fitted(with(R"("sensor.crosstalk": {"share": 0.02})"), "sensor.crosstalk").values.at(0), 0.02, 0.002);
}
TEST(Mosaics, FindTheLensThatMadeThem) {
  EXPECT_NEAR(fitted(with(R"("lens.birefringence": {"retardance_rad": 0.8})"), "lens.birefringence").values.at(0), 0.8,
              0.06);
  EXPECT_NEAR(fitted(with(R"("lens.birefringence": {"retardance_rad": -0.8})"), "lens.birefringence", 1).values.at(0),
              -0.8, 0.06);
}
// What is seen is nearly of one brightness: 0.015 is its standard deviation.
TEST(Mosaics, FindTheVeilThatMadeThem) {
  EXPECT_NEAR(fitted(with(R"("optics.veiling-glare": {"share": 0.1})"), "optics.veiling-glare").values.at(0), 0.1,
              0.045);
}
TEST(Mosaics, FindTheScreenThatMadeThem) {
  const double leak = 0.1;
  EXPECT_NEAR(fitted(mosaic_scene("", 0.98 * (1 - leak) / (1 + leak)), "screen.leak").values.at(0), leak, 0.006);
  EXPECT_NEAR(fitted(mosaic_scene("", 0.98, 0.68), "screen.angle").values.at(0), 0.08, 0.004);
}
// Of the metal; the first in question is the glass.
TEST(Mosaics, FindTheRoughnessThatMadeThem) {
  EXPECT_NEAR(fitted(mosaic_scene("", 0.98, 0.6, 0.12), "surface.roughness", 1).values.at(0), 0.12, 0.015);
}

std::vector<double> predicted(const Problem& problem, const std::vector<double>& values) {
  std::vector<double> all(problem.observations().rows());
  for (std::size_t g = 0; g < problem.observations().groups(); ++g) {
    const auto first = problem.observations().first[g], end = problem.observations().first[g + 1];
    problem.predict(values, g, std::span(all).subspan(first, end - first));
  }
  return all;
}

// A veil that the manifest states is in the simulation, and is not asked for again.
TEST(Mosaics, AVeilThatIsStatedLacksNothing) {
  ScratchFolder folder;
  const std::string veiled = with(R"("optics.veiling-glare": {"share": 0.1})");
  photograph_mosaics(veiled, folder.path(), 5);
  const auto rms = [&](const std::string& stated) {  // of residuals in their own sigmas, exposures as they come
    const auto problem = problem_of(stated, folder.path());
    std::vector<double> neutral;
    for (const Parameter& p : problem->parameters()) neutral.push_back(p.neutral);
    const std::vector<double> all = predicted(*problem, neutral);
    double sum = 0;
    for (std::size_t i = 0; i < all.size(); ++i)
      sum += std::pow((problem->observations().value[i] - all[i]) / problem->observations().sigma[i], 2);
    const bool asked =
        std::ranges::any_of(problem->candidates(), [](const Candidate& c) { return c.id() == "optics.veiling-glare"; });
    EXPECT_EQ(asked, stated != veiled);
    return std::sqrt(sum / static_cast<double>(all.size()));
  };
  const double with_it = rms(veiled), without = rms(mosaic_scene());
  EXPECT_LT(with_it, 1.1);
  EXPECT_GT(without, 1.08 * with_it);
}

// One term after the other changes predictions from where its search begins, and nothing where it is neutral.
TEST(Mosaics, TermsAreAbsentAtNeutralAndSeenWhereTheirSearchBegins) {
  ScratchFolder folder;
  photograph_mosaics(mosaic_scene(), folder.path(), 3);
  const auto problem = problem_of(mosaic_scene(), folder.path());
  std::vector<double> neutral;
  for (const Parameter& p : problem->parameters()) neutral.push_back(p.neutral);
  const std::vector<double> base = predicted(*problem, neutral);
  EXPECT_GE(problem->candidates().size(), 9U);
  for (const Candidate& c : problem->candidates()) {
    std::vector<double> values = neutral;
    for (const std::size_t p : c.parameters) values[p] = problem->parameters()[p].start;
    const std::vector<double> other = predicted(*problem, values);
    double change = 0, size = 0;
    for (std::size_t i = 0; i < base.size(); ++i) change += std::pow(other[i] - base[i], 2), size += base[i] * base[i];
    EXPECT_GT(std::sqrt(change / size), 1e-4) << c.id();  // little glass is seen
  }
}

TEST(Mosaics, NothingIsNamedWhereNothingIsLeftOut) {
  ScratchFolder folder;
  photograph_mosaics(mosaic_scene(), folder.path(), 11);
  const auto problem = problem_of(mosaic_scene(), folder.path());
  const Explanation e = explain(*problem, {.negative_controls = 4});
  EXPECT_TRUE(e.named.empty()) << e.sentence;
}

// Into the screen's own section, or as a mechanism of the camera.
TEST(Mosaics, AnswersAreWrittenIntoTheManifest) {
  ScratchFolder folder;
  photograph_mosaics(mosaic_scene(), folder.path(), 11);
  const auto problem = problem_of(mosaic_scene(), folder.path());
  Explanation e;
  for (const Parameter& p : problem->parameters()) e.values.push_back(p.neutral);
  e.sigma.assign(e.values.size(), 0.0);
  const auto put = [&](const std::string& id, double value) {
    const auto c = std::ranges::find_if(problem->candidates(), [&](const Candidate& one) { return one.id() == id; });
    ASSERT_NE(c, problem->candidates().end());
    e.values[c->parameters.at(0)] = value, e.sigma[c->parameters.at(0)] = 0.1 * value;
    e.active.push_back(c->parameters.at(0));
  };
  put("screen.leak", 0.05), put("screen.angle", 0.1), put("polarizer.leak", 0.03), put("surface.roughness", 0.2);
  manifest::Document document = manifest::parse_document(mosaic_scene(), "scene.json", folder.path());
  problem->apply(e, document);
  EXPECT_NEAR(document.lights.at("screen").parameters.at("polarization_degree").scalar(), 0.98 * 0.95 / 1.05, 1e-12);
  EXPECT_NEAR(document.lights.at("screen").parameters.at("polarization_rad").scalar(), 0.7, 1e-12);
  EXPECT_NEAR(document.surfaces.at("glass").parameters.at("alpha").scalar(), 0.2, 1e-12);
  EXPECT_EQ(document.mechanisms.at("polarizer.leak").parameters.at("leak").value.at(0), 0.03);
  EXPECT_EQ(document.mechanisms.at("polarizer.leak").on, std::vector<std::string>{"c"});
}

TEST(Mosaics, RefuseWhatTheyAreNot) {
  ScratchFolder folder;
  photograph_mosaics(mosaic_scene(), folder.path(), 3);
  io::write_picture(folder / "i1.exr", io::Image(mosaic_px, mosaic_px, {"Y", "s1.Y", "s2.Y"}));
  try {
    check_mosaics(manifest::parse_document(mosaic_scene(), "scene.json", folder.path()));
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("interpolated between polarizers"));
  }
}

// No lamp of the manifest lights what the pictures show.
TEST(Mosaics, RefuseASceneThatShowsNothing) {
  ScratchFolder folder;
  photograph_mosaics(mosaic_scene(), folder.path(), 3);
  std::string dark = mosaic_scene();
  for (std::size_t at; (at = dark.find(R"("light": ["screen", "panel"])")) != std::string::npos;)
    dark.replace(at, 28, R"("dark": true)");
  try {
    problem_of(dark, folder.path());
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("samples of its pictures can be held against the simulation"));
  }
}

}  // namespace
}  // namespace gonio::explain::tests
