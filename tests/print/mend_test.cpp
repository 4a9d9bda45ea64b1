// Meshes broken in known ways, mended: the volume is that of the sound one, or they are refused by name.
#include "print/mend.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "base/error.h"
#include "broken_meshes.h"
#include "data.h"
#include "io/obj.h"
#include "mesh/verdict.h"
#include "print/coverage.h"

namespace gonio::print {
namespace {

using namespace tests;

std::string refusal(const io::TriangleMesh& mesh, const MendWish& wish = {}) {
  try {
    mend(mesh, wish, "part.stl");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Exit::data);
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    EXPECT_THAT(error.what(), testing::StartsWith("part.stl: "));
    return error.what();
  }
  return "";
}

// By the layers that it is sliced into, and by how much they are more than full.
std::pair<double, double> sliced(const io::TriangleMesh& mesh) {
  Vec3 low = mesh.positions_m[0], high = low;
  for (const Vec3 p : mesh.positions_m) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const Vec3 size = high - low;
  const double pitch = std::max(size.x, size.y) / 23.7, thickness = size.z / 11.3;
  CoverageSweep sweep(mesh.positions_m, mesh.triangles,
                      {static_cast<int>(size.x / pitch) + 2,
                       static_cast<int>(size.y / pitch) + 2,
                       {pitch, pitch},
                       {low.x - 0.4 * pitch, low.y - 0.7 * pitch}},
                      low.z - 0.1 * thickness);
  double volume = 0, excess = 0;
  for (int layer = 1; layer <= 13; ++layer) {
    const LayerCoverage& l = sweep.next(low.z + (layer - 0.1) * thickness);
    for (const double share : l.share) volume += share * pitch * pitch * thickness;
    excess = std::max(excess, l.excess);
  }
  return {volume, excess};
}

void expect_mended(const io::TriangleMesh& broken, double volume, double relative, std::size_t bodies = 1,
                   std::size_t cavities = 0) {
  Mended mended;
  try {
    mended = mend(broken, {}, "part.stl");
  } catch (const Error& error) {
    FAIL() << error.what();
  }
  EXPECT_NEAR(mended.volume_m3, volume, relative * volume);
  EXPECT_EQ(mended.bodies, bodies);
  EXPECT_EQ(mended.cavities, cavities);
  EXPECT_TRUE(mesh::soundness(mended.mesh).closed());
  const auto [slices, excess] = sliced(mended.mesh);
  EXPECT_NEAR(slices, volume, (relative + 1e-9) * volume);
  EXPECT_LT(excess, 1e-9);
  const std::size_t again = mend(mended.mesh, {}, "again").steps.size();
  EXPECT_LE(again, mended.steps.empty() ? 0u : 2u);  // places that were split are one again; nothing else is left to do
}

struct Damage {
  const char* name;
  double relative;
  std::function<void(io::TriangleMesh&, std::mt19937_64&)> harm;
};
const std::vector<Damage>& damages() {
  static const std::vector<Damage> all{
      {"nothing", 1e-12, [](auto&, auto&) {}},
      {"flipped", 1e-12, [](auto& m, auto& r) { flip_some(m, r); }},
      {"inside out", 1e-12, [](auto& m, auto&) { turn_all(m); }},
      {"loose", 1e-12, [](auto& m, auto&) { unweld(m); }},
      {"removed", 1e-12, [](auto& m, auto& r) { remove_some(m, 6, r); }},
      {"doubled", 1e-12, [](auto& m, auto& r) { double_some(m, r); }},
      {"slivers", 1e-12, [](auto& m, auto& r) { add_slivers(m, r); }},
      // Rims that gape by less than a hundred-thousandth of the mesh: the volume moves by that of the gaps.
      {"torn", 1e-5,
       [](auto& m, auto& r) {
         const double reach = 2e-6 * diagonal_of(m);
         unweld(m);
         std::uniform_real_distribution<double> even(-reach, reach);
         for (const std::size_t v : some_of(m.positions_m.size(), m.positions_m.size() / 10, r))
           m.positions_m[v] += Vec3{even(r), even(r), even(r)};
       }},
      {"all but torn", 1e-12, [](auto& m, auto& r) {
         remove_some(m, 3, r), add_slivers(m, r), flip_some(m, r), double_some(m, r), turn_all(m), unweld(m);
       }}};
  return all;
}

TEST(Mend, TheVolumeOfTheSoundMeshComesBack) {  // 9 damages x 4 shapes x 2 seeds
  for (const Damage& damage : damages())
    for (int shape = 0; shape < 4; ++shape)
      for (std::uint64_t seed = 1; seed <= 2; ++seed) {
        SCOPED_TRACE(std::string(damage.name) + ", shape " + std::to_string(shape) + ", seed " + std::to_string(seed));
        std::mt19937_64 random(100 * seed + shape);
        io::TriangleMesh mesh = shape == 0   ? box({0, 0, 0}, {2, 1, 1.5}, 5)
                                : shape == 1 ? ring(2, 0.6, 24, 14)
                                             : box({0, 0, 0}, {3, 3, 2}, 6);
        if (shape == 2) append(mesh, ring(1.3, 0.2, 20, 8));  // beside it, once it is placed
        if (shape == 2)
          for (std::size_t v = mesh.positions_m.size() - 160; v < mesh.positions_m.size(); ++v)
            mesh.positions_m[v] += Vec3{8, 0, 0};
        if (shape == 3) {
          io::TriangleMesh cavity = box({1, 1, 0.5}, {1, 1, 1}, 5);
          turn_all(cavity);
          append(mesh, cavity);
        }
        place(mesh, random);
        const double volume = volume_of(mesh);
        damage.harm(mesh, random);
        expect_mended(mesh, volume, damage.relative, shape == 2 ? 2 : 1, shape == 3 ? 1 : 0);
      }
}

TEST(Mend, OverlappingBodiesAreUnited) {  // 24 pairs of boxes, aligned with each other and turned as a whole
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> even(-0.9, 0.9);
    // The last eight have planes and edges in common.
    const Vec3 at = seed > 16 ? Vec3{0.5 * (seed % 3), 0.25 * (seed % 2), seed % 5 == 0 ? 1.0 : 0.5}
                              : Vec3{even(random), even(random), even(random)};
    io::TriangleMesh mesh = box({0, 0, 0}, {1, 1, 1}, 1 + seed % 3);
    append(mesh, box(at, {1, 1, 1}, 1 + seed % 2));
    const auto common = [](double s) { return std::max(0.0, 1 - std::abs(s)); };
    const double volume = 2 - common(at.x) * common(at.y) * common(at.z);
    if (seed <= 16) place(mesh, random);
    if (seed % 4 == 0) flip_some(mesh, random);
    const Mended mended = mend(mesh, {}, "part.stl");
    EXPECT_NEAR(mended.volume_m3, volume, 1e-9);
    const auto [slices, excess] = sliced(mended.mesh);
    EXPECT_NEAR(slices, volume, 1e-9);
    EXPECT_LT(excess, 1e-9);
  }
}

