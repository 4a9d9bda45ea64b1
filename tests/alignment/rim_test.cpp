// Rims of overlapping pieces, their moments, and the share of pixels that they bound.
#include "alignment/rim.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "alignment/coverage.h"
#include "alignment/shape.h"

namespace gonio::alignment {
namespace {

// Round a polygon with its inside to the left: in axes right and down that is clockwise for whoever looks.
void add(std::vector<Segment>& to, const std::vector<Vec2>& corners) {
  for (std::size_t i = 0; i < corners.size(); ++i) to.push_back({corners[i], corners[(i + 1) % corners.size()], 1});
}
std::vector<Vec2> square(double x, double y, double side) {
  return {{x, y}, {x + side, y}, {x + side, y + side}, {x, y + side}};
}
double area(const std::vector<RimPiece>& rim) {
  return moments_of(rim, {3, -2}).m00;
}

TEST(Rim, OfTwoSquaresThatOverlapIsThatOfTheirUnion) {
  std::vector<Segment> s;
  add(s, square(0, 0, 2)), add(s, square(1.25, 1.125, 2));
  const auto rim = rim_of(s);
  EXPECT_NEAR(area(rim), 8 - 0.75 * 0.875, 1e-12);
  double length = 0;
  for (const RimPiece& p : rim) length += norm(p.to - p.from);
  EXPECT_NEAR(length, 16 - 2 * (0.75 + 0.875), 1e-12);
}

TEST(Rim, GoesRoundHolesTheOtherWay) {
  std::vector<Segment> s;  // a frame of four bars
  add(s, {{0, 0}, {10, 0}, {10, 1}, {0, 1}}), add(s, {{0, 9}, {10, 9}, {10, 10}, {0, 10}});
  add(s, {{0, 0.5}, {1, 0.5}, {1, 9.5}, {0, 9.5}}), add(s, {{9, 0.5}, {10, 0.5}, {10, 9.5}, {9, 9.5}});
  EXPECT_NEAR(area(rim_of(s)), 100 - 64, 1e-9);
}

TEST(Rim, NothingIsLeftWhereMoreCoversIt) {
  std::vector<Segment> s;
  add(s, square(0, 0, 10)), add(s, square(3, 3, 2));
  EXPECT_NEAR(area(rim_of(s)), 100, 1e-12);
  EXPECT_TRUE(rim_of({}).empty());
}

TEST(Rim, OfManyTrianglesCoversWhatASieveOfPointsSays) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> place(0, 20), off(-3, 3);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<Segment> s;
    std::vector<std::array<Vec2, 3>> triangles;
    for (int i = 0; i < 40; ++i) {
      const Vec2 c{place(random), place(random)};
      std::array<Vec2, 3> t{c + Vec2{off(random), off(random)}, c + Vec2{off(random), off(random)},
                            c + Vec2{off(random), off(random)}};
      const Vec2 u = t[1] - t[0], v = t[2] - t[0];
      if (u.x * v.y - u.y * v.x < 0) std::swap(t[1], t[2]);
      triangles.push_back(t), add(s, {t[0], t[1], t[2]});
    }
    std::size_t inside = 0;
    constexpr int grid = 600;
    for (int y = 0; y < grid; ++y)
      for (int x = 0; x < grid; ++x) {
        const Vec2 p{-4 + 28 * (x + 0.5) / grid, -4 + 28 * (y + 0.5) / grid};
        for (const auto& t : triangles) {
          bool in = true;
          for (std::size_t k = 0; k < 3 && in; ++k) {
            const Vec2 a = t[k], b = t[(k + 1) % 3];
            in = (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) >= 0;
          }
          if (in) {
            ++inside;
            break;
          }
        }
      }
    EXPECT_NEAR(area(rim_of(s)), inside * (28.0 / grid) * (28.0 / grid), 0.25) << trial;
  }
}

