#include "print/coverage.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/random.h"

namespace gonio::print {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;
struct Body {
  std::vector<Vec3> positions_m;
  Triangles triangles;
};

double volume(const Body& b) {
  double v = 0;
  for (const auto& t : b.triangles) v += dot(b.positions_m[t[0]], cross(b.positions_m[t[1]], b.positions_m[t[2]])) / 6;
  return v;
}

void append(Body& to, const Body& other) {
  const auto first = static_cast<std::uint32_t>(to.positions_m.size());
  to.positions_m.insert(to.positions_m.end(), other.positions_m.begin(), other.positions_m.end());
  for (const auto& t : other.triangles) to.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

Body box(Vec3 low, Vec3 high) {
  Body b;
  for (int k = 0; k < 8; ++k)
    b.positions_m.push_back({k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z});
  b.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                 {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return b;
}

// A closed body of revolution with bumps, star-shaped about `centre`; squeezed flat it is a sliver.
Body bumpy(Vec3 centre, Vec3 radii, Random& random) {
  constexpr std::uint32_t around = 14, down = 8;
  Body b;
  for (std::uint32_t j = 0; j <= down; ++j)
    for (std::uint32_t i = 0; i < around; ++i) {
      const double theta = 3.14159265358979 * j / down, phi = 2 * 3.14159265358979 * i / around;
      const double r = j == 0 || j == down ? 1 : 0.7 + 0.6 * random.uniform();
      b.positions_m.push_back(
          centre +
          Vec3{r * std::sin(theta) * std::cos(phi), r * std::sin(theta) * std::sin(phi), r * std::cos(theta)} * radii);
    }
  const auto at = [&](std::uint32_t j, std::uint32_t i) {
    return j == 0 ? 0 : j == down ? down * around : j * around + i % around;
  };
  for (std::uint32_t j = 0; j < down; ++j)
    for (std::uint32_t i = 0; i < around; ++i) {
      if (j > 0) b.triangles.push_back({at(j, i), at(j + 1, i), at(j, i + 1)});
      if (j + 1 < down) b.triangles.push_back({at(j, i + 1), at(j + 1, i), at(j + 1, i + 1)});
    }
  return b;
}

// Shares of the voxels of one pixel by 64 x 64 lines through it, each exact in depth: sums of s clamp(z).
std::vector<double> by_lines(const Body& b, const PixelGrid& grid, int x, int y, const std::vector<double>& tops_m) {
  constexpr int side = 64;
  const double x0 = grid.corner_m.x + x * grid.pixel_m.x, y0 = grid.corner_m.y + y * grid.pixel_m.y;
  std::vector<std::array<Vec3, 3>> near;
  for (const auto& t : b.triangles) {
    const std::array<Vec3, 3> q = {b.positions_m[t[0]], b.positions_m[t[1]], b.positions_m[t[2]]};
    const auto [xs, xe] = std::minmax({q[0].x, q[1].x, q[2].x});
    const auto [ys, ye] = std::minmax({q[0].y, q[1].y, q[2].y});
    if (xe >= x0 && xs <= x0 + grid.pixel_m.x && ye >= y0 && ys <= y0 + grid.pixel_m.y) near.push_back(q);
  }
  std::vector<double> share(tops_m.size() - 1);
  for (int k = 0; k < side * side; ++k) {
    const double px = x0 + (k % side + 0.5) / side * grid.pixel_m.x, py = y0 + (k / side + 0.5) / side * grid.pixel_m.y;
    for (const auto& q : near) {
      double area[3], sum = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const Vec3 &u = q[(c + 1) % 3], &v = q[(c + 2) % 3];
        sum += area[c] = (u.x - px) * (v.y - py) - (u.y - py) * (v.x - px);
      }
      const bool up = area[0] > 0 && area[1] > 0 && area[2] > 0, down = area[0] < 0 && area[1] < 0 && area[2] < 0;
      if (!up && !down) continue;
      const double z = (area[0] * q[0].z + area[1] * q[1].z + area[2] * q[2].z) / sum;
      for (std::size_t l = 0; l < share.size(); ++l)
        share[l] += (up ? 1 : -1) * (std::clamp(z, tops_m[l], tops_m[l + 1]) - tops_m[l]) /
                    (tops_m[l + 1] - tops_m[l]) / (side * side);
    }
  }
  return share;
}

const std::vector<double> tops_m = {0, 1e-5, 1.8e-5, 3.1e-5, 4e-5, 6e-5};  // of layers that vary

std::vector<std::vector<double>> shares_of(const Body& body, const PixelGrid& grid) {
  CoverageSweep sweep(body.positions_m, body.triangles, grid, tops_m[0]);
  std::vector<std::vector<double>> layers;
  for (std::size_t l = 1; l < tops_m.size(); ++l) {
    const LayerCoverage& layer = sweep.next(tops_m[l]);
    EXPECT_LT(layer.excess, 1e-9);
    layers.push_back(layer.share);
  }
  return layers;
}

// 60 random bodies, every second a sliver of a micrometre (of 200 none was off either): within 1/255 of lines through
// every pixel.
TEST(Coverage, AgreesWithLinesThroughEveryPixel) {
  Random random(3, 9);
  const PixelGrid grid{12, 10, {1.1e-5, 0.9e-5}, {-2e-6, 1e-6}};
  for (int world = 0; world < 60; ++world) {
    const Body body = bumpy({6e-5, 4.6e-5, 3e-5}, {4.2e-5, 3.1e-5, world % 2 == 1 ? 6e-7 : 2.2e-5}, random);
    const std::vector<std::vector<double>> layers = shares_of(body, grid);
    for (int y = 0; y < grid.height_px; ++y)
      for (int x = 0; x < grid.width_px; ++x) {
        const std::vector<double> expected = by_lines(body, grid, x, y, tops_m);
        for (std::size_t l = 0; l < layers.size(); ++l)
          ASSERT_NEAR(layers[l][static_cast<std::size_t>(y * grid.width_px + x)], expected[l], 1.0 / 255)
              << world << ": " << x << ' ' << y << " layer " << l;
      }
  }
}

double overlap(double a, double b, double low, double high) {
  return std::max(0.0, std::min(b, high) - std::max(a, low)) / (b - a);
}

// Two boxes that share a face, and a wall of half a pixel: a voxel's share is a product of three overlaps.
TEST(Coverage, BoxesAreExact) {
  Random random(6, 9);
  const PixelGrid grid{12, 10, {1.1e-5, 0.9e-5}, {-2e-6, 1e-6}};
  for (int world = 0; world < 50; ++world) {
    const Vec3 m{1e-5 * random.uniform(), 1e-5 * random.uniform(), 1e-5 * random.uniform()};
    const double middle = 5e-5 + m.x;
    const std::array<std::array<Vec3, 2>, 3> boxes{{{{{1e-5 + m.x, 1.2e-5 + m.y, m.z}, {middle, 7e-5, 4.3e-5}}},
                                                    {{{middle, 1.2e-5 + m.y, m.z}, {8.2e-5, 7e-5, 4.3e-5}}},
                                                    {{{9.3e-5 + m.x, 1.2e-5, 7e-6}, {9.8e-5 + m.x, 7.7e-5, 5.1e-5}}}}};
    Body body;
    for (const auto& [low, high] : boxes) append(body, box(low, high));
    const std::vector<std::vector<double>> layers = shares_of(body, grid);
    for (int p = 0; p < 120; ++p) {
      const double x = grid.corner_m.x + (p % 12) * grid.pixel_m.x, y = grid.corner_m.y + (p / 12) * grid.pixel_m.y;
      for (std::size_t l = 0; l < layers.size(); ++l) {
        double expected = 0;
        for (const auto& [low, high] : boxes)
          expected += overlap(x, x + grid.pixel_m.x, low.x, high.x) * overlap(y, y + grid.pixel_m.y, low.y, high.y) *
                      overlap(tops_m[l], tops_m[l + 1], low.z, high.z);
        ASSERT_NEAR(layers[l][static_cast<std::size_t>(p)], expected, 1e-11);
      }
    }
  }
}

TEST(Coverage, VolumeOfTheStackIsTheBodys) {
  Random random(4, 9);
  const PixelGrid grid{30, 25, {7.54e-6, 7.54e-6}, {-5e-5, -5e-5}};
  for (int world = 0; world < 20; ++world) {
    const Body body = bumpy({6e-5, 4.6e-5, 5e-5}, {7e-5, 6e-5, 4e-5}, random);
    CoverageSweep sweep(body.positions_m, body.triangles, grid, 0);
    double sum = 0;
    for (double top = 18e-6; top < 2e-4; top += 18e-6) {
      const LayerCoverage& layer = sweep.next(top);
      for (const double share : layer.share)
        sum += share * (layer.top_m - layer.bottom_m) * grid.pixel_m.x * grid.pixel_m.y;
    }
    EXPECT_NEAR(sum / volume(body), 1, 1e-9);
  }
}

// A box whose faces lie in layers' borders and pixels' edges: each face counts once.
TEST(Coverage, FacesOnBordersCountOnce) {
  const PixelGrid grid{4, 4, {1e-5, 1e-5}, {0, 0}};
  const Body body = box({1e-5, 1e-5, 1e-5}, {3e-5, 3e-5, 3e-5});
  CoverageSweep sweep(body.positions_m, body.triangles, grid, 0);
  for (int layer = 0; layer < 4; ++layer) {
    const LayerCoverage& l = sweep.next((layer + 1) * 1e-5);
    for (int p = 0; p < 16; ++p) {
      const bool within = layer > 0 && layer < 3 && p % 4 > 0 && p % 4 < 3 && p / 4 > 0 && p / 4 < 3;
      EXPECT_NEAR(l.share[static_cast<std::size_t>(p)], within ? 1 : 0, 1e-12) << layer << ' ' << p;
    }
  }
}

TEST(Coverage, WhatIsBelowTheFirstLayerIsBelow) {
  const PixelGrid grid{4, 4, {1e-5, 1e-5}, {0, 0}};
  const Body body = box({0.5e-5, 0.5e-5, -3e-5}, {3.5e-5, 3.5e-5, 1.5e-5});
  CoverageSweep sweep(body.positions_m, body.triangles, grid, 0);
  EXPECT_NEAR(sweep.next(1e-5).share[5], 1, 1e-12);
  EXPECT_NEAR(sweep.next(2e-5).share[5], 0.5, 1e-12);
}

TEST(Coverage, SurfacesThatFaceUpAreMeasured) {
  const PixelGrid grid{4, 4, {1e-5, 1e-5}, {0, 0}};
  const Body body = box({0.5e-5, 0.5e-5, 0.2e-5}, {3.5e-5, 3.5e-5, 1.5e-5});
  CoverageSweep sweep(body.positions_m, body.triangles, grid, 0);
  EXPECT_EQ(sweep.next(1e-5).up.area[5], 0);
  const LayerCoverage& l = sweep.next(2e-5);
  EXPECT_NEAR(l.up.area[5], 1, 1e-12);
  EXPECT_NEAR(l.up.area[0], 0.25, 1e-12);
}

TEST(Coverage, BodiesThatOverlapAreSaid) {
  const PixelGrid grid{4, 4, {1e-5, 1e-5}, {0, 0}};
  Body body = box({0, 0, 0}, {2e-5, 2e-5, 2e-5});
  append(body, box({1e-5, 0, 0}, {3e-5, 2e-5, 2e-5}));
  CoverageSweep sweep(body.positions_m, body.triangles, grid, 0);
  const LayerCoverage& l = sweep.next(1e-5);
  EXPECT_NEAR(l.excess, 1, 1e-12);
  EXPECT_EQ(l.share[1], 1);
}

TEST(Coverage, SameBytesForAnyNumberOfThreads) {
  Random random(5, 9);
  const PixelGrid grid{60, 50, {3e-6, 3e-6}, {-3e-5, -3e-5}};
  const Body body = bumpy({6e-5, 4.6e-5, 5e-5}, {7e-5, 6e-5, 4e-5}, random);
  std::vector<std::vector<double>> shares;
  for (const int threads : {1, 2, 5}) {
    set_threads(threads);
    CoverageSweep sweep(body.positions_m, body.triangles, grid, 0);
    std::vector<double>& all = shares.emplace_back();
    for (double top = 1e-5; top < 1e-4; top += 1e-5) {
      const LayerCoverage& layer = sweep.next(top);
      all.insert(all.end(), layer.share.begin(), layer.share.end());
    }
  }
  set_threads(0);
  EXPECT_EQ(shares[0], shares[1]);
  EXPECT_EQ(shares[0], shares[2]);
}

}  // namespace
}  // namespace gonio::print