// Sides, edges and corners in common wherever boxes meet: cells of the lattice that are in any of them are the truth.
TEST(Mend, BoxesOfALatticeFillItsCells) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    io::TriangleMesh mesh;
    std::set<std::array<int, 3>> cells;
    for (std::uint64_t k = 0; k < 2 + seed % 6; ++k) {
      std::array<int, 3> low{}, size{};
      for (int c = 0; c < 3; ++c) low[c] = static_cast<int>(random() % 5), size[c] = 1 + static_cast<int>(random() % 3);
      append(mesh, box({low[0] * 1.0, low[1] * 1.0, low[2] * 1.0}, {size[0] * 1.0, size[1] * 1.0, size[2] * 1.0},
                       1 + static_cast<int>(random() % 2)));
      for (int i = 0; i < size[0] * size[1] * size[2]; ++i)
        cells.insert({low[0] + i % size[0], low[1] + i / size[0] % size[1], low[2] + i / size[0] / size[1]});
    }
    const auto volume = static_cast<double>(cells.size());
    if (seed % 3 == 0) place(mesh, random);
    if (seed % 4 == 0) unweld(mesh);
    Mended mended;
    try {
      mended = mend(mesh, {}, "boxes");
    } catch (const Error& error) {
      ADD_FAILURE() << error.what();
      continue;
    }
    EXPECT_NEAR(mended.volume_m3, volume, 1e-9 * volume);
    const auto [slices, excess] = sliced(mended.mesh);
    EXPECT_NEAR(slices, volume, 1e-8 * volume);
    EXPECT_LT(excess, 1e-9);
  }
}

TEST(Mend, ASquareAndItselfTurnedMakeAStar) {  // their common octagon has an area of 8 (sqrt 2 - 1)
  io::TriangleMesh mesh = box({-1, -1, 0}, {2, 2, 1}, 1), turned = box({-1, -1, 0.25}, {2, 2, 1}, 1);
  const double h = std::sqrt(0.5);
  for (Vec3& p : turned.positions_m) p = {h * (p.x - p.y), h * (p.x + p.y), p.z};
  append(mesh, turned);
  const Mended mended = mend(mesh, {}, "star");
  EXPECT_NEAR(mended.volume_m3, 8 - 0.75 * 8 * (std::sqrt(2.0) - 1), 1e-12);
  EXPECT_EQ(mended.bodies, 1u);
}

