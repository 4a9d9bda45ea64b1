// The fast simulator against the path tracer, and every mechanism of images injected by the path tracer and asked back:
// a ball on a table, two cameras, three lamps. Nothing is shared between the two but surfaces, lights and rays.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "ball_world.h"
#include "explain/engine.h"
#include "explain/images/images_problem.h"
#include "manifest/document.h"

namespace gonio::explain {
namespace {

using tests::record_ball;

std::vector<double> neutral_values(const Problem& problem) {
  std::vector<double> values;
  for (const Parameter& p : problem.parameters()) values.push_back(p.neutral);
  return values;
}

// Mean of z^2 of the pixels when the fast simulator is handed the very parameters that the path tracer rendered; z
// counts the camera's noise, the fast simulator's variance and the path tracer's own.
double mean_square(const std::string& mechanisms) {
  const tests::ScratchFolder folder;
  std::vector<io::Image> renderings;
  const images::ImagesProblem problem(record_ball(folder, mechanisms, mechanisms, 512, 5, &renderings));
  const Observations& o = problem.observations();
  double sum = 0;
  for (std::size_t g = 0; g < o.groups(); ++g) {
    std::vector<double> f(o.first[g + 1] - o.first[g]);
    problem.predict(neutral_values(problem), g, f);
    const char* variances[3] = {"variance.R", "variance.G", "variance.B"};
    for (std::size_t i = 0; i < f.size(); ++i) {
      const images::Pixel& pixel =
          problem.model().cache(problem.recordings().images[g].view).pixels[problem.picked(g)[i / 3]];
      const std::size_t row = o.first[g] + i;
      const double traced = renderings[g].at(pixel.x, pixel.y, renderings[g].channel(variances[i % 3]));
      sum += std::pow(o.value[row] - f[i], 2) / (o.sigma[row] * o.sigma[row] + traced);
    }
  }
  return sum / static_cast<double>(o.rows());
}

// Some 40 000 values: noise alone would keep the mean within 0.03 of 1 (four standard errors). The rest of the bound is
// room for what the fast simulator leaves out on purpose: shadow edges between its nodes of the radius, light between
// surfaces that are not Lambertian.
TEST(ImagesModel, AgreesWithThePathTracer) {
  EXPECT_NEAR(mean_square(""), 1, 0.1);
  EXPECT_NEAR(
      mean_square(
          "\"light.finite-size\":{\"radius_m\":0.03},\"light.ambient\":{\"radiance_r\":0.05,\"radiance_g\":0.04,"
          "\"radiance_b\":0.03}"),
      1, 0.25);
  EXPECT_NEAR(mean_square("\"surface.diffuse-roughness\":{\"sigma_rad\":0.4},\"optics.vignetting\":{\"falloff\":0.2}"),
              1, 0.25);
}

TEST(ImagesModel, NeutralMechanismsChangeNoBit) {
  const tests::ScratchFolder folder;
  const images::ImagesProblem problem(record_ball(folder, "", "", 16, 3));
  const std::vector<double> values = neutral_values(problem);
  images::SceneState bare = problem.model().layout().start;
  for (std::size_t g = 0; g < problem.observations().groups(); ++g) {
    std::vector<double> with(3 * problem.picked(g).size()), without(with.size());
    problem.predict(values, g, with);
    problem.model().predict(bare, g, problem.picked(g), without);
    EXPECT_EQ(with, without);
  }
}

struct Injected {
  const char* id;
  const char* truth;
  const char* believed;
};
class ImagesInjected : public testing::TestWithParam<Injected> {};

TEST_P(ImagesInjected, IsNamed) {
  const tests::ScratchFolder folder;
  const images::ImagesProblem problem(record_ball(folder, GetParam().truth, GetParam().believed, 256, 7),
                                      {.pixels = 1800});
  const Explanation e = explain(problem, Options{});
  ASSERT_FALSE(e.named.empty()) << verdict_name(e.verdict) << ": " << e.sentence;
  EXPECT_EQ(problem.candidates()[e.named[0]].id(), GetParam().id) << e.sentence;
  EXPECT_LT(e.held_out_after, e.held_out_before);
}
INSTANTIATE_TEST_SUITE_P(
    Mechanisms, ImagesInjected,
    testing::Values(
        Injected{"light.ambient", R"("light.ambient":{"radiance_r":0.05,"radiance_g":0.05,"radiance_b":0.05})", ""},
        Injected{"light.finite-size", R"("light.finite-size":{"radius_m":0.04})", ""},
        Injected{"optics.vignetting", R"("optics.vignetting":{"falloff":0.2})", ""},
        Injected{"surface.diffuse-roughness", R"("surface.diffuse-roughness":{"on":["ball"],"sigma_rad":0.5})", ""},
        Injected{"surface.interface", R"("surface.interface":{"on":["ball"],"f0":0.05,"alpha":0.2})", ""},
        Injected{"transport.indirect", "", R"("transport.indirect":{"strength":0})"}),
    [](const testing::TestParamInfo<Injected>& info) {
      std::string name = info.param.id;
      std::replace_if(
          name.begin(), name.end(), [](char c) { return c == '.' || c == '-'; }, '_');
      return name;
    });

TEST(ImagesModel, NothingInjectedNothingNamed) {
  for (const std::uint64_t seed : {11, 12, 13}) {
    const tests::ScratchFolder folder;
    const images::ImagesProblem problem(record_ball(folder, "", "", 256, seed), {.pixels = 1800});
    EXPECT_TRUE(explain(problem, Options{}).named.empty());
  }
}

}  // namespace
}  // namespace gonio::explain
