// Light within a ball: the term's prediction against walks that are followed here, in a sphere by its own equation, and
// the limit of short paths. Nothing is shared but the facets' places and the law of the medium.
// One process: LightInABall.*
#include "relighting/body_walks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "ball_world.h"
#include "base/random.h"
#include "explain/images/images_problem.h"
#include "manifest/document.h"

namespace gonio::explain {
namespace {

using images::ImagesProblem;

constexpr double radius_m = 0.08;
const Vec3 centre_m{0, 0, 0.081};

Vec3 any_direction(Random& random) {
  for (;;) {
    const Vec3 d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    if (const double r = dot(d, d); r > 1e-6 && r < 1) return d / std::sqrt(r);
  }
}

// V cos / d^2 on the ball, which alone casts shadows.
double arriving(Vec3 on_ball, Vec3 lamp_m) {
  const Vec3 n = (on_ball - centre_m) / radius_m, to = lamp_m - on_ball;
  const double d2 = dot(to, to);
  return std::max(0.0, dot(n, to)) / (d2 * std::sqrt(d2));
}

// E'(x) of the medium with mean free path and albedo, from `count` walks.
double wandering(Vec3 x, Vec3 lamp_m, double path_m, double albedo, int count, Random& random) {
  const double alpha = images::scattering_albedo(albedo), step_m = path_m * std::sqrt(3 * (1 - alpha));
  double sum = 0;
  for (int k = 0; k < count; ++k) {
    Vec3 at = x, direction = normalized(any_direction(random) - (x - centre_m) / radius_m);
    double weight = 1 / albedo;
    while (weight > 1e-4) {
      const double s = -step_m * std::log(random.uniform());
      const Vec3 next = at + direction * s, from_centre = next - centre_m;
      if (dot(from_centre, from_centre) > radius_m * radius_m) {
        const Vec3 p = at - centre_m;
        const double b = dot(p, direction), c = dot(p, p) - radius_m * radius_m;
        sum += weight * arriving(at + direction * (-b + std::sqrt(std::max(0.0, b * b - c))), lamp_m);
        break;
      }
      at = next, direction = any_direction(random), weight *= alpha;
    }
  }
  return sum / count;
}

class LightInABall : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new tests::ScratchFolder;
    problem_ = new ImagesProblem(tests::record_ball(*folder_, "", "", 1, 3), {.pixels = 900});
  }
  static void TearDownTestSuite() {
    delete problem_;
    delete folder_;
  }
  static std::vector<double> predicted(std::size_t group, double path_m) {
    std::vector<double> values;
    for (const Parameter& p : problem_->parameters()) {
      const bool path = p.name.starts_with("surface.subsurface@ball");
      values.push_back(path ? path_m : p.neutral);
    }
    const auto& first = problem_->observations().first;
    std::vector<double> f(first[group + 1] - first[group]);
    problem_->predict(values, group, f);
    return f;
  }
  static tests::ScratchFolder* folder_;
  static ImagesProblem* problem_;
};
tests::ScratchFolder* LightInABall::folder_ = nullptr;
ImagesProblem* LightInABall::problem_ = nullptr;

// Means over the ball's whole pixels: some 50 facets with 384 walks there, 2000 here, whose noise is below 1 % of a lit
// facet's light. A tenth of the radius as free path: the shadow's side glows.
TEST_F(LightInABall, IsThatOfWalksInASphere) {
  const images::ImageModel& model = problem_->model();
  const Rgb albedo{0.5, 0.4, 0.3};
  for (const std::size_t g : {0u, 1u, 5u}) {
    const images::Recording& image = problem_->recordings().images[g];
    const images::ViewCache& cache = model.cache(image.view);
    const Vec3 lamp = model.layout().lights[image.lights[0]].position_m;
    const std::vector<double> with = predicted(g, 0.008), without = predicted(g, 0);
    double ours[3] = {0, 0, 0}, walked[3] = {0, 0, 0}, off[3] = {0, 0, 0}, n = 0;
    for (std::size_t i = 0; i < problem_->picked(g).size(); ++i) {
      const images::Pixel& pixel = cache.pixels[problem_->picked(g)[i]];
      const images::Facet& facet = cache.facets[pixel.first_facet];
      const Vec3 at = cache.patches[facet.first_patch + facet.patches / 2].position_m;
      if (pixel.facets != 1 || pixel.sky > 0 || std::abs(norm(at - centre_m) - radius_m) > 1e-3) continue;
      Random random(9, i);
      const Vec3 x = centre_m + normalized(at - centre_m) * radius_m;
      const double own = model.small_light(image.view, pixel.first_facet, image.lights[0]);
      for (int c = 0; c < 3; ++c) {
        const double change = 0.6 * albedo[c] / pi * (wandering(x, lamp, 0.008, albedo[c], 2000, random) - own);
        ours[c] += with[3 * i + static_cast<std::size_t>(c)],
            walked[c] += without[3 * i + static_cast<std::size_t>(c)] + change;
        off[c] +=
            std::abs(with[3 * i + static_cast<std::size_t>(c)] - without[3 * i + static_cast<std::size_t>(c)] - change);
      }
      n += 1;
    }
    ASSERT_GT(n, 20);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(ours[c], walked[c], 0.015 * walked[c]) << "image " << g << " channel " << c;
      EXPECT_LT(off[c], 0.06 * walked[c]) << "image " << g << " channel " << c;
    }
  }
}

// Beneath the shortest table the light is mixed with the facet's own: no step at neutral, nothing far from it.
TEST_F(LightInABall, StaysWhereItIsWhenPathsAreShort) {
  const std::vector<double> plain = predicted(0, 0), short_paths = predicted(0, 1e-6);
  double sum = 0, off = 0;
  for (std::size_t i = 0; i < plain.size(); ++i) sum += plain[i], off += std::abs(short_paths[i] - plain[i]);
  EXPECT_GT(off, 0);
  EXPECT_LT(off, 0.002 * sum);
}

}  // namespace
}  // namespace gonio::explain
