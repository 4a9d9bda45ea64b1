// What directions cannot tell is not fitted: a direction of the sample, from one plane or from one azimuth between
// light and eye, is not told from the shape of its lobe, and no surface with one is offered.
#include "goniometry/fit/telling.h"

#include <gmock/gmock.h>

#include <cmath>

#include "data.h"
#include "goniometry/fit/fit.h"
#include "goniometry/fit/fit_candidates.h"
#include "goniometry/fit/limits.h"
#include "goniometry/fit/recorded.h"
#include "goniometry/fit/synthetic.h"

namespace gonio {
namespace {

using goniometry::Fits;
using testing::HasSubstr;

// Six incidences; the eye swept at these azimuths from the light; the sample turned by these angles.
goniometry::Samples swept(const std::vector<double>& azimuths_deg, const std::vector<double>& turns_deg, double step) {
  goniometry::Samples s;
  s.name = "swept";
  s.band_name = {""};
  const double k = pi / 180;
  std::size_t series = 0;
  for (const double turn : turns_deg)
    for (const double theta : {5, 15, 30, 45, 60, 75}) {
      for (const double azimuth : azimuths_deg)
        for (double to = 0; to <= 80; to += step) {
          s.wi.push_back(tests::direction(theta * k, turn * k));
          s.wo.push_back(tests::direction(to * k, (turn + azimuth) * k));
          s.series.push_back(series);
        }
      ++series;
    }
  return s;
}

// A lobe that is no GGX on a matte ground, the same however the sample is turned.
void measure_foreign_lobe(goniometry::Samples& s) {
  Random random(3, 1);
  for (std::size_t r = 0; r < s.rows(); ++r) {
    const Vec3 h = normalized(s.wi[r] + s.wo[r]);
    const double c2 = h.z * h.z, d = dot(h, s.wi[r]), fresnel = 0.04 + 0.96 * std::pow(1 - d, 5);
    const double peak = std::exp((1 - 1 / c2) / 0.0625) / (pi * 0.0625 * c2 * c2), tail = std::exp(-6 * std::acos(h.z));
    const double f = 0.1 / pi + fresnel * (0.6 * peak + 0.4 * tail) / std::pow(4 * s.wi[r].z * s.wo[r].z, 0.7);
    s.f.push_back(f * std::exp(0.02 * random.normal()));
  }
}

TEST(Telling, ADirectionNeedsMoreThanOneAzimuth) {
  for (const double azimuth : {180, 170, 150, 120, 90, 45})
    EXPECT_FALSE(goniometry::turns_about_normal(swept({azimuth}, {0}, 2))) << azimuth;
  EXPECT_LT(goniometry::told_direction(swept({180}, {0}, 2)), 1e-6);
  EXPECT_TRUE(goniometry::turns_about_normal(swept({180}, {0, 45, 90}, 2)));
  EXPECT_TRUE(goniometry::turns_about_normal(swept({150, 210}, {0}, 2)));
  EXPECT_TRUE(goniometry::turns_about_normal(swept({0, 60, 120, 180, 240, 300}, {0}, 8)));
  // Two planes at right angles show the axes that lie in them, and none between: 0 of sin 2p.
  EXPECT_FALSE(goniometry::turns_about_normal(swept({180}, {0, 90}, 2)));
}

// 150 degrees between light and eye: an isotropic lobe of another shape was called anisotropic, and good.
TEST(Telling, OneAzimuthOffersNoDirection) {
  goniometry::Samples s = swept({150}, {0}, 2);
  measure_foreign_lobe(s);
  goniometry::FitOptions options;
  options.models = {"glossy", "glossy-metal"};
  options.random_starts = 1;
  const Fits fits = goniometry::fit_surfaces(s, options);
  ASSERT_LT(fits.chosen, fits.candidates.size());
  for (const goniometry::Fit& fit : fits.candidates) EXPECT_THAT(fit.variant, testing::Not(HasSubstr("anisotropic")));
  EXPECT_THAT(fits.untold,
              testing::AllOf(HasSubstr("anisotropy and its axis"), HasSubstr("turn the sample about its")));
  ASSERT_FALSE(fits.refusals.empty());
  EXPECT_EQ(fits.refusals.front().variant, "anisotropic");
}

TEST(Telling, InPlaneScansAreNotAskedEvenWhenForced) {
  goniometry::Samples s = swept({180}, {0}, 4);
  measure_foreign_lobe(s);
  goniometry::FitOptions options;
  options.models = {"glossy"};
  options.anisotropic = true;
  options.random_starts = 0;
  const Fits fits = goniometry::fit_surfaces(s, options);
  for (const goniometry::Fit& fit : fits.candidates) EXPECT_THAT(fit.variant, testing::Not(HasSubstr("anisotropic")));
  EXPECT_THAT(fits.refusals, testing::Contains(testing::Field(&goniometry::Refusal::reason,
                                                              HasSubstr("do not tell anisotropy_0, anisotropy_45"))));
}

TEST(Telling, RecordedTables) {
  GONIO_NEEDS_DATA("brdf");
  const auto cornell = tests::cornell(tests::data("brdf") / "cornell/acryl_blue.brdf", {550});
  const auto plane = tests::scans(tests::data("brdf") / "starlink-lab/chassis_brdf.csv");
  ASSERT_GT(cornell.rows(), 1000u);
  ASSERT_GT(plane.rows(), 500u);
  EXPECT_GT(goniometry::told_direction(cornell), 0.5);
  EXPECT_LT(goniometry::told_direction(plane), 0.01);
}

}  // namespace
}  // namespace gonio