TEST(Mend, ASurfaceThatPassesThroughItselfIsSolidWhereItGoesRoundAtAll) {
  const io::TriangleMesh mesh = crossed_tube(0.2, 60, 12);
  const Mended mended = mend(mesh, {}, "tube");
  EXPECT_LT(mended.volume_m3, 0.98 * volume_of(mesh));
  EXPECT_GT(mended.volume_m3, 0.8 * volume_of(mesh));
  EXPECT_EQ(mended.bodies, 1u);
  const auto [slices, excess] = sliced(mended.mesh);
  EXPECT_NEAR(slices, mended.volume_m3, 1e-9);
  EXPECT_LT(excess, 1e-9);
  EXPECT_GT(sliced(mesh).second, 0.5);
}

TEST(Mend, BodiesInBodies) {
  const io::TriangleMesh outer = box({0, 0, 0}, {4, 4, 4}, 2), inner = box({1, 1, 1}, {2, 2, 2}, 2),
                         core = box({1.5, 1.5, 1.5}, {1, 1, 1}, 2);
  io::TriangleMesh hollow = inner;
  turn_all(hollow);
  io::TriangleMesh within = outer;
  append(within, inner);
  expect_mended(within, 64, 1e-12);  // material in material
  io::TriangleMesh shell = outer;
  append(shell, hollow);
  expect_mended(shell, 56, 1e-12, 1, 1);
  append(shell, core);
  expect_mended(shell, 57, 1e-12, 2, 1);
  turn_all(shell);
  expect_mended(shell, 57, 1e-12, 2, 1);
}

TEST(Mend, BodiesThatTouchStayBodies) {
  io::TriangleMesh edge = box({0, 0, 0}, {1, 1, 1}, 2);
  append(edge, box({1, 1, 0}, {1, 1, 1}, 2));
  unweld(edge);
  expect_mended(edge, 2, 1e-12, 2);
  io::TriangleMesh corner = box({0, 0, 0}, {1, 1, 1}, 2);
  append(corner, box({1, 1, 1}, {1, 1, 1}, 2));
  unweld(corner);
  expect_mended(corner, 2, 1e-12, 2);
  io::TriangleMesh face = box({0, 0, 0}, {1, 1, 1}, 2);
  append(face, box({1, 0, 0}, {1, 1, 1}, 2));
  unweld(face);
  expect_mended(face, 2, 1e-12, 1);
}

TEST(Mend, WhatIsSoundStaysAsItIsToTheLastBit) {
  std::mt19937_64 random(5);
  io::TriangleMesh mesh = ring(2, 0.6, 24, 14);
  place(mesh, random);
  const Mended mended = mend(mesh, {}, "ring");
  EXPECT_TRUE(mended.steps.empty());
  const auto places = [](const io::TriangleMesh& m) {
    std::vector<std::array<double, 3>> all;
    for (const Vec3 p : m.positions_m) all.push_back({p.x, p.y, p.z});
    std::sort(all.begin(), all.end());
    return all;
  };
  EXPECT_EQ(places(mended.mesh), places(mesh));
  EXPECT_EQ(mended.mesh.triangles.size(), mesh.triangles.size());
}

TEST(Mend, HolesUpToTheLimitAreClosed) {
  io::TriangleMesh mesh = box({0, 0, 0}, {1, 1, 1}, 20);
  std::erase_if(mesh.triangles, [&](const Corners& t) {  // a window of 3 x 3 cells in one side
    const Vec3 p = (mesh.positions_m[t[0]] + mesh.positions_m[t[1]] + mesh.positions_m[t[2]]) / 3;
    return p.z > 1 - 1e-9 && std::abs(p.x - 0.525) < 0.075 && std::abs(p.y - 0.525) < 0.075;
  });
  EXPECT_THAT(refusal(mesh), testing::AllOf(testing::HasSubstr("is open: it has 1 hole, one of 12 edges"),
                                            testing::HasSubstr("0.212 m across")));
  const Mended mended = mend(mesh, {.largest_hole_m = 0.3}, "window");
  EXPECT_NEAR(mended.volume_m3, 1, 1e-12);
  ASSERT_EQ(mended.steps.size(), 1u);
  EXPECT_THAT(mended.steps[0], testing::HasSubstr("1 hole was closed, the largest 0.212 m across, with 10 triangles"));
}

