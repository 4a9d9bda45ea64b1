// Surfaces of random volumes: closed, 2-manifold, oriented, free of self-intersections, and of the topology that the
// voxels have, counted without any surface (euler.cpp). GONIO_VOLUMES=1000 takes that many volumes of labels, and a
// fifth of it of smooth fields.
#include "volume/contour.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "base/error.h"
#include "base/parallel.h"
#include "volume/cell_cases.h"
#include "volume/surfaces.h"
#include "volume/topology.h"

namespace gonio::volume {
namespace {

using tests::MemoryVolume;

constexpr std::array both{Connectivity::six, Connectivity::twenty_six};

std::uint64_t volumes() {
  const char* given = std::getenv("GONIO_VOLUMES");
  return given != nullptr ? std::strtoull(given, nullptr, 10) : 60;
}

void expect_sound(MemoryVolume& volume, const ContourWish& wish, const std::string& what) {
  const Contour surface = contour(volume, wish);
  const tests::Soundness found = tests::soundness(surface.positions, surface.triangles);
  ASSERT_TRUE(found.sound()) << what << ": " << found.text();
  ASSERT_EQ(found.euler, 2 * euler_number(volume, wish.threshold, wish.inside)) << what;
  ASSERT_FALSE(tests::intersects_itself(surface.positions, surface.triangles)) << what;
  ASSERT_GE(tests::enclosed_volume(surface), 0) << what;
}

TEST(Contour, OfRandomLabelsIsSound) {
  for (std::uint64_t seed = 0; seed < volumes(); ++seed)
    for (const Connectivity inside : both) {
      MemoryVolume volume = tests::random_labels(seed);
      expect_sound(volume, {0.5, inside, seed % 2 == 0}, "labels " + std::to_string(seed));
    }
}

TEST(Contour, OfRandomFieldsIsSound) {
  for (std::uint64_t seed = 0; seed < volumes() / 5; ++seed)
    for (const Connectivity inside : both) {
      MemoryVolume volume = tests::random_field(seed);
      expect_sound(volume, {0, inside, true}, "field " + std::to_string(seed));
    }
}

MemoryVolume random_magnitudes(std::uint64_t seed) {
  MemoryVolume volume = tests::random_labels(seed);
  Random random(seed, 3);
  for (float& value : volume.values())
    value = static_cast<float>((value - 0.5) * std::pow(10.0, random.uniform(-6, 6)));
  return volume;
}

// Samples from next to the threshold to far from it: crossings at the very ends of edges, normals of any direction.
TEST(Contour, OfSamplesOfAnyMagnitudeIsSound) {
  for (std::uint64_t seed = 0; seed < volumes() / 2; ++seed)
    for (const Connectivity inside : both) {
      MemoryVolume volume = random_magnitudes(seed);
      expect_sound(volume, {0, inside, true, seed % 3 == 0 ? 1e-6 : 0.1}, "magnitudes " + std::to_string(seed));
    }
}

// Where single precision is coarsest.
TEST(Contour, FarFromTheOriginIsSound) {
  for (const std::array<std::size_t, 3> size : {std::array<std::size_t, 3>{8190, 3, 3}, {3, 8190, 3}, {3, 3, 8190}}) {
    Random random(5, size[0]);
    MemoryVolume volume(size, [&](double i, double j, double k) {
      return i + j + k < 7800 ? -1 : (random.uniform() - 0.5) * std::pow(10.0, random.uniform(-6, 0));
    });
    for (const Connectivity inside : both) expect_sound(volume, {0, inside, true, 1e-6}, "far");
  }
}

// Every cell within every neighbouring one: all samples of two cells that share a face, the rest of the volume outside.
TEST(Contour, OfAllPairsOfNeighbouringCellsIsSound) {
  for (unsigned samples = 0; samples < 4096; ++samples) {
    std::array<std::size_t, 3> size{2, 2, 2};
    size[samples % 3] = 3;
    std::vector<float> values(12);
    for (unsigned n = 0; n < 12; ++n) values[n] = static_cast<float>(samples >> n & 1);
    MemoryVolume volume(size, values);
    const Connectivity inside = samples / 2 % 2 == 0 ? Connectivity::six : Connectivity::twenty_six;
    expect_sound(volume, {0.5, inside, samples % 2 == 0}, "pair " + std::to_string(samples));
    if (HasFatalFailure()) return;
  }
}

TEST(Contour, DoesNotDependOnThreads) {
  MemoryVolume volume = tests::random_field(3);
  set_threads(1);
  const Contour one = contour(volume, {});
  set_threads(3);
  const Contour three = contour(volume, {});
  set_threads(0);
  EXPECT_EQ(one.positions, three.positions);
  EXPECT_EQ(one.normals, three.normals);
  EXPECT_EQ(one.triangles, three.triangles);
}

TEST(Contour, WhatTheBorderCutsIsClosedHalfAVoxelBeyondIt) {
  MemoryVolume volume({4, 5, 6}, [](double, double, double) { return 7; });
  const Contour surface = contour(volume, {3});
  EXPECT_EQ(tests::soundness(surface.positions, surface.triangles).euler, 2);
  EXPECT_NEAR(tests::enclosed_volume(surface), 4 * 5 * 6, 1e-3);  // edges and corners are sharp
  for (const auto& p : surface.positions)
    EXPECT_TRUE(p[0] == -0.5f || p[0] == 3.5f || p[1] == -0.5f || p[1] == 4.5f || p[2] == -0.5f || p[2] == 5.5f);
}

TEST(Contour, AValueThatEqualsTheThresholdIsOutside) {
  MemoryVolume volume({3, 3, 3}, [](double i, double j, double k) { return i == 1 && j == 1 && k == 1 ? 2 : 1; });
  EXPECT_EQ(contour(volume, {1}).triangles.size(), 12u);  // a cube of eight cells
  EXPECT_TRUE(contour(volume, {2}).triangles.empty());
  EXPECT_EQ(contour(volume, {0.999}).crossed_edges, 54u);  // all of it is inside: six sides of nine
  MemoryVolume thirds({3, 3, 3}, [](double, double, double) { return 1.0 / 3; });
  // The float next to 1/3 is above it: the comparison is that of doubles.
  EXPECT_FALSE(contour(thirds, {1.0 / 3}).triangles.empty());
}

TEST(Contour, EmptyAndOversizedVolumes) {
  MemoryVolume empty({0, 3, 3}, std::vector<float>{});
  EXPECT_TRUE(contour(empty, {}).positions.empty());
  MemoryVolume oversized({8191, 1, 1}, std::vector<float>(8191, 0));
  EXPECT_THROW(contour(oversized, {}), Error);
}

// Fails at one slice, as a truncated file does.
class Truncated : public MemoryVolume {
 public:
  using MemoryVolume::MemoryVolume;
  void read(std::size_t first, std::size_t count, std::span<float> to) override {
    if (first + count > 20) throw Error(Exit::data, "memory", "ends after 20 slices");
    MemoryVolume::read(first, count, to);
  }
};

TEST(Contour, WhatCannotBeReadOrHeldIsRefused) {
  const auto value = [](double i, double j, double k) { return norm(Vec3{i, j, k} - Vec3{5, 5, 15}) < 4 ? 1 : 0; };
  Truncated truncated({10, 10, 30}, value);
  EXPECT_THROW(contour(truncated, {0.5}), Error);
  MemoryVolume whole({10, 10, 30}, value);
  const std::size_t vertices = contour(whole, {0.5}).positions.size();
  ContourWish wish{0.5};
  wish.most_vertices = static_cast<std::uint32_t>(vertices);
  EXPECT_EQ(contour(whole, wish).positions.size(), vertices);
  --wish.most_vertices;
  EXPECT_THROW(contour(whole, wish), Error);
}

// What everybody would write first: a vertex a cell at the mean of its crossings, two triangles an edge.
class Naive {
 public:
  using Sample = std::array<std::int64_t, 3>;
  Naive(MemoryVolume& volume, double threshold)
      : volume_(volume),
        size_(volume.head().size),
        threshold_(threshold),
        vertex_((size_[0] + 1) * (size_[1] + 1) * (size_[2] + 1), -1) {}

