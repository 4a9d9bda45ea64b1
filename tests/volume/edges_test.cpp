// Walls of volumes by their edges: spheres, tubes and thin walls with noise and cupping, against what a global threshold
// makes of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "base/random.h"
#include "volume/crossings.h"
#include "volume/phantoms.h"
#include "volume/threshold.h"

namespace gonio::volume {
namespace {

// Beam hardening darkens what lies deep: 1 at the rim of radius `rim`, 1 - depth in the middle.
double cupped(double r, double rim, double depth) {
  const double x = std::min(1.0, r / rim);
  return 1 - depth * (1 - x * x);
}

// Vertices as a contour has them: off the wall by `off` voxels along the normal, some by chance.
void disturb(Contour& c, double off, double scatter, std::uint64_t seed) {
  Random random(seed);
  for (std::size_t v = 0; v < c.positions.size(); ++v) {
    const double t = off + scatter * random.normal();
    for (std::size_t a = 0; a < 3; ++a) c.positions[v][a] += static_cast<float>(t * c.normals[v][a]);
  }
}

struct Errors {
  double mean = 0, rms = 0, largest = 0;
};
template <class Distance>
Errors errors_of(const Contour& c, const Distance& outwards) {
  Errors e;
  for (const auto& p : c.positions) {
    const double d = outwards(Vec3{p[0], p[1], p[2]});
    e.mean += d, e.rms += d * d, e.largest = std::max(e.largest, std::abs(d));
  }
  const double n = static_cast<double>(c.positions.size());
  e.mean /= n;
  e.rms = std::sqrt(e.rms / n);
  return e;
}

TEST(Edges, BlurredSpheresWithNoiseHaveNoBias) {
  const Vec3 centre{19.3, 20.1, 19.8};
  for (const double radius : {7.0, 13.0}) {
    const auto source = phantom::in_memory(phantom::sampled(
        {40, 41, 42}, [&](Vec3 p) { return 1 + 10 * phantom::ball(p, centre, radius, 0.8); }, 0.5, 0.3, 5));
    Contour surface = phantom::sphere_surface(centre, radius);
    disturb(surface, -0.1, 0.05, 6);
    EdgeWish wish;
    wish.noise_correlation = 0.3;
    const auto found = edges(*source, surface, wish);
    const Refined r = move_to_steepest(surface, found);
    const Errors e = errors_of(surface, [&](Vec3 p) { return norm(p - centre) - radius; });
    std::printf("sphere %.0f: mean %+.4f rms %.4f largest %.3f sigma %.4f unfitted %zu held %zu\n", radius, e.mean, e.rms,
                e.largest, r.sigma_position, r.unfitted, r.held);
    EXPECT_LT(std::abs(e.mean), 0.02) << radius;
    EXPECT_LT(e.rms, 0.1) << radius;
    EXPECT_LT(r.unfitted, surface.positions.size() / 50);
    // The noise was not told: the edges' residuals give it.
    EXPECT_NEAR(r.sigma_position / e.rms, 1.2, 0.5);
  }
}

// A tube of glass whose wall no plateau fits into, cupped by a fifth from the rim inwards.
struct Tube {
  double inner, outer, depth;
  Vec3 centre{23.6, 24.2, 20}, axis = normalized({0.2, -0.1, 1});
  double rho(Vec3 p) const {
    const Vec3 d = p - centre;
    return norm(d - axis * dot(d, axis));
  }
};
io::VolumeData volume_of(const Tube& tube, double noise, std::uint64_t seed) {
  const phantom::Disc out(tube.outer, 0.8), in(tube.inner, 0.8);
  return phantom::sampled(
      {48, 48, 40},
      [&](Vec3 p) {
        const double rho = tube.rho(p);
        return 1 + 10 * cupped(rho, tube.outer, tube.depth) * (out.at(rho) - in.at(rho));
      },
      noise, 0.3, seed);
}

TEST(Edges, CuppingMovesTheWallsOfAThresholdAndNotTheseOnes) {
  // Thick-walled: the inner wall lies where the cup has taken a fifth.
  const Tube tube{6, 19, 0.25};
  const auto source = phantom::in_memory(volume_of(tube, 0.5, 9));
  const double threshold = 1 + 5;
  for (const bool inwards : {false, true}) {
    const double radius = inwards ? tube.inner : tube.outer;
    // Where a contour at the global threshold stands, for want of one: the value crosses it on the normal.
    Contour surface = phantom::tube_surface(tube.centre, tube.axis, radius, 24, inwards);
    const phantom::Disc disc(radius, 0.8);
    double off = 0;
    for (double x = -1.5; x < 1.5; x += 0.001) {
      const double rho = radius + x, v = 1 + 10 * cupped(rho, tube.outer, tube.depth) * (inwards ? 1 - disc.at(rho) : disc.at(rho));
      if ((v > threshold) != inwards) off = inwards ? -x : x;
    }
    disturb(surface, off, 0.03, 8);
    const auto outwards = [&](Vec3 p) { return (tube.rho(p) - radius) * (inwards ? -1 : 1); };
    const Errors before = errors_of(surface, outwards);
    EdgeWish wish;
    wish.noise = 0.5;
    wish.noise_correlation = 0.3;
    const auto found = edges(*source, surface, wish);
    Threshold used;
    used.value = threshold;
    const LocalThreshold local = local_threshold(used, found);
    const Refined r = move_to_steepest(surface, found);
    const Errors after = errors_of(surface, outwards);
    std::printf("%s wall: threshold mean %+.3f rms %.3f (foretold %+.3f), edges mean %+.4f rms %.4f held %zu\n",
                inwards ? "inner" : "outer", before.mean, before.rms, local.wall_bias, after.mean, after.rms, r.held);
    EXPECT_LT(std::abs(after.mean), 0.03);
    EXPECT_LT(after.rms, 0.1);
    if (inwards) {
      EXPECT_GT(std::abs(before.mean), 4 * std::abs(after.mean));
      EXPECT_NEAR(local.wall_bias, before.mean, 0.08);
    }
  }
}

TEST(Edges, WallsOfTwoAndAHalfVoxelsAreNotThinned) {
  const Tube tube{15, 17.5, 0.2};
  const auto source = phantom::in_memory(volume_of(tube, 0.5, 12));
  Contour surface = phantom::tube_surface(tube.centre, tube.axis, tube.outer, 24, false);
  disturb(surface, -0.05, 0.05, 3);
  Contour inner = phantom::tube_surface(tube.centre, tube.axis, tube.inner, 24, true);
  disturb(inner, -0.05, 0.05, 4);
  const std::size_t outside = surface.positions.size();
  phantom::append(surface, inner);
  EdgeWish wish;
  wish.noise_correlation = 0.3;
  const auto found = edges(*source, surface, wish);
  std::size_t thin = 0;
  for (const Edge& e : found) thin += e.inward < 4 ? 1 : 0;
  EXPECT_GT(thin, found.size() * 98 / 100);
  const Refined r = move_to_steepest(surface, found);
  for (const bool inwards : {false, true}) {
    Contour part;
    part.positions.assign(surface.positions.begin() + (inwards ? outside : 0),
                          inwards ? surface.positions.end() : surface.positions.begin() + outside);
    const Errors e = errors_of(part, [&](Vec3 p) { return (tube.rho(p) - (inwards ? tube.inner : tube.outer)) * (inwards ? -1 : 1); });
    std::printf("thin %s: mean %+.4f rms %.4f largest %.3f, sigma %.4f held %zu unfitted %zu\n", inwards ? "inner" : "outer",
                e.mean, e.rms, e.largest, r.sigma_position, r.held, r.unfitted);
    EXPECT_LT(std::abs(e.mean), 0.03);
    EXPECT_LT(e.rms, 0.1);
  }
}

TEST(Edges, UnequalSpacingsAreWalkedInLengths) {
  const Vec3 scale{1, 1, 2}, centre{20, 21, 19};
  const auto source = phantom::in_memory(phantom::sampled(
      {40, 42, 20}, [&](Vec3 p) { return phantom::ball(p, centre, 11, 1.2); }, 0.02, 0, 4, scale));
  Contour surface = phantom::sphere_surface(centre, 11, scale);
  EdgeWish wish;
  wish.scale = scale;
  const auto found = edges(*source, surface, wish);
  move_to_steepest(surface, found, 1.5, scale);
  const Errors e = errors_of(surface, [&](Vec3 p) { return norm(p * scale - centre) - 11; });
  std::printf("unequal: mean %+.4f rms %.4f\n", e.mean, e.rms);
  EXPECT_LT(std::abs(e.mean), 0.03);
  EXPECT_LT(e.rms, 0.1);
}

TEST(Edges, EveryFifthIsTheSameAsOfAll) {
  const Vec3 centre{12, 12, 12};
  const auto source = phantom::in_memory(
      phantom::sampled({25, 25, 25}, [&](Vec3 p) { return phantom::ball(p, centre, 7, 0.8); }, 0.02, 0, 2));
  const Contour surface = phantom::sphere_surface(centre, 7);
  EdgeWish wish;
  wish.noise = 0.02;
  wish.width = 0.9;
  const auto all = edges(*source, surface, wish), fifth = edges(*source, surface, wish, 5);
  ASSERT_EQ(fifth.size(), (all.size() + 4) / 5);
  for (std::size_t n = 0; n < fifth.size(); ++n) EXPECT_EQ(fifth[n].position, all[5 * n].position);
}

TEST(Edges, AnEmptySurfaceIsRefused) {
  const auto source = phantom::in_memory(phantom::sampled({4, 4, 4}, [](Vec3) { return 1.0; }));
  EXPECT_THROW(edges(*source, {}, {}), Error);
}

Edge good_edge(double position, double sigma) {
  Edge e;
  e.position = position, e.sigma = sigma, e.good = true, e.object = 1;
  return e;
}

TEST(MoveToSteepest, EdgesThatAreNotGoodTakeTheirNeighboursShift) {
  Contour surface = phantom::sphere_surface({20, 20, 20}, 9);
  std::vector<Edge> found(surface.positions.size(), good_edge(0.3, 0.02));
  for (std::size_t v = 0; v < found.size(); v += 7) found[v] = {};
  const Refined r = move_to_steepest(surface, found);
  EXPECT_EQ(r.unfitted, (found.size() + 6) / 7);
  EXPECT_EQ(r.held, 0u);
  const Errors e = errors_of(surface, [](Vec3 p) { return norm(p - Vec3{20, 20, 20}) - 9.3; });
  EXPECT_LT(e.largest, 0.01);
}

TEST(MoveToSteepest, NoVertexGoesFurtherThanItMayNorAWallThroughAnother) {
  Contour outer = phantom::sphere_surface({20, 20, 20}, 9);
  std::vector<Edge> found(outer.positions.size(), good_edge(-2, 0.02));
  Contour far = outer;
  EXPECT_NEAR(move_to_steepest(far, found).largest_shift, 1.5, 1e-6);
  for (Edge& e : found) e.inward = 2.4;
  Contour near = outer;
  EXPECT_NEAR(move_to_steepest(near, found).largest_shift, 0.8, 1e-6);
}

// Shifts drawn at random by more than the vertices are apart: whatever is asked, nothing folds and nothing crosses.
TEST(MoveToSteepest, NothingFoldsOrCrosses) {
  Random random(4);
  for (const double size : {0.2, 0.7, 2.0}) {
    Contour surface = phantom::sphere_surface({20, 20, 20}, 6);
    phantom::append(surface, phantom::sphere_surface({20, 20, 33.5}, 6));  // nearly touching
    std::vector<Edge> found;
    for (std::size_t v = 0; v < surface.positions.size(); ++v) found.push_back(good_edge(size * random.normal(), 0.001));
    const Refined r = move_to_steepest(surface, found);
    std::vector<Vec3> places;
    for (const auto& p : surface.positions) places.push_back({p[0], p[1], p[2]});
    EXPECT_TRUE(crossing_triangles(places, surface.triangles, std::vector<bool>(places.size(), true)).empty()) << size;
    EXPECT_GT(r.rms_shift, 0.05);
  }
}

TEST(Crossings, AreSeenWhereTheyAreAndNowhereElse) {
  const std::vector<Vec3> places{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, -1}, {1, 1, 1}, {3, 3, 1}, {1, 1, 0.5}};
  const std::vector<bool> all(places.size(), true);
  EXPECT_EQ(crossing_triangles(places, {{0, 1, 2}, {3, 4, 5}}, all).size(), 1u);
  EXPECT_TRUE(crossing_triangles(places, {{0, 1, 2}, {6, 4, 5}}, all).empty());
  EXPECT_TRUE(crossing_triangles(places, {{0, 1, 2}, {3, 4, 5}}, std::vector<bool>(places.size())).empty());
  // Folded back upon the edge that they share.
  const std::vector<Vec3> flat{{0, 0, 0}, {2, 0, 0}, {1, 1, 0}, {1, 0.5, 0}, {1, -1, 0}};
  EXPECT_EQ(crossing_triangles(flat, {{0, 1, 2}, {1, 0, 3}}, std::vector<bool>(5, true)).size(), 1u);
  EXPECT_TRUE(crossing_triangles(flat, {{0, 1, 2}, {1, 0, 4}}, std::vector<bool>(5, true)).empty());
}

}  // namespace
}  // namespace gonio::volume
