// The response of sensors and film: inverse of each other, nested, rising, and neutral to the last bit.
#include "render/tone_curve.h"

#include <gtest/gtest.h>

#include <cmath>

namespace gonio::render {
namespace {

ToneSlopes film() {  // a base fog that hardly answers, a straight part of gamma 0.6, a shoulder
  return {30, 25, 12, 4, 2.5, 1.9, 1.7, 1.6, 1.7, 2.4, 5};
}

TEST(ToneCurve, ReadingAndLightAreInverse) {
  const ToneCurve curve(film());
  for (double z = 0.004; z < 1.5; z *= 1.07) {
    EXPECT_NEAR(curve.reading(curve.light(z)), z, 1e-12 * z) << z;
    EXPECT_EQ(curve.light(-z), -curve.light(z));
  }
  EXPECT_EQ(curve.light(0), 0);
  EXPECT_DOUBLE_EQ(curve.light(1), 1);
}

TEST(ToneCurve, SlopeInLogarithmsIsWhatTheNodesSay) {
  const ToneCurve curve(film());
  for (std::size_t k = 0; k < tone_nodes.size(); ++k) {
    const double z = tone_nodes[k], h = 1e-6;
    const double slope = (std::log(curve.light(z * (1 + h))) - std::log(curve.light(z * (1 - h)))) / (2 * h);
    EXPECT_NEAR(slope, film()[k], 1e-4 * film()[k]) << k;
  }
}

TEST(ToneCurve, EqualSlopesAreAPowerLaw) {
  ToneSlopes slopes;
  slopes.fill(1 / 0.45);
  const Response curve{0, 1, 0.8, ToneCurve(slopes)}, power{0, 0.45, 0.8, ToneCurve()};
  for (double v = 0.001; v < 2; v *= 1.3) EXPECT_NEAR(curve(v), power(v), 1e-12);
}

TEST(ToneCurve, BendsLeadOutwardsFromTheAnchor) {
  ToneBends bends{};
  EXPECT_EQ(slopes_of(1, bends), linear_tone);
  bends[tone_anchor - 1] = 0.1;
  bends[tone_anchor] = -0.2;
  const ToneSlopes slopes = slopes_of(2, bends);
  EXPECT_DOUBLE_EQ(slopes[tone_anchor], 2);
  EXPECT_DOUBLE_EQ(slopes.front(), 2 * std::exp(0.1));
  EXPECT_DOUBLE_EQ(slopes.back(), 2 * std::exp(-0.2));
}

TEST(ToneCurve, ResponsesAreUndoneByTheirInverse) {
  const Response all{-0.15, 0.7, 2.0, ToneCurve(film())};
  for (double v = 0.01; v < 2; v *= 1.2) EXPECT_NEAR(all.light(all(v)), v, 1e-11 * v) << v;
}

TEST(ToneCurve, NeutralChangesNoBit) {
  const Response neutral;
  for (const double v : {0.1, 1.0 / 3, 7.7, -0.3, 0.0, 1e-30}) {
    EXPECT_EQ(neutral(v), v);
    EXPECT_EQ(neutral.light(v), v);
  }
}

}  // namespace
}  // namespace gonio::render