TEST(Mend, RefusesByName) {
  const double nan = std::nan("");
  EXPECT_THAT(refusal({}), testing::HasSubstr("no triangles"));
  io::TriangleMesh mesh = box({0, 0, 0}, {1, 1, 1}, 2), other = mesh;
  other.positions_m[3].y = nan;
  EXPECT_THAT(refusal(other), testing::HasSubstr("not finite"));
  other = mesh, other.triangles[5][1] = 1000;
  EXPECT_THAT(refusal(other), testing::HasSubstr("names vertex 1000"));
  other = mesh;
  for (Vec3& p : other.positions_m) p.z = 0;
  EXPECT_THAT(refusal(other), testing::HasSubstr("flat"));
  for (Vec3& p : other.positions_m) p.x = 0;
  EXPECT_THAT(refusal(other), testing::HasSubstr("zero area"));
  other.positions_m = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, other.triangles = {{0, 1, 2}};
  EXPECT_THAT(refusal(other), testing::HasSubstr("is open"));
  other.triangles = {{0, 1, 2}, {2, 1, 0}};
  EXPECT_THAT(refusal(other), testing::HasSubstr("flat"));
  // A Moebius strip of 12 parts.
  other = {};
  for (int i = 0; i < 12; ++i)
    for (const double side : {-1.0, 1.0}) {
      const double u = 2 * pi * i / 12, r = 3 + side * std::cos(u / 2);
      other.positions_m.push_back({r * std::cos(u), r * std::sin(u), side * std::sin(u / 2)});
    }
  for (std::uint32_t i = 0; i < 12; ++i) {
    const std::uint32_t a = 2 * i, b = a + 1, c = i < 11 ? a + 2 : 1, d = i < 11 ? a + 3 : 0;
    other.triangles.push_back({a, c, b}), other.triangles.push_back({b, c, d});
  }
  EXPECT_THAT(refusal(other), testing::HasSubstr("Moebius"));
}

struct Recorded {
  const char* file;
  double volume;  // of expected.csv; 0: not known there
};
TEST(Mend, MeshesThatOthersMade) {
  GONIO_NEEDS_DATA("print/meshes");
  for (const Recorded& r : {Recorded{"busted.STL", 526.4489},
                            {"featuretype.STL", 11.6277},
                            {"round.stl", 277.9147},
                            {"quadknot.obj", 1057307.7715},
                            {"tube.obj", 8.6185},
                            {"torus.STL", 4.9175},
                            {"unit_cube.STL", 1},
                            {"unit_sphere.STL", 4.1527},
                            {"origin_inside.STL", 0.9688},
                            {"joined_tetrahedra.obj", 0.866},
                            {"plate_holes.STL", 767362.1126},
                            {"angle_block.STL", 1.1455},
                            {"20mm-xyz-cube.stl", 7938.6819},
                            {"negative_indices.obj", 8},
                            {"fandisk.obj", 0.6794},
                            {"20mmbox-CR.stl", 8000},
                            {"20mmbox-nonstandard.stl", 8000},
                            {"cube_with_concave_hole_enlarged.obj", 12646.628},
                            // Of 10^3, less a channel of 5 x 2 x 10, with a pyramid of 10 x 10 and height 5 on it.
                            {"wallhole.obj", 900 + 500.0 / 3}}) {
    SCOPED_TRACE(r.file);
    const Mended mended = mend(io::read_mesh(data("print/meshes") / r.file), {}, r.file);
    EXPECT_NEAR(mended.volume_m3, r.volume, 1e-4 + 1e-6 * r.volume);
    EXPECT_EQ(mended.bodies, 1u);
    const auto [slices, excess] = sliced(mended.mesh);
    EXPECT_NEAR(slices, mended.volume_m3, 1e-8 * mended.volume_m3);
    EXPECT_LT(excess, 1e-6);
  }
  EXPECT_THAT(refusal(io::read_mesh(data("print/meshes") / "soup.stl")), testing::HasSubstr("100 holes"));
  for (const char* file : {"empty.stl", "notenoughindices.obj"})
    EXPECT_THROW(io::read_mesh(data("print/meshes") / file), Error) << file;
  // Parts that overlap: less than the sum of their signed volumes, and nothing twice.
  for (const char* file : {"extruder_idler_quads.obj", "multibody.stl", "not_convex.obj"}) {
    const Mended mended = mend(io::read_mesh(data("print/meshes") / file), {}, file);
    const auto [slices, excess] = sliced(mended.mesh);
    EXPECT_NEAR(slices, mended.volume_m3, 1e-8 * mended.volume_m3) << file;
    EXPECT_LT(excess, 1e-6) << file;
  }
}

}  // namespace
}  // namespace gonio::print
