// The surface that stands for a relief against lobes that were traced over it.
#include "relief/lobe_surface.h"

#include <gtest/gtest.h>

#include <cmath>

#include "relief/noise.h"

namespace gonio::relief {
namespace {

const SlopeFit& fit_of(const Normals& normals, const char* distribution) {
  return normals.fits[normals.fits[0].distribution == distribution ? 0 : 1];
}

Relief noise() {
  NoiseField field;
  field.parts = {{0.3e-6, 8e-6}}, field.nx = field.ny = 192, field.step_m = 0.5e-6, field.seed = 3;
  field.periodic = true;
  return noise_relief(field);
}

// Slopes of noise are close to normal, so that Beckmann's form with both roughnesses has to predict the lobe; without
// the facets' own, or without the map's, it is further off.
TEST(LobeSurface, PredictsTheLobeWithBothRoughnesses) {
  const Relief relief = noise();
  const manifest::Parameters facets{{"eta", 1.5}, {"k", 0.0}, {"alpha", 0.2}};
  const Normals normals = normals_of(map_of(relief));
  const RoughSurface rough = surface_of("beckmann-conductor", facets, normals);
  ASSERT_TRUE(rough.surface);
  std::vector<TracedLobe> lobes;
  for (const double theta : {0.0, 0.7}) {
    const Vec3 wi = direction_of(theta, 0.3);
    lobes.push_back({wi, lobe_table(relief, material_of("beckmann-conductor", facets, "facets"), wi, {18, 24, 8},
                                    {.paths = 200000, .seed = 5})});
  }
  const double both = log1p_rms(*rough.surface, lobes).value();
  const auto with = [&](double alpha) {
    manifest::Surface other = *rough.surface;
    other.parameters["alpha"] = alpha;
    return log1p_rms(other, lobes).value();
  };
  const double own = fit_of(normals, "beckmann").alpha_u;
  EXPECT_LT(both, 0.06);
  EXPECT_LT(both, 0.8 * with(own)) << "the facets' roughness counts";
  EXPECT_LT(both, 0.5 * with(0.2)) << "the map's does";
}

TEST(LobeSurface, TakesTheLikelierDistributionAndSaysWhyNot) {
  Normals normals = normals_of(map_of(noise()));
  const SlopeFit ggx = fit_of(normals, "ggx");
  const manifest::Parameters smooth{{"eta", 1.5}, {"k", 0.0}};
  normals.fits = {ggx};
  EXPECT_EQ(surface_of("beckmann-conductor", smooth, normals).surface->model, "conductor");
  EXPECT_EQ(surface_of("metal", {{"f0", 0.9}}, normals).surface->model, "metal");
  const auto rough = surface_of("conductor", {{"eta", 1.5}, {"k", 0.0}, {"alpha", 0.0}}, normals).surface.value();
  EXPECT_DOUBLE_EQ(rough.parameters.at("alpha").scalar(), ggx.alpha_u);
  EXPECT_NEAR(rough.parameters.at("alpha").scalar() * (1 - 0.9 * rough.parameters.at("anisotropy").scalar()),
              ggx.alpha_v, 1e-12);
  EXPECT_NEAR(rough.sigma.at("alpha").at(0), ggx.sigma_alpha_u, 1e-15);
  EXPECT_FALSE(surface_of("diffuse", {{"albedo", 0.5}}, normals).surface);
  EXPECT_FALSE(surface_of("conductor", {{"eta", 1.5}, {"k", 0.0}, {"anisotropy", 0.5}}, normals).surface);
  normals.fits[0].alpha_u = 1.2;
  EXPECT_FALSE(surface_of("conductor", smooth, normals).surface);
}

// Nine of ten cells of this table are reached by no path; their sigma is one path's, so that a fit may weigh by it.
TEST(LobeTable, EveryCellHasASigma) {
  const Relief flat(4, 4, 1e-6, 1e-6, std::vector<double>(16, 0.0), true);
  const LobeTable lobe = lobe_table(flat, mirror(), direction_of(0.5, 0), {18, 24, 8}, {.paths = 6400, .seed = 1});
  double least = 1e300;
  for (const Estimate& e : lobe.table) least = std::min(least, e.sigma.y);
  EXPECT_GT(least, 0);
  const double projected = std::pow(std::sin(pi / 36), 2) * pi / 24;  // of a cell about the normal
  EXPECT_NEAR(lobe.table[0].sigma.y * projected * 6400, 1, 1e-9);
}

}  // namespace
}  // namespace gonio::relief
