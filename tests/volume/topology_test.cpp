// Components, cavities and Euler numbers of voxels, beside flood fills written for the test.
#include "volume/topology.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "volume/surfaces.h"

namespace gonio::volume {
namespace {

using tests::MemoryVolume;
constexpr std::array both{Connectivity::six, Connectivity::twenty_six};

// Labels of the voxels that `in` takes, by flood fill; 0 elsewhere.
std::vector<int> flooded(const std::array<std::size_t, 3>& size, const std::vector<bool>& in, bool diagonally) {
  std::vector<int> label(in.size(), 0);
  int last = 0;
  for (std::size_t start = 0; start < in.size(); ++start) {
    if (!in[start] || label[start] != 0) continue;
    label[start] = ++last;
    std::vector<std::size_t> open{start};
    while (!open.empty()) {
      const std::size_t at = open.back();
      open.pop_back();
      const std::array<int, 3> p{static_cast<int>(at % size[0]), static_cast<int>(at / size[0] % size[1]),
                                 static_cast<int>(at / size[0] / size[1])};
      for (int d = 0; d < 27; ++d) {
        const std::array<int, 3> step{d % 3 - 1, d / 3 % 3 - 1, d / 9 - 1};
        if (!diagonally && std::abs(step[0]) + std::abs(step[1]) + std::abs(step[2]) != 1) continue;
        std::array<int, 3> q{};
        bool within = true;
        for (unsigned a = 0; a < 3; ++a) {
          q[a] = p[a] + step[a];
          within = within && q[a] >= 0 && q[a] < static_cast<int>(size[a]);
        }
        if (!within) continue;
        const std::size_t next = (q[2] * size[1] + q[1]) * size[0] + q[0];
        if (!in[next] || label[next] != 0) continue;
        label[next] = last;
        open.push_back(next);
      }
    }
  }
  return label;
}

struct Cut {
  std::array<std::size_t, 3> size{};
  std::vector<bool> inside;
  bool border(std::size_t at) const {
    const std::array<std::size_t, 3> p{at % size[0], at / size[0] % size[1], at / size[0] / size[1]};
    for (unsigned a = 0; a < 3; ++a)
      if (p[a] == 0 || p[a] + 1 == size[a]) return true;
    return false;
  }
};
Cut cut(const MemoryVolume& volume) {
  Cut made{volume.head().size, {}};
  for (std::size_t k = 0; k < made.size[2]; ++k)
    for (std::size_t j = 0; j < made.size[1]; ++j)
      for (std::size_t i = 0; i < made.size[0]; ++i) made.inside.push_back(volume.at(i, j, k) > 0.5);
  return made;
}

// Enclosed: with the component itself taken for outside, no outside that reaches the border is connected with it.
bool enclosed_by_flood(const Cut& voxels, const std::vector<int>& label, int component, bool diagonally) {
  std::vector<bool> free(label.size());
  for (std::size_t n = 0; n < label.size(); ++n) free[n] = !voxels.inside[n] || label[n] == component;
  const std::vector<int> round = flooded(voxels.size, free, diagonally);
  std::set<int> reaching;
  for (std::size_t n = 0; n < label.size(); ++n)
    if (free[n] && voxels.border(n)) reaching.insert(round[n]);
  for (std::size_t n = 0; n < label.size(); ++n)
    if (label[n] == component && reaching.count(round[n]) != 0) return false;
  return true;
}

TEST(Topology, ComponentsAreThoseOfAFloodFill) {
  for (std::uint64_t seed = 0; seed < 60; ++seed)
    for (const Connectivity inside : both) {
      MemoryVolume volume = tests::random_labels(seed);
      const bool diagonally = inside == Connectivity::twenty_six;
      const Components found = components(volume, 0.5, inside);
      const Cut voxels = cut(volume);
      const std::vector<int> label = flooded(voxels.size, voxels.inside, diagonally);
      std::map<int, std::uint32_t> id;
      std::map<std::uint32_t, std::uint64_t> count;
      for (std::size_t n = 0; n < label.size(); ++n) {
        const std::uint32_t at =
            found.at(n % voxels.size[0], n / voxels.size[0] % voxels.size[1], n / voxels.size[0] / voxels.size[1]);
        ASSERT_EQ(at != 0, label[n] != 0) << seed;
        if (at == 0) continue;
        ASSERT_EQ(id.emplace(label[n], at).first->second, at) << seed;
        ++count[at];
      }
      ASSERT_EQ(id.size(), found.list.size()) << seed;
      for (const auto& [flood, own] : id) {
        const Component& one = found.list[own - 1];
        ASSERT_EQ(one.id, own);
        ASSERT_EQ(one.voxels, count[own]) << seed;
        ASSERT_EQ(one.enclosed, enclosed_by_flood(voxels, label, flood, !diagonally)) << seed << " component " << own;
      }
      for (std::size_t n = 1; n < found.list.size(); ++n) EXPECT_GE(found.list[n - 1].voxels, found.list[n].voxels);
    }
}

TEST(Topology, WhatIsSaidOfAComponent) {
  MemoryVolume volume({8, 7, 6}, [](double i, double j, double k) {
    if (i >= 2 && i <= 4 && j == 3 && k == 2) return 10.0 + i;
    return i == 0 && j == 6 && k == 5 ? 5.0 : 0.0;
  });
  const Components found = components(volume, 1, Connectivity::six);
  ASSERT_EQ(found.list.size(), 2u);
  const Component& bar = found.list[0];
  EXPECT_EQ(bar.voxels, 3u);
  EXPECT_EQ(bar.low, (std::array<std::size_t, 3>{2, 3, 2}));
  EXPECT_EQ(bar.high, (std::array<std::size_t, 3>{4, 3, 2}));
  EXPECT_EQ(bar.centroid, (Vec3{3, 3, 2}));
  EXPECT_DOUBLE_EQ(bar.mean_value, 13);
  EXPECT_NEAR(bar.sd_value, std::sqrt(2.0 / 3), 1e-12);
  EXPECT_FALSE(bar.touches_border);
  EXPECT_TRUE(found.list[1].touches_border);
}

// A ball in a hollow ball in the open.
MemoryVolume nested() {
  return MemoryVolume({21, 21, 21}, [](double i, double j, double k) {
    const double r = norm(Vec3{i, j, k} - Vec3{10, 10, 10});
    return r < 3 ? 2.0 : r > 6 && r < 9 ? 1.0 : 0.0;
  });
}

TEST(Topology, EnclosedObjectsAndRulesThatKeep) {
  MemoryVolume volume = nested();
  const Components found = components(volume, 0.5, Connectivity::twenty_six);
  ASSERT_EQ(found.list.size(), 2u);
  EXPECT_FALSE(found.list[0].enclosed);
  EXPECT_TRUE(found.list[1].enclosed);
  EXPECT_EQ(euler_number(volume, 0.5, Connectivity::twenty_six), 3);  // two components, one cavity
  const auto keeps = [&](const KeepRule& rule) { return chosen(found, rule).keep; };
  using Bits = std::vector<bool>;
  EXPECT_EQ(keeps({}), (Bits{true, true}));
  EXPECT_EQ(keeps({.largest = 1}), (Bits{true, false}));
  EXPECT_EQ(keeps({.at_least_voxels = 1000}), (Bits{true, false}));
  EXPECT_EQ(keeps({.above_mean = 1.5}), (Bits{false, true}));
  EXPECT_EQ(keeps({.below_mean = 1.5}), (Bits{true, false}));
  EXPECT_EQ(keeps({.touching_box = {{{{9.5, 9.5, 9.5}, {10.5, 10.5, 10.5}}}}}), (Bits{false, true}));
  EXPECT_EQ(keeps({.touching_box = {{{{9.6, 9.6, 9.6}, {9.9, 10, 10}}}}}), (Bits{false, false}));  // between centres
  EXPECT_EQ(keeps({.drop_enclosed = true}), (Bits{true, false}));
  const Kept kept = chosen(found, {.at_least_voxels = 1000});
  EXPECT_EQ(kept.reason[0], "kept");
  EXPECT_EQ(kept.reason[1], "dropped: " + std::to_string(found.list[1].voxels) + " voxels, fewer than 1000");
}

TEST(Topology, OnlyWhatIsKeptRemains) {
  MemoryVolume volume = nested();
  for (float& value : volume.values()) value += 0.25f;  // grey round everything
  const Components found = components(volume, 0.75, Connectivity::twenty_six);
  const auto rest = only(volume, found, chosen(found, {.drop_enclosed = true}), -1);
  std::vector<float> slice(21 * 21);
  rest->read(10, 1, slice);
  EXPECT_EQ(slice[10 * 21 + 10], -1);     // the ball
  EXPECT_EQ(slice[10 * 21 + 13], -1);     // its border of one voxel
  EXPECT_EQ(slice[10 * 21 + 14], 0.25f);  // beyond it
  EXPECT_EQ(slice[10 * 21 + 17], 1.25f);  // the hollow one
  const Contour surface = contour(*rest, {0.75});
  EXPECT_EQ(tests::soundness(surface.positions, surface.triangles).euler, 4);
}

// Two voxels in diagonal contact are two components with 6: dropping one leaves the other and its wall alone.
TEST(Topology, DroppingLeavesTheWallsOfWhatStays) {
  const auto value = [](double i, double j, double k) {
    if (i <= 3 && i >= 1 && j >= 1 && j <= 3 && k >= 1 && k <= 3) return 1.0;
    return i >= 5 && j >= 1 && j <= 3 && k == 2 ? 0.9 : 0.3;
  };
  MemoryVolume volume({7, 5, 5}, value);
  const Components found = components(volume, 0.5, Connectivity::six);
  ASSERT_EQ(found.list.size(), 2u);
  const auto rest = only(volume, found, chosen(found, {.largest = 1}), 0);
  std::vector<float> slice(35);
  rest->read(2, 1, slice);
  EXPECT_EQ(slice[2 * 7 + 4], 0.3f);  // beside both: it says where the kept wall is
  EXPECT_EQ(slice[2 * 7 + 5], 0);
}

TEST(Topology, EulerNumbersOfSimpleBodies) {
  const auto euler = [](const std::function<double(double, double, double)>& value, Connectivity inside) {
    MemoryVolume volume({5, 5, 5}, value);
    return euler_number(volume, 0.5, inside);
  };
  for (const Connectivity inside : both) {
    EXPECT_EQ(euler([](double, double, double) { return 0; }, inside), 0);
    EXPECT_EQ(euler([](double, double, double) { return 1; }, inside), 1);
    EXPECT_EQ(euler([](double i, double j, double k) { return i == 2 && j == 2 && k == 2 ? 0 : 1; }, inside),
              2);                                                                                      // cavity
    EXPECT_EQ(euler([](double i, double j, double) { return i == 2 && j == 2 ? 0 : 1; }, inside), 0);  // tunnel
  }
  const auto corner = [](double i, double j, double k) {
    return (i < 2 && j < 2 && k < 2) || (i >= 2 && j >= 2 && k >= 2);
  };
  EXPECT_EQ(euler(corner, Connectivity::six), 2);
  EXPECT_EQ(euler(corner, Connectivity::twenty_six), 1);
}

// A piece of value 100 stands on a table of value 50, both smeared over a voxel: one component at 30, and two parts.
TEST(SplitComponents, ATableIsApartFromWhatStandsOnIt) {
  const auto step = [](double inside) { return 0.5 * std::erfc(-inside / std::sqrt(2.0)); };  // voxels within
  tests::MemoryVolume volume({48, 40, 56}, [&](double i, double j, double k) {
    const double table = step(std::min(k - 8, 16 - k));
    const double piece = step(std::min({k - 16, 44 - k, 9 - std::abs(std::hypot(i - 24, j - 20) - 9)}));
    return std::max(50 * table, 100 * piece);
  });
  for (const Connectivity inside : {Connectivity::six, Connectivity::twenty_six}) {
    const Components joined = components(volume, 30, inside);
    ASSERT_EQ(joined.list.size(), 1u);
    const Components parts = split_components(volume, 30, inside, {75, 3});
    ASSERT_EQ(parts.list.size(), 2u);
    EXPECT_EQ(parts.list[0].voxels + parts.list[1].voxels, joined.list[0].voxels);
    const std::size_t table = parts.list[0].light ? 0 : 1;
    EXPECT_TRUE(parts.list[table].light);
    EXPECT_FALSE(parts.list[1 - table].light);
    EXPECT_LE(parts.list[table].high[2], 17u);
    EXPECT_GE(parts.list[1 - table].low[2], 13u);
    EXPECT_LT(parts.list[table].mean_value, 55);
    Kept kept;
    kept.keep = {table != 0, table == 0};
    const auto piece = only(volume, parts, kept, 0);
    const Components left = components(*piece, 30, inside);
    ASSERT_EQ(left.list.size(), 1u);
    EXPECT_EQ(left.list[0].voxels, parts.list[1 - table].voxels);
    for (std::size_t k = 0; k < 56; ++k)
      for (std::size_t j = 0; j < 40; ++j)
        for (std::size_t i = 0; i < 48; ++i) ASSERT_EQ(parts.at(i, j, k) != 0, joined.at(i, j, k) != 0);
  }
}

// Straight ways out of a pot: of a closed one all are barred, of one with a hole in the lid nearly all.
TEST(SurroundedShare, IsThatOfTheDirectionsInWhichAnotherComponentStands) {
  for (const double hole : {0.0, 4.0, 30.0}) {
    tests::MemoryVolume volume({41, 41, 41}, [&](double i, double j, double k) {
      const double x = i - 20, y = j - 20, z = k - 20, r = std::sqrt(x * x + y * y + z * z);
      return r < 4 || (r > 13 && r < 17 && !(z > 0 && std::hypot(x, y) < hole)) ? 1 : 0;
    });
    const Components all = components(volume, 0.5, Connectivity::twenty_six);
    ASSERT_EQ(all.list.size(), 2u);
    const double share = surrounded_share(all, all.list[1]);
    EXPECT_EQ(all.list[1].enclosed, hole == 0);
    // A hole of radius h in a ball of radius 13 takes (1 - cos(asin(h / 13))) / 2 of the directions.
    const double open = hole >= 13 ? 0.5 : (1 - std::sqrt(1 - hole * hole / 169)) / 2;
    EXPECT_NEAR(share, 1 - open, 0.03) << hole;
    const Kept kept = chosen(all, {.drop_enclosed = true});
    EXPECT_EQ(kept.keep[1], hole == 30);
    EXPECT_TRUE(kept.keep[0]);
  }
}

}  // namespace
}  // namespace gonio::volume
