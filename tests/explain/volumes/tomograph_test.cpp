// The tomograph in small that templates of hardening and scatter come from, against integrals in closed form; the
// believed shape as shares of cells; equations of the terms.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "explain/volumes/ball_mesh.h"
#include "explain/volumes/believed_body.h"
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

constexpr std::array<std::size_t, 3> cells{96, 96, 96};
const Vec3 cell{extent / 96, extent / 96, extent / 96};
constexpr double thin_per_m = 1;  // so little that a pixel's mean intensity is that of its mean path

std::vector<double> back(const Tomograph& tomograph, const Readings& readings, const std::vector<Vec3>& places) {
  std::vector<double> result;
  for (const auto& v : tomograph.reconstructed({&readings, 1}, places)) result.push_back(static_cast<double>(v[0]));
  return result;
}

Readings squared(Readings readings) {
  for (float& p : readings) p *= p;
  return readings;
}

// A ball's lines have chords 2 sqrt(r^2 - u^2 - z^2), through a hollow two pieces.
TEST(LineIntegrals, AreChordsOfBalls) {
  mesh::Mesh mesh = tests::ball_mesh({0.001, -0.0005, 0.0007}, radius, false);
  tests::join(mesh, tests::ball_mesh({0.001, -0.0005, 0.0007}, 0.5 * radius, true));
  const Tomograph tomograph(mesh, {64, 64, 64}, Vec3{1, 1, 1} * (extent / 64), thin_per_m);
  const Detector& d = tomograph.detector();
  const Readings readings = tomograph.read();
  double worst = 0;
  for (std::size_t a = 0; a < d.views; a += 7) {
    const double angle = pi * static_cast<double>(a) / static_cast<double>(d.views);
    const double across = 0.001 * std::cos(angle) - 0.0005 * std::sin(angle);
    for (std::size_t k = 20; k < 44; ++k)
      for (std::size_t n = 0; n < d.bins; ++n) {
        const double u = (static_cast<double>(n) - d.middle()) * d.bin_m - across,
                     z = (static_cast<double>(k) - d.half_height()) * d.slice_m - 0.0007, off = u * u + z * z;
        if (std::abs(std::sqrt(off) - radius) < 4 * d.bin_m || std::abs(std::sqrt(off) - 0.5 * radius) < 4 * d.bin_m)
          continue;  // within a pixel the chord bends
        const auto chord = [&](double r) { return off < r * r ? 2 * std::sqrt(r * r - off) : 0; };
        worst = std::max(
            worst, std::abs(static_cast<double>(readings[d.line(k, a) + n]) - chord(radius) + chord(0.5 * radius)));
      }
  }
  EXPECT_LT(worst, 0.03 * radius);
}

TEST(LineIntegrals, OfListedBallsAreThoseOfTheirMeshes) {
  const Vec3 centre{0.002, 0.003, -0.001};
  const Tomograph tomograph(tests::ball_mesh(centre, 0.3 * radius, false), cells, cell, thin_per_m);
  const std::vector<Ball> balls{{centre, 0.3 * radius}};
  const std::vector<float> own = paths(balls, tomograph.detector());
  const Readings drawn = tomograph.read();
  double worst = 0;
  for (std::size_t i = 0; i < own.size(); ++i)
    worst = std::max(worst, std::abs(static_cast<double>(own[i]) - static_cast<double>(drawn[i])));
  EXPECT_LT(worst, 0.03 * radius);
}

// Back comes the slice itself; of p^2 = 4 (a^2 - u^2), by Abel's inversion, (8 / pi) sqrt(a^2 - r^2).
TEST(Tomograph, ReconstructsWhatAbelsInversionSays) {
  const Tomograph tomograph(tests::ball_mesh({}, radius, false), cells, cell, thin_per_m);
  EXPECT_NEAR(tomograph.longest_m() / (2 * radius), 1, 0.01);
  std::vector<Vec3> places;
  for (const double r : {0.0, 0.2, 0.4, 0.6, 0.8}) places.push_back(Vec3{0.6 * r, -0.8 * r, 0} * radius);
  const std::vector<double> itself = back(tomograph, tomograph.read(), places),
                            squares = back(tomograph, squared(tomograph.read()), places);
  for (std::size_t k = 0; k < places.size(); ++k) {
    EXPECT_NEAR(itself[k], 1, 0.01) << k;
    const double expected = 8 / pi * std::sqrt(radius * radius - dot(places[k], places[k]));
    EXPECT_NEAR(squares[k] / expected, 1, 0.03) << k;
  }
  EXPECT_NEAR(back(tomograph, tomograph.read(), {{1.3 * radius, 0, 0}})[0], 0, 0.01);
  EXPECT_NEAR(tomograph.mean_reading(tomograph.read(), places)[0] / (2 * radius), 1, 0.01);
}