  Contour made() {
    for (std::int64_t k = -1; k <= static_cast<std::int64_t>(size_[2]); ++k)
      for (std::int64_t j = -1; j <= static_cast<std::int64_t>(size_[1]); ++j)
        for (std::int64_t i = -1; i <= static_cast<std::int64_t>(size_[0]); ++i)
          for (unsigned axis = 0; axis < 3; ++axis) add_quad({i, j, k}, axis);
    return made_;
  }

 private:
  double value(const Sample& p) const {
    for (unsigned a = 0; a < 3; ++a)
      if (p[a] < 0 || p[a] >= static_cast<std::int64_t>(size_[a])) return threshold_ - 1;
    return volume_.at(p[0], p[1], p[2]);
  }
  bool above(const Sample& p) const { return value(p) > threshold_; }

  std::uint32_t vertex_of(const Sample& lowest) {
    std::int64_t& at = vertex_[((lowest[2] + 1) * (size_[1] + 1) + lowest[1] + 1) * (size_[0] + 1) + lowest[0] + 1];
    if (at >= 0) return static_cast<std::uint32_t>(at);
    std::array<double, 3> sum{};
    double count = 0;
    for (int edge = 0; edge < 12; ++edge) {
      const int low = lower_corner(edge);
      const Sample p{lowest[0] + (low & 1), lowest[1] + (low >> 1 & 1), lowest[2] + (low >> 2)};
      Sample q = p;
      ++q[edge / 4];
      if (above(p) == above(q)) continue;
      for (unsigned a = 0; a < 3; ++a) sum[a] += static_cast<double>(p[a]);
      sum[edge / 4] += (threshold_ - value(p)) / (value(q) - value(p));
      ++count;
    }
    at = static_cast<std::int64_t>(made_.positions.size());
    made_.positions.push_back(
        {static_cast<float>(sum[0] / count), static_cast<float>(sum[1] / count), static_cast<float>(sum[2] / count)});
    return static_cast<std::uint32_t>(at);
  }

