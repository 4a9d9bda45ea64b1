// Slopes of every registered surface against central differences of its values, at random numbers and directions.
#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "surface/surface.h"

namespace gonio {
namespace {

// Inside the bounds, away from them, and from narrow lobes that differences cannot follow.
double drawn(const manifest::ParameterInfo& p, Random& random) {
  const double lower = std::isfinite(p.lower) ? p.lower : -1,
               upper = std::isfinite(p.upper) ? std::min(p.upper, 4.0) : 1;
  const double u = random.uniform(0.08, 0.9);
  return p.unit == "m" ? lower + (p.upper - lower) * 1e-3 * (1 + u) : lower + (upper - lower) * u;
}

surface::Values drawn_values(const surface::Model& model, Random& random) {
  surface::Values values;
  std::size_t i = 0;
  for (const auto& p : model.info().parameters) {
    const double x = drawn(p, random);
    values.v[i++] = p.components == 3 ? Rgb{x, drawn(p, random), drawn(p, random)} : Rgb{x, x, x};
  }
  values.eta = {1.5, 1.5, 1.5};
  return values;
}

Vec3 above(Random& random) {
  const double z = random.uniform(0.15, 1), phi = random.uniform(-pi, pi), r = std::sqrt(1 - z * z);
  return {r * std::cos(phi), r * std::sin(phi), z};
}

// Differences to the right and left: an interpolant has a kink at its nodes, where either is right.
struct Differences {
  Rgb left, right;
};
Differences differences(const surface::Model& model, const surface::Values& values, std::size_t i, Vec3 wo, Vec3 wi) {
  const double step = 1e-6 * std::max(1e-3, std::abs(values.v[i].x));
  surface::Values more = values, less = values;
  more.v[i] = values.v[i] + Rgb{step, step, step};
  less.v[i] = values.v[i] - Rgb{step, step, step};
  const Rgb here = model.evaluate(values, wo, wi);
  return {(here - model.evaluate(less, wo, wi)) / step, (model.evaluate(more, wo, wi) - here) / step};
}

class Slopes : public testing::TestWithParam<const surface::Model*> {};

TEST_P(Slopes, EqualDifferences) {
  const surface::Model& model = *GetParam();
  const manifest::ModelInfo& info = model.info();
  Random random(11, 5);
  std::vector<Rgb> slopes(info.parameters.size());
  const int draws = model.transmits() ? 3 : 60;  // their tables take long, and their slopes are differences anyway
  for (int draw = 0; draw < draws; ++draw) {
    const surface::Values values = drawn_values(model, random);
    const Vec3 wo = above(random), wi = above(random);
    const Rgb f = model.evaluate(values, wo, wi), same = model.evaluate_with_slopes(values, wo, wi, slopes);
    for (int c = 0; c < 3; ++c) ASSERT_NEAR(same[c], f[c], 1e-9 * (std::abs(f[c]) + 1e-6)) << draw;
    for (std::size_t i = 0; i < slopes.size(); ++i) {
      const Differences d = differences(model, values, i, wo, wi);
      for (int c = 0; c < 3; ++c) {
        // Patterns with lengths integrate their density in a number of steps that changes with them.
        const double allowed =
            (info.parameters[i].unit == "m" ? 0.1 : 1e-4) * (std::abs(d.left[c]) + std::abs(d.right[c])) +
            1e-7 * (std::abs(f[c]) + 1e-3) / std::max(1e-3, std::abs(values.v[i][c]));
        const double off = std::min({std::abs(slopes[i][c] - d.left[c]), std::abs(slopes[i][c] - d.right[c]),
                                     std::abs(2 * slopes[i][c] - d.left[c] - d.right[c]) / 2});
        EXPECT_LE(off, allowed) << info.parameters[i].name << " of band " << c << " in draw " << draw << ": "
                                << slopes[i][c] << " against " << d.left[c] << ", " << d.right[c] << " at "
                                << values.v[i][c];
      }
    }
  }
}

std::string name_of(const testing::TestParamInfo<const surface::Model*>& info) {
  std::string name = info.param->info().id;
  for (char& c : name)
    if (c == '-') c = '_';
  return name;
}
// Those that numbers alone describe: no file, no base.
std::vector<const surface::Model*> of_numbers() {
  std::vector<const surface::Model*> models;
  for (const surface::Model* model : surface::all_models())
    if (model->info().attachment == manifest::Attachment::none && !model->info().takes_base) models.push_back(model);
  return models;
}
INSTANTIATE_TEST_SUITE_P(EverySurface, Slopes, testing::ValuesIn(of_numbers()), name_of);

// Where a surface has no direction its slopes by the astigmatism exist all the same.
TEST(SlopesAtNoDirection, OfAnAstigmatism) {
  for (const char* id : {"glossy", "glossy-metal"}) {
    const surface::Model& model = *surface::find(id);
    Random random(12, 5);
    surface::Values values = drawn_values(model, random);
    std::size_t a0 = 0;
    for (std::size_t i = 0; i < model.info().parameters.size(); ++i) {
      const std::string& name = model.info().parameters[i].name;
      if (name.starts_with("anisotropy") || name == "azimuth_rad") values.v[i] = {};
      if (name == "anisotropy_0") a0 = i;
    }
    std::vector<Rgb> slopes(model.info().parameters.size());
    const Vec3 wo = above(random), wi = above(random);
    model.evaluate_with_slopes(values, wo, wi, slopes);
    surface::Values more = values, less = values;
    for (const std::size_t i : {a0, a0 + 1}) {
      // A step beyond the change of tables that a direction brings.
      more.v[i] = {0.02, 0.02, 0.02}, less.v[i] = {-0.02, -0.02, -0.02};
      const Rgb d = (model.evaluate(more, wo, wi) - model.evaluate(less, wo, wi)) / 0.04;
      EXPECT_NEAR(slopes[i].x, d.x, 0.05 * std::abs(d.x) + 1e-3) << id << " " << i;
      more = less = values;
    }
  }
}

}  // namespace
}  // namespace gonio