// Of thin matter hardening takes the squares of line integrals: p - ln(1 + v p) / v = v p^2 / 2 + ...
TEST(Tomograph, HardeningOfThinMatterGoesWithSquares) {
  const Tomograph tomograph(tests::ball_mesh({}, radius, false), {48, 48, 48}, Vec3{1, 1, 1} * (extent / 48),
                            1e-3 / radius);
  const Readings lacks = tomograph.lack_by_hardening(), read = tomograph.read();
  for (std::size_t i = 0; i < read.size(); i += 11)
    EXPECT_NEAR(static_cast<double>(lacks[i]),
                static_cast<double>(read[i]) * static_cast<double>(read[i]) / tomograph.longest_m(),
                0.01 * tomograph.longest_m());
}

// Weak scatter is in proportion to its share, more of it less than that.
TEST(Tomograph, ScatterSaturates) {
  const Tomograph tomograph(tests::ball_mesh({}, radius, false), {48, 48, 48}, Vec3{1, 1, 1} * (extent / 48),
                            1 / radius);
  const std::vector<Vec3> places{{0, 0, 0}, {0.5 * radius, 0, 0}};
  std::vector<std::vector<double>> lost;
  for (const Readings& lacks : tomograph.lack_by_scatter(std::vector<double>{1e-4, 1e-3, 0.5}))
    lost.push_back(back(tomograph, lacks, places));
  for (std::size_t k = 0; k < places.size(); ++k) {
    EXPECT_GT(lost[0][k], 0);
    EXPECT_NEAR(lost[1][k] / lost[0][k], 1, 0.01);
    EXPECT_LT(lost[2][k], 0.95 * lost[0][k]);
  }
  EXPECT_GT(lost[0][0], lost[0][1]);  // deeper where paths are longer
}

// What stands beside the shape is in the line integrals as its own mesh would be, and hardening is the shape's alone.
TEST(Tomograph, MarkersStandBesideTheShape) {
  const mesh::Mesh ball = tests::ball_mesh({}, 0.6 * radius, false);
  const Vec3 centre{0.004, 0.0045, 0.001};
  const std::array<std::size_t, 3> size{48, 48, 48};
  const Vec3 spacing = Vec3{1, 1, 1} * (extent / 48);
  const std::vector<Ball> markers{{centre, 0.2 * radius, 1}};
  mesh::Mesh both = ball;
  tests::join(both, tests::ball_mesh(centre, 0.2 * radius, false));
  const double per_m = 1 / radius;
  const Tomograph beside(ball, size, spacing, per_m, markers), joined(both, size, spacing, per_m),
      alone(ball, size, spacing, per_m);
  const Readings a = beside.read(), b = joined.read();
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    worst = std::max(worst, std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i])));
  EXPECT_LT(worst, 0.02 * radius);
  EXPECT_EQ(beside.longest_m(), alone.longest_m());
  EXPECT_EQ(beside.lack_by_hardening(), alone.lack_by_hardening());
}

