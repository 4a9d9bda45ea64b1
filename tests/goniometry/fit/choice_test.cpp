// The simplest surface that does as well is chosen: what a richer one gains has to be beyond chance and material, and
// what says the same with more numbers is named as the same.
#include <gtest/gtest.h>

#include "goniometry/fit/fit.h"
#include "goniometry/fit/fit_choice.h"
#include "goniometry/fit/synthetic.h"

namespace gonio {
namespace {

using goniometry::Fit;
using goniometry::FitOptions;
using goniometry::Fits;

// A glossy paint with a direction and light sent back; 5 % of what no model says: waves over the hemisphere.
goniometry::Samples paint(double anisotropy, double retro, std::uint64_t seed, double waves = 0.05) {
  const surface::Model& model = *surface::find("glossy");
  const auto truth = tests::values_with(model, {{"albedo", {0.4, 0.3, 0.1}},
                                                {"f0", tests::grey(0.045)},
                                                {"alpha", tests::grey(0.2)},
                                                {"anisotropy_0", tests::grey(anisotropy)},
                                                {"retro", tests::grey(retro)},
                                                {"retro_alpha", tests::grey(0.3)}});
  auto samples = tests::directions_of(8, 30, seed);
  for (std::size_t r = 0; r < samples.rows(); ++r) {  // incidences turn, so that a direction shows
    const double turn = 0.8 * static_cast<double>(samples.series[r]);
    for (Vec3* w : {&samples.wi[r], &samples.wo[r]})
      *w = {w->x * std::cos(turn) - w->y * std::sin(turn), w->x * std::sin(turn) + w->y * std::cos(turn), w->z};
  }
  tests::measure(samples, model, truth, 0.01, 1e-3, seed, false);
  for (std::size_t k = 0; k < samples.f.size(); ++k)
    samples.f[k] *= 1 + waves * std::sin(9 * samples.wo[k / 3].x + 7 * samples.wi[k / 3].y);
  return samples;
}

Fits fitted(const goniometry::Samples& samples, std::vector<std::string> models = {"coated-diffuse", "glossy"}) {
  FitOptions options;
  options.models = std::move(models);
  options.random_starts = 1;
  options.check = false;
  return goniometry::fit_surfaces(samples, options);
}

const Fit* find(const Fits& fits, const std::string& name) {
  for (const Fit& f : fits.candidates)
    if (goniometry::name_of(f) == name) return &f;
  return nullptr;
}

TEST(Choice, TakesNoDirectionThatIsImmaterial) {
  const Fits fits = fitted(paint(0.004, 0, 3));
  const Fit& chosen = fits.candidates.at(fits.chosen);
  EXPECT_EQ(chosen.variant, "") << chosen.verdict;
  // What is passed over is within the limits that the rule states.
  for (const Fit& f : fits.candidates) {
    if (f.numbers.size() > chosen.numbers.size()) {
      EXPECT_FALSE(f.reason.empty()) << f.verdict;
    }
    if (f.numbers.size() >= chosen.numbers.size()) continue;
    const double gain = f.held_out_excess - chosen.held_out_excess;
    EXPECT_GT(gain, 0) << f.verdict;
  }
  EXPECT_LE(chosen.held_out_excess,
            std::max(chosen.held_out_excess_sigma, goniometry::material_gain * fits.candidates[0].held_out.scaled *
                                                       fits.candidates[0].held_out.scaled));
}

TEST(Choice, TakesADirectionThatIsThere) {
  const Fits fits = fitted(paint(0.25, 0, 4));
  const Fit& chosen = fits.candidates.at(fits.chosen);
  EXPECT_EQ(goniometry::name_of(chosen), "glossy (anisotropic)") << chosen.verdict;
  const auto* a = chosen.number("anisotropy_0");
  ASSERT_NE(a, nullptr);
  EXPECT_GT(a->low, 0);
}

TEST(Choice, NamesWhatSaysTheSame) {
  int same = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Fits fits = fitted(paint(0, 0, seed), {"coated-diffuse"});
    const Fit* rough = find(fits, "coated-diffuse (rough base)");
    ASSERT_NE(rough, nullptr);
    const auto* sigma = rough->number("sigma_rad");
    ASSERT_NE(sigma, nullptr);
    if (sigma->at == goniometry::FittedNumber::At::lower) {
      ++same;
      EXPECT_EQ(rough->same_as, "coated-diffuse") << rough->verdict;
      EXPECT_EQ(rough->reason, "the same as coated-diffuse");
    } else if (sigma->value > 0.2) {
      EXPECT_EQ(rough->same_as, "") << sigma->value;
    }
  }
  EXPECT_GE(same, 1);  // half of them are expected at the bound: none of six once in 64
}

TEST(Choice, TakesLightSentBackThatIsThere) {
  const Fits some = fitted(paint(0, 0.15, 5));
  const Fit& chosen = some.candidates.at(some.chosen);
  EXPECT_EQ(goniometry::name_of(chosen), "glossy (light sent back)") << chosen.verdict;
  EXPECT_EQ(chosen.same_as, "");
}

TEST(Choice, LeavesOutTheHopelessWhereBandsAreMany) {
  const auto three = paint(0, 0, 6);
  auto six = three;
  six.band_name = {"1", "2", "3", "4", "5", "6"};
  six.f.clear();
  for (std::size_t r = 0; r < three.rows(); ++r)
    for (std::size_t b = 0; b < 6; ++b) six.f.push_back(three.f[3 * r + b / 2]);
  const Fits fits = fitted(six, {"diffuse", "coated-diffuse", "metal"});
  EXPECT_EQ(fits.candidates.at(fits.chosen).model->info().id, "coated-diffuse");
  for (const Fit& f : fits.candidates) EXPECT_EQ(f.model->info().id, "coated-diffuse") << f.verdict;
  bool said = false;
  for (const auto& refusal : fits.refusals)
    said = said ||
           (refusal.model == "diffuse" && refusal.reason.find("times as much as coated-diffuse") != std::string::npos);
  EXPECT_TRUE(said);
  // With the bands that are tried all are fitted.
  EXPECT_NE(find(fitted(three, {"diffuse", "coated-diffuse", "metal"}), "diffuse"), nullptr);
}

// Axes are lines: an azimuth and that half a turn away are one surface, stated by one number.
TEST(Fit, StatesAnAxisByOneNumber) {
  const surface::Model& model = *surface::find("metal");
  FitOptions options;
  options.models = {"metal"};
  options.anisotropic = true;
  options.folds = 0;
  options.check = false;
  options.random_starts = 6;
  for (const double azimuth : {0.6, 1.5, -1.55, 2.5}) {
    const auto truth = tests::values_with(model, {{"f0", {0.9, 0.6, 0.3}},
                                                  {"alpha", tests::grey(0.3)},
                                                  {"anisotropy", tests::grey(0.5)},
                                                  {"azimuth_rad", tests::grey(azimuth)}});
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      auto samples = tests::directions_of(8, 30, seed);
      tests::measure(samples, model, truth, 0.01, 5e-4, seed, true);
      options.seed = seed;
      const Fits fits = goniometry::fit_surfaces(samples, options);
      const Fit* fit = find(fits, "metal (anisotropic)");
      ASSERT_NE(fit, nullptr);
      const auto* found = fit->number("azimuth_rad");
      ASSERT_NE(found, nullptr);
      EXPECT_LE(std::abs(found->value), pi / 2);
      // Five standard errors: a false alarm in 10^6.
      EXPECT_NEAR(std::remainder(found->value - azimuth, pi), 0, 5 * found->sigma) << azimuth;
    }
  }
}

}  // namespace
}  // namespace gonio
