#include "colour/correction.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "base/error.h"
#include "base/random.h"
#include "colour/chart.h"
#include "colour/correction_fit.h"
#include "geom/mat3_inverse.h"

namespace gonio::colour {
namespace {

const Chart& chart() {
  static const Chart classic = colorchecker_classic("after-2014", "test");
  return classic;
}
constexpr Mat3 nothing{{0, 0, 0, 0, 0, 0, 0, 0, 0}};
constexpr Mat3 camera{{0.55, 0.4, 0.05, 0.15, 0.9, -0.05, 0.02, 0.1, 0.7}};

std::vector<Sample> samples_of(const std::function<Rgb(const Patch&)>& seen) {
  std::vector<Sample> samples;
  for (const Patch& patch : chart().patches) samples.push_back({seen(patch), nothing, patch.lab});
  return samples;
}
Rgb plain(const Patch& patch) {
  return camera * patch.xyz;
}
// A camera whose channels are no mixtures of the observer's: squares and roots of degree one among them.
Rgb bent(const Patch& patch) {
  const Rgb c = camera * patch.xyz;
  return {c.x + 0.2 * std::sqrt(c.x * c.y), c.y - 0.1 * std::sqrt(c.y * c.z), c.z + 0.1 * c.z * c.z / (c.x + c.z)};
}
double mean_difference(const Correction& correction, const std::vector<Sample>& samples) {
  double sum = 0;
  for (const Sample& s : samples) sum += optics::ciede2000(s.lab, correction.lab(s.rgb));
  return sum / static_cast<double>(samples.size());
}
FitRequest request(Model model, bool refine = true) {
  return {model, Target::cie_rgb, camera * optics::white_d50, refine};
}
Correction some(Model model, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::vector<double>> matrix(3, std::vector<double>(terms_of(model).size()));
  for (auto& row : matrix)
    for (double& x : row) x = random.uniform(-1, 1);
  return {model, matrix, {0.9, 1.1, 0.6}, Target::srgb, "test"};
}
std::vector<Model> all_models() {
  std::vector<Model> all;
  for (int m = 0; m < models; ++m) all.push_back(static_cast<Model>(m));
  return all;
}

TEST(Terms, AreAsManyAsPublished) {
  const std::vector<std::size_t> counts{3, 3, 3, 6, 13, 22, 9, 19, 34};
  for (const Model model : all_models()) {
    EXPECT_EQ(terms_of(model).size(), counts[static_cast<std::size_t>(model)]) << name_of(model);
    EXPECT_EQ(model_named(name_of(model), "test"), model);
  }
  EXPECT_THROW(model_named("cubic", "test"), Error);
}

TEST(Corrections, KeepExposureWhereTheySayTheyDo) {
  Random random(1);
  for (const Model model : all_models()) {
    const Correction correction = some(model, 3);
    double most = 0;
    for (int i = 0; i < 50; ++i) {
      const Rgb pixel{random.uniform(), random.uniform(), random.uniform()};
      for (const double factor : {0.1, 10.0})
        most = std::max(most, norm(correction(pixel * factor) / factor - correction(pixel)) / norm(correction(pixel)));
    }
    if (keeps_exposure(model)) {
      EXPECT_LT(most, 1e-12) << name_of(model);
    } else {
      EXPECT_GT(most, 0.1) << name_of(model);
    }
  }
}

TEST(Corrections, SlopesAreThoseOfDifferences) {
  Random random(2);
  for (const Model model : all_models())
    for (int i = 0; i < 20; ++i) {
      const Correction correction = some(model, 4);
      const Rgb pixel{random.uniform(0.05, 1), random.uniform(0.05, 1), random.uniform(0.05, 1)};
      const Mat3 slopes = correction.slopes(pixel);
      for (int c = 0; c < 3; ++c) {
        constexpr double h = 1e-6;
        const Vec3 step{c == 0 ? h : 0, c == 1 ? h : 0, c == 2 ? h : 0};
        const Vec3 slope = (correction(pixel + step) - correction(pixel - step)) / (2 * h);
        for (int r = 0; r < 3; ++r) EXPECT_NEAR(slopes(r, c), slope[r], 1e-6) << name_of(model);
      }
    }
}

TEST(Corrections, OfAnotherShapeAreRefused) {
  EXPECT_THROW(Correction(Model::linear, {{1, 0, 0}, {0, 1, 0}}, {1, 1, 1}, Target::srgb, "x"), Error);
  EXPECT_THROW(Correction(Model::linear, {{1, 0, 0}, {0, 1, 0}, {0, 0}}, {1, 1, 1}, Target::srgb, "x"), Error);
  EXPECT_THROW(Correction(Model::linear, {{1, 0, 0}, {0, NAN, 0}, {0, 0, 1}}, {1, 1, 1}, Target::srgb, "x"), Error);
  EXPECT_THROW(Correction(Model::linear, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {1, 0, 1}, Target::srgb, "x"), Error);
}

// The variance that is written is that of the colours: against noise that goes through the correction itself.
TEST(Corrections, CarryVarianceAlong) {
  const Correction correction = some(Model::root_polynomial_2, 5);
  const Rgb mean{0.5, 0.4, 0.3};
  constexpr double sigma = 0.01;
  io::Image picture(1, 1, {"R", "G", "B", "variance.R", "variance.G", "variance.B", "mark"});
  picture.data = {0.5f, 0.4f, 0.3f, sigma * sigma, sigma * sigma, sigma * sigma, 7};
  apply(correction, picture, "test");
  Random random(8);
  Vec3 sum, squares;
  constexpr int draws = 40000;
  for (int i = 0; i < draws; ++i) {
    const Rgb c = correction(mean + Vec3{random.normal(), random.normal(), random.normal()} * sigma) - correction(mean);
    sum += c, squares += c * c;
  }
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(picture.data[static_cast<std::size_t>(c)], correction(mean)[c], 1e-6);
    // One standard deviation of the ratio is sqrt(2 / draws) = 0.7 %.
    EXPECT_NEAR(picture.data[static_cast<std::size_t>(3 + c)] / (squares[c] / draws), 1, 0.03);
  }
  EXPECT_EQ(picture.data[6], 7);
  io::Image grey(1, 1, {"Y"});
  EXPECT_THROW(apply(correction, grey, "test"), Error);
}

TEST(Fits, FindACameraThatIsAMixture) {
  const auto samples = samples_of(plain);
  for (const Model model : all_models())
    for (const Target target : {Target::cie_rgb, Target::srgb, Target::xyz_d50}) {
      FitRequest r = request(model);
      r.target = target;
      EXPECT_LT(mean_difference(fit_correction(samples, r, "test"), samples), 0.02) << name_of(model);
    }
}

TEST(Fits, RefiningLowersTheMeanDifference) {
  const auto samples = samples_of(bent);
  for (const Model model : all_models()) {
    const double before = mean_difference(fit_correction(samples, request(model, false), "test"), samples),
                 after = mean_difference(fit_correction(samples, request(model), "test"), samples);
    // Restrained terms and free light have a say in what is lowered.
    const bool plain_mean =
        model == Model::linear || model == Model::white_preserving || model == Model::root_polynomial_2;
    EXPECT_TRUE(!plain_mean || after <= before + 1e-6) << name_of(model);
    EXPECT_LT(after, 1.1 * before) << name_of(model);
  }
}

TEST(Fits, WhiteIsKeptWhereThatIsTheModel) {
  const auto samples = samples_of(bent);
  const Rgb white{1.2, 0.9, 0.8};
  const Correction correction =
      fit_correction(samples, {Model::white_preserving, Target::cie_rgb, white, true}, "test");
  EXPECT_LT(norm(correction(white) - Vec3{1, 1, 1}), 1e-12);
}

// Light that differs from patch to patch spoils a matrix, not a homography.
TEST(Fits, AHomographyDoesNotMindUnevenLight) {
  Random random(9);
  const auto even = samples_of(plain);
  const auto samples = samples_of([&](const Patch& p) { return plain(p) * random.uniform(0.6, 1.4); });
  EXPECT_GT(mean_difference(fit_correction(samples, request(Model::linear), "test"), even), 0.5);
  const Correction homography = fit_correction(samples, request(Model::homography), "test");
  for (const Sample& s : even) {
    const optics::Xyz found = inverse(from_xyz_d50(Target::cie_rgb)) * homography(s.rgb),
                      wanted = optics::xyz_from_lab(s.lab, optics::white_d50);
    EXPECT_LT(norm(found / found.y - wanted / wanted.y), 2e-3);
  }
}

TEST(Fits, NeedPatchesEnough) {
  auto samples = samples_of(bent);
  samples.resize(5);
  EXPECT_THROW(fit_correction(samples, request(Model::root_polynomial_2), "test"), Error);
  for (Sample& s : samples) s.rgb = samples[0].rgb;
  EXPECT_THROW(fit_correction(samples, request(Model::linear), "test"), Error);
}

// A patch whose readings are all noise does not drag the others along.
TEST(Fits, NoisyPatchesCountForLess) {
  auto samples = samples_of(plain);
  samples[3].rgb = samples[3].rgb * 3;
  const double trusted = optics::ciede2000(
      samples[0].lab, fit_correction(samples, request(Model::linear, false), "test").lab(samples[0].rgb));
  samples[3].covariance = {{1, 0, 0, 0, 1, 0, 0, 0, 1}};
  const double doubted = optics::ciede2000(
      samples[0].lab, fit_correction(samples, request(Model::linear, false), "test").lab(samples[0].rgb));
  EXPECT_LT(doubted, 0.2 * trusted);
}

}  // namespace
}  // namespace gonio::colour