  void add_quad(const Sample& p, unsigned axis) {
    Sample q = p;
    ++q[axis];
    if (above(p) == above(q)) return;
    std::array<std::uint32_t, 4> ring{};
    for (unsigned n = 0; n < 4; ++n) {
      Sample at = p;
      if (n == 0 || n == 3) --at[(axis + 1) % 3];
      if (n < 2) --at[(axis + 2) % 3];
      ring[n] = vertex_of(at);
    }
    if (!above(p)) std::swap(ring[1], ring[3]);
    made_.triangles.push_back({ring[0], ring[1], ring[2]});
    made_.triangles.push_back({ring[0], ring[2], ring[3]});
  }

  MemoryVolume& volume_;
  std::array<std::size_t, 3> size_;
  double threshold_;
  std::vector<std::int64_t> vertex_;
  Contour made_;
};

// The tests above can fail: the same volumes, the naive surface.
TEST(Contour, ANaiveSurfaceIsCaught) {
  std::size_t unsound = 0, intersecting = 0, wrong = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    MemoryVolume volume = random_magnitudes(seed);
    const Contour surface = Naive(volume, 0).made();
    const tests::Soundness found = tests::soundness(surface.positions, surface.triangles);
    unsound += !found.sound();
    intersecting += tests::intersects_itself(surface.positions, surface.triangles);
    wrong += found.euler != 2 * euler_number(volume, 0, Connectivity::twenty_six);
  }
  EXPECT_GE(unsound, 18u);
  EXPECT_GE(intersecting, 3u);
  EXPECT_GE(wrong, 18u);
}

TEST(Contour, AVertexThatWasMovedIsCaught) {
  MemoryVolume volume({12, 12, 12}, [](double i, double j, double k) {
    return 4.3 - norm(Vec3{i, j, k} - Vec3{5.4, 5.6, 5.5});
  });
  Contour surface = contour(volume, {});
  ASSERT_FALSE(tests::intersects_itself(surface.positions, surface.triangles));
  surface.positions[3] = {5.5f, 5.5f, 12.0f};  // from the bottom out through the top
  EXPECT_TRUE(tests::intersects_itself(surface.positions, surface.triangles));
}

}  // namespace
}  // namespace gonio::volume
