// Slabs: every slice seen once, with its neighbours; each read once, in order.
#include "volume/slabs.h"

#include <gtest/gtest.h>

#include "volume/surfaces.h"

namespace gonio::volume {
namespace {

// Counts what is read.
class Watched : public tests::MemoryVolume {
 public:
  using MemoryVolume::MemoryVolume;
  void read(std::size_t first, std::size_t count, std::span<float> to) override {
    EXPECT_EQ(first, next);
    next = first + count;
    MemoryVolume::read(first, count, to);
  }
  std::size_t next = 0;
};

TEST(Slabs, ShowEverySliceWithItsNeighbours) {
  for (const std::size_t depth : {1u, 2u, 5u, 8u, 9u, 17u})
    for (const std::size_t count : {1u, 3u, 8u, 32u})
      for (const std::size_t margin : {0u, 1u, 2u, 5u}) {
        Watched volume({3, 2, depth}, [](double i, double j, double k) { return 100 * k + 10 * j + i; });
        std::size_t seen = 0;
        for_each_slab(volume, {count, margin, -7}, [&](const Slab& slab) {
          EXPECT_EQ(slab.first, seen);
          seen += slab.count;
          ASSERT_EQ(slab.values.size(), (slab.count + 2 * margin) * 6);
          const auto first = static_cast<std::ptrdiff_t>(slab.first), m = static_cast<std::ptrdiff_t>(margin);
          for (std::ptrdiff_t k = first - m; k < first + static_cast<std::ptrdiff_t>(slab.count) + m; ++k) {
            const bool there = k >= 0 && k < static_cast<std::ptrdiff_t>(depth);
            EXPECT_EQ(slab.slice(k)[4], there ? 100 * k + 11 : -7)
                << depth << " " << count << " " << margin << " " << k;
          }
        });
        EXPECT_EQ(seen, depth);
        EXPECT_EQ(volume.next, depth);
      }
}

}  // namespace
}  // namespace gonio::volume
