// Recorded reflectances against SciPy's figures on the same files (DATA/README.md).
#include "goniometry/fit/recorded.h"

#include <gtest/gtest.h>

#include "data.h"
#include "goniometry/fit/fit.h"

namespace gonio {
namespace {

using goniometry::Fit;
using goniometry::FitOptions;
using goniometry::Fits;

bool missing(const std::filesystem::path& path) {
  if (std::filesystem::exists(path)) return false;
  if (tests::data_is_required()) ADD_FAILURE() << path << " is missing";
  return true;
}

const Fit* find(const Fits& fits, const std::string& model, const std::string& variant) {
  for (const Fit& f : fits.candidates)
    if (f.model->info().id == model && f.variant == variant) return &f;
  return nullptr;
}

struct Paint {
  const char* file;
  double scipy;  // rms at 550 nm with one lobe
};
class Cornell : public testing::TestWithParam<Paint> {};

TEST_P(Cornell, OneLobeIsAsGoodAsSciPysAndTwoAreBetter) {
  const auto path = tests::data("brdf/cornell") / GetParam().file;
  if (missing(path)) GTEST_SKIP();
  FitOptions options;
  options.models = {"coated-diffuse", "glossy"};
  options.anisotropic = false;
  options.random_starts = 2;
  const Fits fits = goniometry::fit_surfaces(tests::cornell(path, {550}, pi / 2), options);
  const Fit *one = find(fits, "coated-diffuse", ""), *two = find(fits, "glossy", "two lobes");
  ASSERT_NE(one, nullptr);
  ASSERT_NE(two, nullptr);
  EXPECT_LE(one->fitted.log1p, GetParam().scipy + 5e-4);
  EXPECT_LT(two->fitted.log1p, one->fitted.log1p);
  EXPECT_LE(one->held_out.log1p, 1.15 * one->fitted.log1p);
  EXPECT_LE(two->held_out.log1p, 1.15 * two->fitted.log1p);
  ASSERT_LT(fits.chosen, fits.candidates.size());
  EXPECT_LE(fits.candidates[fits.chosen].energy, 1.0);
  EXPECT_LE(fits.candidates[fits.chosen].reciprocity, 1e-6);
}
INSTANTIATE_TEST_SUITE_P(Paints, Cornell,
                         testing::Values(Paint{"garnet_red.brdf", 0.075}, Paint{"krylon_blue.brdf", 0.074}),
                         [](const auto& info) { return std::string(info.param.file).substr(0, 6); });

struct Scans {
  const char* name;
  const char* file;
  double limit;  // decades
};
class InPlane : public testing::TestWithParam<Scans> {};

TEST_P(InPlane, TwoPopulationsOfFacetsFollowTheTails) {
  const auto path = tests::data("brdf") / GetParam().file;
  if (missing(path)) GTEST_SKIP();
  FitOptions options;
  options.models = {"metal", "glossy-metal"};
  options.scale = goniometry::Scale::log10;
  options.random_starts = 2;
  const Fits fits = goniometry::fit_surfaces(tests::scans(path), options);
  ASSERT_LT(fits.chosen, fits.candidates.size());
  const Fit& chosen = fits.candidates[fits.chosen];
  EXPECT_NE(chosen.variant.find("two lobes"), std::string::npos) << chosen.verdict;
  EXPECT_LT(chosen.fitted.decades, GetParam().limit);
  EXPECT_LT(chosen.held_out.decades, 1.15 * chosen.fitted.decades);
  const Fit* one = find(fits, "metal", "");
  ASSERT_NE(one, nullptr);
  EXPECT_GT(one->fitted.decades, 1.5 * chosen.fitted.decades);
}
INSTANTIATE_TEST_SUITE_P(Metals, InPlane,
                         testing::Values(Scans{"chassis", "starlink-lab/chassis_brdf.csv", 0.26},
                                         Scans{"aluminium", "merl-aluminium-slices/aluminum_brdf.csv", 0.31}),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace gonio
