// Twelve photographs of a matte sphere under twelve lights whose directions are not exact. The manifest is that of
// scripts/recordings/uw_psm. Beside it stood a mirror sphere, which the explanation never sees: its highlights say
// where the lights really were. Axes: x right, y down, z away from the camera.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "data.h"
#include "explain/engine.h"
#include "explain/images/images_problem.h"
#include "inference/race.h"
#include "io/picture.h"
#include "light/turn.h"
#include "manifest/document.h"
#include "process.h"

namespace gonio::explain {
namespace {

constexpr std::size_t lights = 12;
constexpr double highlight = 0.9;  // of the picture's maximum

manifest::Document gray_manifest() {
  const tests::Ended script = tests::run(
      {std::string(GONIO_SOURCE) + "/scripts/recordings/uw_psm", tests::data("photometric/uw-psm").string()});
  EXPECT_EQ(script.status, 0) << script.err;
  return manifest::parse_document(script.out, "gray.json", "/", {.allow_outside = true});
}

// Direction of light i from the mirror sphere's highlight: the mirror of the view's direction about the normal there.
Vec3 towards_by_mirror(std::size_t i) {
  const std::filesystem::path folder = tests::data("photometric/uw-psm/chrome");
  const io::Image picture = io::read_picture(folder / ("chrome." + std::to_string(i) + ".png"));
  const io::Image mask = io::read_picture(folder / "chrome.mask.png");
  std::vector<double> level(picture.pixels());
  for (std::size_t p = 0; p < level.size(); ++p)
    if (mask.data[p * mask.channels.size()] > 0.5f)
      for (std::size_t c = 0; c < picture.channels.size(); ++c)
        level[p] += picture.data[p * picture.channels.size() + c];
  const double brightest = *std::max_element(level.begin(), level.end());
  double x = 0, y = 0, n = 0;
  for (std::size_t p = 0; p < level.size(); ++p) {
    if (level[p] <= highlight * brightest) continue;
    x += static_cast<double>(p % static_cast<std::size_t>(picture.width));
    y += static_cast<double>(p / static_cast<std::size_t>(picture.width));
    n += 1;
  }
  Vec3 normal{(x / n - 253.5) / 119.25, (y / n - 148.0) / 119.25, 0};
  normal.z = -std::sqrt(1 - dot(normal, normal));
  const Vec3 view{0, 0, -1};
  return normal * (2 * dot(normal, view)) - view;
}

double degrees_between(Vec3 a, Vec3 b) {
  return std::acos(std::clamp(dot(normalized(a), normalized(b)), -1.0, 1.0)) * 180 / pi;
}

// Root mean square of the mean over the channels, over pixels that the supplied lights reach by n.l > 0.15, away from
// the outline.
double lit_rms(const images::ImagesProblem& problem, const std::vector<double>& residual) {
  double sum = 0, n = 0;
  for (std::size_t g = 0; g < problem.observations().groups(); ++g) {
    const Vec3 towards = problem.model().layout().lights[g].direction;
    for (std::size_t i = 0; i < problem.picked(g).size(); ++i) {
      const images::Pixel& pixel = problem.model().cache(0).pixels[problem.picked(g)[i]];
      Vec3 normal{(pixel.x - 244.5) / 108, (pixel.y - 144.5) / 108, 0};
      if (dot(normal, normal) > 0.98) continue;
      normal.z = -std::sqrt(1 - dot(normal, normal));
      if (dot(normal, towards) <= 0.15) continue;
      const std::size_t row = problem.observations().first[g] + 3 * i;
      const double mean = (residual[row] + residual[row + 1] + residual[row + 2]) / 3;
      sum += mean * mean;
      n += 1;
    }
  }
  return std::sqrt(sum / n);
}

// Its place among the candidates, the form with most numbers of those that are no finer ones.
std::size_t place_of(const Problem& problem, const std::string& id) {
  std::size_t best = problem.candidates().size();
  for (std::size_t c = 0; c < problem.candidates().size(); ++c) {
    const Candidate& candidate = problem.candidates()[c];
    if (candidate.id() != id || candidate.finer) continue;
    if (best == problem.candidates().size() ||
        candidate.parameters.size() > problem.candidates()[best].parameters.size())
      best = c;
  }
  return best;
}

// What is true of these recordings, whatever is said of it: scripts/proofs/explain-gray asks the whole library for the
// verdict. Both are needed, and no rival does as much on lights that were left out.
TEST(Gray, LightsAndRoughnessTogetherFindWhereTheLightsWere) {
  GONIO_NEEDS_DATA("photometric/uw-psm");
  const images::ImagesProblem problem(gray_manifest(), {.pixels = 9000});
  const Options options;
  inference::System system(problem, options.seed);
  std::vector<double> start;
  for (const Parameter& p : problem.parameters()) start.push_back(p.neutral);
  for (const std::size_t p : problem.base()) start[p] = problem.parameters()[p].start;
  const inference::Race race(system, options);
  const inference::Model base = race.base(start);
  const auto with = [&](const std::vector<std::string>& ids) {
    std::vector<std::size_t> candidates;
    for (const std::string& id : ids) candidates.push_back(place_of(problem, id));
    return race.changed(base, candidates);
  };
  const inference::Model both = with({"light.direction", "surface.diffuse-roughness"});
  for (const char* rival :
       {"light.direction", "surface.diffuse-roughness", "surface.interface", "light.ambient", "optics.vignetting"}) {
    const inference::Gain apart = inference::gain(with({rival}).held_out, both.held_out);
    EXPECT_GT(apart.mean, apart.sigma) << rival;
  }
  const double before = lit_rms(problem, system.raw_residual(base.fit.values)),
               after = lit_rms(problem, system.raw_residual(both.fit.values));
  EXPECT_NEAR(before, 0.038, 0.003);
  // What was fitted loses to what was left out by the ratio of the two scores.
  double squares = 0, norm = 0;
  const std::vector<double> residual = system.raw_residual(both.fit.values);
  for (std::size_t i = 0; i < residual.size(); ++i) {
    if (!(system.weight(i) > 0)) continue;
    squares += residual[i] * residual[i];
    norm += problem.observations().norm[i];
  }
  EXPECT_LE(after * both.held_out.score() / std::sqrt(squares / norm), 0.029);

  double supplied = 0, recovered = 0;
  const images::SceneState state = problem.state(both.fit.values);
  for (std::size_t l = 0; l < lights; ++l) {
    const Vec3 given = problem.model().layout().lights[l].direction, truth = towards_by_mirror(l);
    supplied += degrees_between(given, truth) / lights;
    recovered +=
        degrees_between(light::turned(given, state.lights[l].tilt_x_rad, state.lights[l].tilt_y_rad), truth) / lights;
  }
  EXPECT_LT(recovered, supplied - 0.5);
  RecordProperty("rms_before", std::to_string(before));
  RecordProperty("rms_after", std::to_string(after));
  RecordProperty("degrees_supplied", std::to_string(supplied));
  RecordProperty("degrees_recovered", std::to_string(recovered));
  std::printf("rms %.4f -> %.4f, directions against the mirror ball %.2f -> %.2f degrees\n", before, after, supplied,
              recovered);
}

}  // namespace
}  // namespace gonio::explain