TEST(Moments, OfASquareAreThoseOfTheIntegral) {
  std::vector<Segment> s;
  add(s, {{1, 2}, {4, 2}, {4, 7}, {1, 7}});
  const Moments m = moments_of(rim_of(s), {0, 0});
  const auto power = [](double a, double b, int n) { return (std::pow(b, n + 1) - std::pow(a, n + 1)) / (n + 1); };
  EXPECT_NEAR(m.m00, 15, 1e-12);
  EXPECT_NEAR(m.m10, power(1, 4, 1) * 5, 1e-9);
  EXPECT_NEAR(m.m11, power(1, 4, 1) * power(2, 7, 1), 1e-9);
  EXPECT_NEAR(m.m20, power(1, 4, 2) * 5, 1e-9);
  EXPECT_NEAR(m.m30, power(1, 4, 3) * 5, 1e-9);
  EXPECT_NEAR(m.m21, power(1, 4, 2) * power(2, 7, 1), 1e-9);
  EXPECT_NEAR(m.m12, power(1, 4, 1) * power(2, 7, 2), 1e-9);
  EXPECT_NEAR(m.m03, 3 * power(2, 7, 3), 1e-9);
}

TEST(Coverage, SumsToTheAreaAndIsExactInEveryPixel) {
  std::vector<Side> sides;
  std::vector<Vec2> corners;
  for (int k = 0; k < 7; ++k)
    corners.push_back({20 + (9 + k % 3) * std::cos(0.9 * k), 21.3 + (9 + k % 2) * std::sin(0.9 * k)});
  double whole = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec2 a = corners[i], b = corners[(i + 1) % corners.size()];
    sides.push_back({a, b}), whole += 0.5 * (a.x * b.y - a.y * b.x);
  }
  const auto share = coverage_of(sides, 40, 44);
  double sum = 0;
  for (const float v : share) sum += v;
  EXPECT_NEAR(sum, whole, 1e-3);
  constexpr int fine = 64;
  for (int y = 8; y < 36; y += 3)
    for (int x = 8; x < 34; ++x) {
      int inside = 0;
      for (int k = 0; k < fine * fine; ++k) {
        const double u = x - 0.5 + (k % fine + 0.5) / fine, v = y - 0.5 + (k / fine + 0.5) / fine;
        int winding = 0;
        for (const Side& s : sides)
          if ((s.from.y > v) != (s.to.y > v) &&
              s.from.x + (v - s.from.y) / (s.to.y - s.from.y) * (s.to.x - s.from.x) < u)
            winding += s.to.y < s.from.y ? 1 : -1;
        inside += winding > 0;
      }
      EXPECT_NEAR(share[static_cast<std::size_t>(y) * 40 + x], static_cast<double>(inside) / (fine * fine), 0.02)
          << x << " " << y;
    }
}

TEST(Coverage, BeyondThePictureNothingIsLost) {
  const std::vector<Vec2> c{{-5, -5}, {60, -5}, {60, 60}, {-5, 60}};
  std::vector<Side> sides;
  for (std::size_t i = 0; i < 4; ++i) sides.push_back({c[i], c[(i + 1) % 4]});
  for (const float v : coverage_of(sides, 20, 10)) EXPECT_FLOAT_EQ(v, 1);
}

// A tube whose vertices are repeated along a seam, as files do whose texture begins anew there.
TEST(Rim, DoesNotRunAlongSeamsOfTextures) {
  constexpr std::uint32_t around = 12;
  std::vector<Vec3> closed, cut;
  std::vector<std::array<std::uint32_t, 3>> triangles, of_cut;
  for (std::uint32_t i = 0; i <= around; ++i)
    for (const double z : {0.0, 1.0}) {
      const double turn = 6.283185307179586 * (i % around) / around;
      cut.push_back({std::cos(turn), std::sin(turn), z});
      if (i < around) closed.push_back(cut.back());
    }
  for (std::uint32_t i = 0; i < around; ++i) {
    const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % around), c = 2 * (i + 1);
    triangles.push_back({a, b, a + 1}), triangles.push_back({a + 1, b, b + 1});
    of_cut.push_back({a, c, a + 1}), of_cut.push_back({a + 1, c, c + 1});
  }
  const Shape whole(closed, triangles), sewn(cut, of_cut);
  EXPECT_EQ(whole.open_edges(), 24u);
  EXPECT_EQ(sewn.open_edges(), 24u);
  std::vector<std::uint8_t> faces;
  std::vector<RimEdge> one, other;
  for (const Vec3 eye : {Vec3{4, 1, 2}, Vec3{5, -0.1, 0.3}, Vec3{-3, 2, 5}}) {
    whole.rim_edges(eye, false, faces, one);
    sewn.rim_edges(eye, false, faces, other);
    EXPECT_EQ(one.size(), other.size());
  }
}

}  // namespace
}  // namespace gonio::alignment
