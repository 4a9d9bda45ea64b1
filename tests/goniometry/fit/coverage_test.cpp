// Intervals of 95 % hold the truth in 90 to 98 of 100 cases. Of 300 independent looks at an honest interval the share
// leaves [0.90, 0.98] once in a hundred times; the seeds are fixed. The larger study: scripts/prove brdf-coverage.
#include <gtest/gtest.h>

#include "goniometry/fit/study.h"

namespace gonio {
namespace {

using goniometry::Scale;

void expect_honest(const tests::Truth& truth, int repetitions, bool stated, Scale scale) {
  const auto cover = tests::coverage(truth, repetitions, 25, 0.02, 5e-4, stated, scale, 1);
  EXPECT_GE(cover.at("").share(), 0.90) << truth.model;
  EXPECT_LE(cover.at("").share(), 0.98) << truth.model;
  EXPECT_LE(cover.at("").lost, cover.at("").looks / 20) << truth.model;
}

const tests::Truth paint{"coated-diffuse",
                         "",
                         {{"albedo", {0.5, 0.3, 0.1}},
                          {"sigma_rad", {0, 0, 0}},
                          {"f0", {0.045, 0.045, 0.045}},
                          {"alpha", {0.15, 0.15, 0.15}}}};
const tests::Truth metal{"metal", "", {{"f0", {0.9, 0.6, 0.3}}, {"alpha", {0.25, 0.25, 0.25}}}};

TEST(Coverage, OfAPaintWithStatedNoise) {
  expect_honest(paint, 60, true, Scale::noise);
}
TEST(Coverage, OfAPaintWithoutStatedNoise) {
  expect_honest(paint, 60, false, Scale::log1p);
}
TEST(Coverage, OfAMetalInDecades) {
  expect_honest(metal, 75, false, Scale::log10);
}

}  // namespace
}  // namespace gonio
