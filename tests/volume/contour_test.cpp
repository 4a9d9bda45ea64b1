// Surfaces of random volumes: closed, 2-manifold, oriented, free of self-intersections, and of the topology that the
// voxels have, counted without any surface (euler.cpp).
#include "volume/contour.h"

#include <gtest/gtest.h>

#include "volume/surfaces.h"
#include "volume/topology.h"

namespace gonio::volume {
namespace {

using tests::MemoryVolume;

void expect_sound(MemoryVolume& volume, const ContourWish& wish, const std::string& what) {
  const Contour surface = contour(volume, wish);
  const tests::Soundness found = tests::soundness(surface.positions, surface.triangles);
  EXPECT_TRUE(found.sound()) << what << ": " << found.text();
  EXPECT_EQ(found.euler, 2 * euler_number(volume, wish.threshold, wish.inside)) << what;
  EXPECT_FALSE(tests::intersects_itself(surface.positions, surface.triangles)) << what;
  EXPECT_GE(tests::enclosed_volume(surface), 0) << what;
}

TEST(Contour, OfRandomLabelsIsSound) {
  for (std::uint64_t seed = 0; seed < 50; ++seed)
    for (const Connectivity inside : {Connectivity::six, Connectivity::twenty_six}) {
      MemoryVolume volume = tests::random_labels(seed);
      expect_sound(volume, {0.5, inside, seed % 2 == 0}, "labels " + std::to_string(seed));
    }
}

TEST(Contour, OfRandomFieldsIsSound) {
  for (std::uint64_t seed = 0; seed < 24; ++seed)
    for (const Connectivity inside : {Connectivity::six, Connectivity::twenty_six}) {
      MemoryVolume volume = tests::random_field(seed);
      expect_sound(volume, {0, inside, true}, "field " + std::to_string(seed));
    }
}

}  // namespace
}  // namespace gonio::volume
