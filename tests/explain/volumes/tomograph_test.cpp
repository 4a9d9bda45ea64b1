// The tomograph in small that templates of hardening and scatter come from, against integrals in closed form; the
// believed shape as shares of cells; equations of the terms.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "explain/volumes/ball_mesh.h"
#include "explain/volumes/simulated_tomograph.h"
#include "explain/volumes/volume_term.h"

namespace gonio::explain::volumes {
namespace {

constexpr double extent = 0.02, radius = 0.007;
const Vec3 whole{extent, extent, extent};

TEST(BelievedBody, HoldsTheVolumeOfAHollowBall) {
  mesh::Mesh mesh = tests::ball_mesh({0.0003, -0.0005, 0.0007}, radius, false);
  tests::join(mesh, tests::ball_mesh({0.001, 0, 0}, 0.4 * radius, true));
  const Body body = body_of(mesh, {64, 64, 64}, whole, "mesh");
  double sum = 0;
  for (const float s : body.share) sum += static_cast<double>(s);
  const double cell = extent / 64;
  EXPECT_NEAR(sum * cell * cell * cell / (4.0 / 3 * pi * radius * radius * radius * (1 - 0.064)), 1, 3e-3);
  EXPECT_NEAR(body.at({0.001, 0, 0}), 0, 1e-6);
  EXPECT_NEAR(body.at({-0.004, 0, 0}), 1, 1e-6);
  EXPECT_EQ(body.at({1, 0, 0}), 0);
}

TEST(BelievedBody, RefusesWhatIsOpenOrElsewhere) {
  mesh::Mesh open = tests::ball_mesh({}, radius, false);
  open.triangles.resize(open.triangles.size() / 2);
  EXPECT_THROW(body_of(open, {32, 32, 32}, whole, "mesh"), Error);
  EXPECT_THROW(body_of(tests::ball_mesh({1, 0, 0}, radius, false), {32, 32, 32}, whole, "mesh"), Error);
  EXPECT_THROW(body_of(tests::ball_mesh({}, radius, true), {32, 32, 32}, whole, "mesh"), Error);  // faces inwards
}

// p of a slice of radius a has chords 2 sqrt(a^2 - u^2). Back comes the slice itself; of p^2 = 4 (a^2 - u^2), by Abel's
// inversion, (8 / pi) sqrt(a^2 - r^2). 120 views of bins that cells are shared out to: to three and six percent.
TEST(Tomograph, ReconstructsWhatAbelsInversionSays) {
  const Tomograph tomograph(body_of(tests::ball_mesh({}, radius, false), {96, 96, 96}, whole, "mesh"));
  EXPECT_NEAR(tomograph.longest_m() / (2 * radius), 1, 0.02);
  std::vector<Vec3> places;
  for (const double r : {0.0, 0.2, 0.4, 0.6, 0.8}) places.push_back(Vec3{0.6 * r, -0.8 * r, 0} * radius);
  const std::vector<double> itself = tomograph.reconstructed([](double p) { return p; }, places),
                            squares = tomograph.reconstructed([](double p) { return p * p; }, places);
  for (std::size_t k = 0; k < places.size(); ++k) {
    EXPECT_NEAR(itself[k], 1, 0.03) << k;
    EXPECT_NEAR(squares[k] / (8 / pi * std::sqrt(radius * radius - dot(places[k], places[k]))), 1, 0.06) << k;
  }
  const Vec3 outside{1.3 * radius, 0, 0};
  EXPECT_NEAR(tomograph.reconstructed([](double p) { return p; }, {&outside, 1})[0], 0, 0.04);
  const double path = tomograph.mean_path({&places[0], 1})[0];
  EXPECT_NEAR(path / (2 * radius), 1, 0.02);
}

// Weak scatter is in proportion to its share, more of it less than that.
TEST(Tomograph, ScatterSaturates) {
  const Tomograph tomograph(body_of(tests::ball_mesh({}, radius, false), {48, 48, 48}, whole, "mesh"));
  const std::vector<Vec3> places{{0, 0, 0}, {0.5 * radius, 0, 0}};
  const double per_m = 2 / (2 * radius);
  const auto lost = tomograph.scattered(per_m, std::vector<double>{1e-4, 1e-3, 0.5}, places);
  for (std::size_t k = 0; k < places.size(); ++k) {
    EXPECT_GT(lost[0][k], 0);
    EXPECT_NEAR(lost[1][k] / lost[0][k], 1, 0.01);
    EXPECT_LT(lost[2][k], 0.95 * lost[0][k]);
  }
  EXPECT_GT(lost[0][0], lost[0][1]);  // deeper where paths are longer
}

std::vector<Row> some_rows() {
  std::vector<Row> rows;
  for (const Reading reading : {Reading::wall, Reading::width, Reading::inside, Reading::outside}) {
    Row row;
    row.reading = reading;
    row.at_m = {0.003, -0.002, 0.004};
    row.normal = normalized(Vec3{0.5, 0.4, 0.3});
    row.hardening = 0.7, row.scatter = {0.4, 0.38, 0.3, 0.2}, row.ring = 1.2, row.markers = 0.1;
    rows.push_back(row);
  }
  return rows;
}

TEST(VolumeTerms, VanishAtNeutralAndTouchTheirReadingsAlone) {
  Observed o;
  o.voxel_m = 1e-4, o.field_m = 0.01, o.half_height_m = 0.01;
  for (const Term* term : all_terms()) {
    const mechanism::Mechanism& m = term->mechanism();
    std::vector<double> neutral, some;
    for (const mechanism::Parameter& p : m.parameters) neutral.push_back(p.neutral), some.push_back(0.5 * p.upper);
    int touched = 0;
    for (const Row& row : some_rows()) {
      EXPECT_EQ(term->act(0.625, row, o, neutral), 0.625) << m.id;
      touched += term->act(0.625, row, o, some) != 0.625;
    }
    EXPECT_GE(touched, 1) << m.id;
    EXPECT_LE(touched, 2) << m.id;
  }
}

// A part twice as far from the middle moves twice as far; one that faces sideways not at all.
TEST(VolumeTerms, ScaleMovesWallsByTheirDistance) {
  Observed o;
  o.voxel_m = 1e-4, o.field_m = 0.01;
  const auto term =
      std::ranges::find_if(all_terms(), [](const Term* t) { return t->mechanism().id.ends_with("scale"); });
  Row row;
  row.at_m = {0.005, 0, 0}, row.normal = {1, 0, 0};
  const std::vector<double> p{0.01, 0};
  EXPECT_NEAR((*term)->act(0, row, o, p), 0.01 * 50, 1e-12);
  row.normal = {0, 1, 0};
  EXPECT_NEAR((*term)->act(0, row, o, p), 0, 1e-12);
}

}  // namespace
}  // namespace gonio::explain::volumes