// A ball by itself throws no streaks, however its readings bend: all views see it alike. Beside another one it does,
// as the rays through both lack more than those through either.
TEST(Tomograph, StreaksComeOfWhatElseLiesInTheRay) {
  const std::array<std::size_t, 3> size{64, 64, 64};
  const Vec3 spacing = Vec3{1, 1, 1} * (extent / 64);
  const std::vector<Ball> marker{{{0.0072, 0, 0}, 0.15 * radius, 4}};
  const auto streaks = [&](Vec3 at) {  // behind and beside the marker as seen from the shape
    const Tomograph t(tests::ball_mesh(at, 0.5 * radius, false), size, spacing, 0.6 / radius, marker);
    double most = 0;
    for (const Readings& lacks : {t.lack_by_streak(), t.lack_by_floor(std::vector<double>{0.03})[0]})
      for (const double v : back(t, lacks, {{0.0045, 0, 0}, {0.0045, 0.0012, 0}, {0.0045, -0.0012, 0}}))
        most = std::max(most, std::abs(v));
    return most;
  };
  const double with = streaks({0.0005, 0, 0}), without = streaks({0.0005, 0, -0.0065});
  EXPECT_GT(with, 5 * without);
}

// Blurred intensities of thin matter are blurred line integrals, which keep their sum; of thick matter they read less,
// and of a spectrum still less.
TEST(Tomograph, BlurOfIntensitiesTakesFromThickMatter) {
  const mesh::Mesh ball = tests::ball_mesh({}, radius, false);
  const auto lacking = [&](double per_m, double variance) {
    const Tomograph tomograph(ball, {48, 48, 48}, Vec3{1, 1, 1} * (extent / 48), per_m);
    double sum = 0, all = 0;
    for (const float v : tomograph.lack_by_blur(1.5, variance)) sum += static_cast<double>(v);
    for (const float v : tomograph.read()) all += static_cast<double>(v);
    return sum / all;
  };
  EXPECT_NEAR(lacking(1e-2 / radius, 0), 0, 1e-3);
  const double thick = lacking(1 / radius, 0);
  EXPECT_GT(thick, 0.003);
  EXPECT_GT(lacking(1 / radius, 0.8), 1.2 * thick);
}

std::vector<Row> some_rows() {
  std::vector<Row> rows;
  for (const Reading reading : {Reading::wall, Reading::width, Reading::inside, Reading::outside}) {
    Row row;
    row.reading = reading;
    row.at_m = {0.003, -0.002, 0.004};
    row.normal = normalized(Vec3{0.5, 0.4, 0.3});
    row.hardening = 0.7, row.scatter = {0.4, 0.38, 0.3, 0.2}, row.ring = 1.2, row.markers = 0.1;
    row.floor = {0.3, 0.28, 0.2, 0.1};
    row.blur = {0.1, 0.2, 0.3, 0.4}, row.blur_of_spectrum = {0.01, 0.02, 0.03, 0.04};
    rows.push_back(row);
  }
  return rows;
}

TEST(VolumeTerms, VanishAtNeutralAndActBeyondIt) {
  Observed o;
  o.voxel_m = 1e-4, o.field_m = 0.01, o.half_height_m = 0.01;
  for (const Term* term : all_terms()) {
    const mechanism::Mechanism& m = term->mechanism();
    std::vector<double> neutral, some;
    for (const mechanism::Parameter& p : m.parameters) neutral.push_back(p.neutral), some.push_back(0.5 * p.upper);
    if (term->of_spectrum) neutral.push_back(0.5), some.push_back(0.5);
    int touched = 0;
    for (const Row& row : some_rows()) {
      EXPECT_EQ(term->act(0.625, row, o, neutral), 0.625) << m.id;
      touched += term->act(0.625, row, o, some) != 0.625;
    }
    EXPECT_GE(touched, 1) << m.id;
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

// At the spreads that were simulated the readings are those that were simulated.
TEST(VolumeTerms, BlurSaysWhatWasSimulated) {
  Observed o;
  const auto term = std::ranges::find_if(all_terms(), [](const Term* t) { return t->mechanism().id == "ct.blur"; });
  for (const Row& row : some_rows())
    for (std::size_t k = 0; k < blur_spreads.size(); ++k) {
      const double value = (*term)->act(0.6, row, o, std::vector<double>{blur_spreads[k], blur_variance});
      if (row.reading == Reading::width)
        EXPECT_NEAR(value, std::hypot(0.6, row.blur[k]), 1e-12);
      else
        EXPECT_NEAR(value, 0.6 - row.blur[k] - row.blur_of_spectrum[k], 1e-12);
    }
}

}  // namespace
}  // namespace gonio::explain::volumes
