// A soft sheet gives way to a hard body: nothing of it stays inside, what nothing touched stays to the last bit, layers
// keep their order, and the elastic way displaces what a plate would.
#include "reassembly/contact.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "base/error.h"
#include "mesh/inside.h"
#include "mesh/mesh.h"
#include "mesh/verdict.h"
#include "reassembly/sheets.h"

namespace gonio::reassembly {
namespace {

mesh::Mesh as_mesh(const io::TriangleMesh& raw) {
  mesh::Mesh m;
  m.positions_m = raw.positions_m;
  m.triangles = raw.triangles;
  return m;
}

// Every way of looking at it that shares no code with what moved the vertices but the exact predicate.
void expect_free(const Contact& c, const io::TriangleMesh& soft, const io::TriangleMesh& hard) {
  ASSERT_EQ(c.refused, "");
  EXPECT_GT(c.pairs_before + c.inside_before, 0u);
  EXPECT_EQ(c.pairs_after, 0u);
  EXPECT_EQ(mesh::intersections(c.soft, hard).size(), 0u);
  const mesh::Mesh body = as_mesh(hard);
  for (std::size_t k = 0; k < c.moved.size(); k += 1 + c.moved.size() / 40)
    EXPECT_NEAR(mesh::winding_number(body, c.soft.positions_m[c.moved[k]]), 0, 1e-6) << "vertex " << c.moved[k];
  const std::set<std::uint32_t> moved(c.moved.begin(), c.moved.end());
  std::size_t stirred = 0;
  for (std::uint32_t v = 0; v < soft.positions_m.size(); ++v)
    if (!moved.contains(v) && !(c.soft.positions_m[v] == soft.positions_m[v])) ++stirred;
  EXPECT_EQ(stirred, 0u) << "vertices that did not move are the same to the last bit";
  EXPECT_EQ(c.soft.triangles, soft.triangles);
  EXPECT_LE(mesh::self_intersections(c.soft).size(), mesh::self_intersections(soft).size());
}

class RandomContact : public testing::TestWithParam<Yield> {};

TEST_P(RandomContact, LeavesNothingOfTheSheetInTheBody) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const sheets::Pressed p = sheets::random_pair(seed, 40);
    SCOPED_TRACE(p.what);
    expect_free(give_way(p.soft, p.hard, {.yield = GetParam()}, "test"), p.soft, p.hard);
  }
}
INSTANTIATE_TEST_SUITE_P(BothWays, RandomContact, testing::Values(Yield::push, Yield::elastic));

// What is farther than the reach from all that meets the body stays.
TEST(ElasticContact, StopsAtTheReach) {
  const io::TriangleMesh soft = sheets::flat(0.2, 60),
                         hard = mesh::shapes::moved(mesh::shapes::ball(0.03, 4), {0, 0, 0.0285});
  const double reach = 0.02, edge = std::sqrt(2 * 0.03 * 0.0015) + 0.2 / 60 * 1.5;
  const Contact c = give_way(soft, hard, {.yield = Yield::elastic, .reach_m = reach}, "test");
  expect_free(c, soft, hard);
  EXPECT_NEAR(c.deepest_m, 0.0015, 5e-5);
  for (const std::uint32_t v : c.moved)
    EXPECT_LT(std::hypot(soft.positions_m[v].x, soft.positions_m[v].y), edge + reach);
  EXPECT_LT(norm(c.down - Vec3{0, 0, -1}), 1e-9);
}

// A clamped round plate under a paraboloid r^2 / 2R pressed in by d (Kirchhoff; Timoshenko & Woinowsky-Krieger 1959,
// section 17): the load sits on the rim r = c of the contact, outside of which
//   w = A + B r^2 + C ln r + D r^2 ln r,   w(a) = w'(a) = 0,   w(c) = d - c^2 / 2R, w'(c) = -c / R, w''(c) = -1 / R.
struct RoundPlate {
  double a, d, big_r;
  double c = 0;
  std::array<double, 4> k{};
  // The four conditions but w(c), by elimination; what w(c) is too large by.
  double off(double rim) {
    const auto slope = [](double r) { return std::array{0.0, 2 * r, 1 / r, 2 * r * std::log(r) + r}; };
    const auto bend = [](double r) { return std::array{0.0, 2.0, -1 / (r * r), 2 * std::log(r) + 3}; };
    std::array<std::array<double, 4>, 3> m{};
    const std::array rows{slope(a), slope(rim), bend(rim)};
    const std::array right{0.0, -rim / big_r, -1 / big_r};
    for (std::size_t i = 0; i < 3; ++i) m[i] = {rows[i][1], rows[i][2], rows[i][3], right[i]};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        if (j != i) {
          const double f = m[j][i] / m[i][i];
          for (std::size_t l = 0; l < 4; ++l) m[j][l] -= f * m[i][l];
        }
    for (std::size_t i = 0; i < 3; ++i) k[i + 1] = m[i][3] / m[i][i];
    k[0] = 0;
    k[0] = -w(a);
    c = rim;
    return w(rim) - (d - rim * rim / (2 * big_r));
  }
  double w(double r) const { return k[0] + k[1] * r * r + k[2] * std::log(r) + k[3] * r * r * std::log(r); }
  double volume() {
    double low = 1e-4 * a, high = std::min(a, std::sqrt(2 * big_r * d)) * 0.999;
    for (int i = 0; i < 100; ++i) (off((low + high) / 2) > 0 ? high : low) = (low + high) / 2;
    double sum = 0;
    constexpr int rings = 2000;
    for (int i = 0; i < rings; ++i) {
      const double r = a * (i + 0.5) / rings;
      sum += 2 * pi * r * (a / rings) * (r < c ? d - r * r / (2 * big_r) : w(r));
    }
    return sum;
  }
};

TEST(ElasticContact, DisplacesWhatAClampedPlateDoesUnderASphere) {
  for (const double reach : {0.01, 0.03}) {
    const double radius = 0.1, depth = 0.001, a = std::sqrt(2 * radius * depth) + reach;
    const io::TriangleMesh soft = sheets::flat(0.12, 70),
                           hard = mesh::shapes::moved(mesh::shapes::ball(radius, 6), {0, 0, radius - depth});
    const Contact c = give_way(soft, hard, {.yield = Yield::elastic, .reach_m = reach}, "test");
    expect_free(c, soft, hard);
    RoundPlate plate{.a = a, .d = depth, .big_r = radius};
    const double truth = plate.volume();
    RecordProperty("share", std::to_string(c.volume_m3 / truth));
    EXPECT_NEAR(c.volume_m3 / truth, 1, 0.08) << "reach " << reach;
  }
}

// The truth of a random pair by other means: the sheet's displacement on a square lattice, the biharmonic operator's
// thirteen points, relaxed node by node and never below what the body asks of it (projected over-relaxation; Glowinski
// 1984). The body's underside is read off its triangles lattice point by lattice point.
class LatticePlate {
 public:
  LatticePlate(const io::TriangleMesh& hard, const sheets::Bumps& bumps, double side_m, double reach_m)
      : step_(side_m / cells), asked_(nodes * nodes, -1), u_(nodes * nodes, 0), free_(nodes * nodes, 0) {
    for (const auto& t : hard.triangles)
      ask(hard.positions_m[t[0]], hard.positions_m[t[1]], hard.positions_m[t[2]], bumps);
    const int reach = static_cast<int>(std::ceil(reach_m / step_));
    for (int i = 2; i < nodes - 2; ++i)
      for (int j = 2; j < nodes - 2; ++j)
        for (int k = std::max(0, i - reach); k < std::min(nodes, i + reach + 1) && free_[at(i, j)] == 0; ++k)
          for (int l = std::max(0, j - reach); l < std::min(nodes, j + reach + 1); ++l)
            if (asked_[at(k, l)] > 0 && std::hypot(k - i, l - j) * step_ <= reach_m) {
              free_[at(i, j)] = 1;
              break;
            }
  }
  double volume() {
    constexpr double over = 1.6;
    for (int sweep = 0; sweep < 4000; ++sweep) {
      double most = 0;
      for (int i = 2; i < nodes - 2; ++i)
        for (int j = 2; j < nodes - 2; ++j) {
          if (free_[at(i, j)] == 0) continue;
          const auto u = [&](int a, int b) { return u_[at(i + a, j + b)]; };
          const double rest = -8 * (u(1, 0) + u(-1, 0) + u(0, 1) + u(0, -1)) +
                              2 * (u(1, 1) + u(1, -1) + u(-1, 1) + u(-1, -1)) + u(2, 0) + u(-2, 0) + u(0, 2) + u(0, -2);
          const double next = std::max(asked_[at(i, j)], (1 - over) * u(0, 0) - over * rest / 20);
          most = std::max(most, std::abs(next - u(0, 0)));
          u_[at(i, j)] = next;
        }
      if (most < 1e-9) break;
    }
    double sum = 0;
    for (const double v : u_) sum += v * step_ * step_;
    return sum;
  }

 private:
  static constexpr int cells = 70, nodes = cells + 1;
  static std::size_t at(int i, int j) { return static_cast<std::size_t>(i * nodes + j); }
  void ask(Vec3 a, Vec3 b, Vec3 c, const sheets::Bumps& bumps) {
    const auto node = [&](double x) { return x / step_ + cells / 2.0; };
    const double area = cross(b - a, c - a).z;
    if (area == 0) return;
    const auto [x0, x1] = std::minmax({node(a.x), node(b.x), node(c.x)});
    const auto [y0, y1] = std::minmax({node(a.y), node(b.y), node(c.y)});
    for (int i = std::max(0, static_cast<int>(std::ceil(x0))); i <= std::min(nodes - 1, static_cast<int>(x1)); ++i)
      for (int j = std::max(0, static_cast<int>(std::ceil(y0))); j <= std::min(nodes - 1, static_cast<int>(y1)); ++j) {
        const Vec3 p{(i - cells / 2.0) * step_, (j - cells / 2.0) * step_, 0};
        const double wa = cross(b - p, c - p).z / area, wb = cross(c - p, a - p).z / area, wc = 1 - wa - wb;
        if (wa >= 0 && wb >= 0 && wc >= 0)
          asked_[at(i, j)] = std::max(asked_[at(i, j)], bumps.at(p.x, p.y) - (wa * a.z + wb * b.z + wc * c.z));
      }
  }
  double step_;
  std::vector<double> asked_;  // least displacement down; negative: above
  std::vector<double> u_;
  std::vector<std::uint8_t> free_;
};

TEST(ElasticContact, DisplacesWhatALatticePlateDoesUnderRandomBodies) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    Random random(seed, 23);
    const sheets::Bumps bumps{random.uniform(0, 0.0015), random.uniform(0.06, 0.12), random.uniform(0, 6)};
    io::TriangleMesh hard = sheets::lump(random.uniform(0.04, 0.08), 4, 0.05, random);
    const io::TriangleMesh soft = sheets::flat(0.16, 60, bumps);
    hard = sheets::moved(hard, {}, {0, 0, bumps.height_m - sheets::lowest_z(hard)});
    while (mesh::intersections(soft, hard, 1).empty()) hard = sheets::moved(hard, {}, {0, 0, -0.0002});
    hard = sheets::moved(hard, {}, {0, 0, -random.uniform(0.001, 0.0025)});
    const double reach = random.uniform(0.015, 0.03);
    const Contact c = give_way(soft, hard, {.yield = Yield::elastic, .reach_m = reach, .down = Vec3{0, 0, -1}}, "test");
    expect_free(c, soft, hard);
    EXPECT_NEAR(c.volume_m3 / LatticePlate(hard, bumps, 0.16, reach).volume(), 1, 0.2) << seed;
  }
}

// No vertex of either is in the other: an edge of the box through one large face.
TEST(CoarseContact, FacesAndEdgesGiveWayAsWellAsVertices) {
  const io::TriangleMesh soft = sheets::flat(0.5, 1);
  const Quaternion edge_down = quaternion_of_rotation_vector({pi / 4, 0, 0});
  io::TriangleMesh hard = sheets::moved(mesh::shapes::box({0.1, 0.05, 0.05}, 1), edge_down, {0.02, 0.03, 0});
  hard = sheets::moved(hard, {}, {0, 0, -0.002 - sheets::lowest_z(hard)});
  for (const Yield yield : {Yield::push, Yield::elastic})
    expect_free(give_way(soft, hard, {.yield = yield, .deepest_m = 0.05}, "test"), soft, hard);
}

TEST(SwallowedContact, WhatLiesInsideWithoutCrossingGoesOut) {
  const io::TriangleMesh hard = mesh::shapes::moved(mesh::shapes::ball(0.05, 4), {0, 0, 0.05});
  const io::TriangleMesh patch = mesh::shapes::moved(sheets::flat(0.004, 4), {0, 0, 0.001});
  for (const Yield yield : {Yield::push, Yield::elastic}) {
    const Contact c = give_way(patch, hard, {.yield = yield, .down = Vec3{0, 0, -1}}, "test");
    EXPECT_EQ(c.pairs_before, 0u);
    EXPECT_EQ(c.inside_before, 25u);
    expect_free(c, patch, hard);
  }
  const io::TriangleMesh deep = mesh::shapes::moved(sheets::flat(0.004, 4), {0, 0, 0.05});
  const Contact c = give_way(deep, hard, {.down = Vec3{0, 0, -1}}, "test");
  EXPECT_EQ(c.refused,
            "vertex 0 of the soft mesh lies inside the hard one without a way out within 12.1 mm along down, as do 24 "
            "more");
  EXPECT_EQ(c.soft.positions_m, deep.positions_m);
  EXPECT_EQ(give_way(deep, hard, {}, "test").refused,
            "too little of the soft mesh is near the hard one's surface to say where down is; state it");
}

// A sheet through the floor of a thin bowl lies in the bowl, inside of nothing: it goes below the floor.
TEST(ThinContact, ASheetInABowlGoesBelowItsFloor) {
  const io::TriangleMesh soft = sheets::flat(0.24, 60);
  const io::TriangleMesh hard = sheets::moved(sheets::bowl(0.06, 0.002, 60, 60), {}, {0, 0, -0.009});
  const Contact c = give_way(soft, hard, {.yield = Yield::elastic, .deepest_m = 0.02, .down = Vec3{0, 0, -1}}, "test");
  expect_free(c, soft, hard);
  std::size_t middle = 0;
  for (std::size_t v = 1; v < soft.positions_m.size(); ++v)
    if (norm(soft.positions_m[v]) < norm(soft.positions_m[middle])) middle = v;
  EXPECT_LT(c.soft.positions_m[middle].z, -0.009 + 0.08 * 0.06);
}

// What lies under the cloth's upper layer goes down with it, in its order.
TEST(LayeredContact, PressesTheLowerLayersToo) {
  const double gap = 0.001;
  const io::TriangleMesh soft = sheets::folded(0.24, 30, gap),
                         hard = mesh::shapes::moved(mesh::shapes::ball(0.05, 4), {0, 0, 0.047});
  for (const Yield yield : {Yield::push, Yield::elastic}) {
    const Contact c = give_way(soft, hard, {.yield = yield, .down = Vec3{0, 0, -1}}, "test");
    expect_free(c, soft, hard);
    bool lowest = false;
    for (const std::uint32_t v : c.moved) lowest |= soft.positions_m[v].z < -1.9 * gap;
    EXPECT_TRUE(lowest) << "3 mm are more than two gaps of 1 mm";
    EXPECT_EQ(c.self_after, 0u);
  }
}

TEST(RefusedContact, SaysWhyAndMovesNothing) {
  const io::TriangleMesh soft = sheets::flat(0.2, 20);
  const io::TriangleMesh ball = mesh::shapes::ball(0.03, 3);
  const Contact apart = give_way(soft, mesh::shapes::moved(ball, {0, 0, 0.04}), {}, "test");
  EXPECT_EQ(apart.refused, "");
  EXPECT_TRUE(apart.moved.empty());
  EXPECT_EQ(apart.soft.positions_m, soft.positions_m);
  const Contact deep = give_way(soft, mesh::shapes::moved(ball, {0, 0, 0.02}), {.yield = Yield::elastic}, "test");
  EXPECT_NE(deep.refused, "");
  EXPECT_EQ(deep.soft.positions_m, soft.positions_m);
  EXPECT_EQ(deep.pairs_after, deep.pairs_before);
}

TEST(BadContact, IsSaidAtItsPlace) {
  const io::TriangleMesh soft = sheets::flat(0.2, 4), ball = mesh::shapes::ball(0.03, 2);
  const auto words = [&](const io::TriangleMesh& s, const io::TriangleMesh& h) -> std::string {
    try {
      give_way(s, h, {}, "scene.json#/objects/1");
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), Exit::data);
      return e.what();
    }
    return "accepted";
  };
  io::TriangleMesh open = ball, nan = soft, astray = soft;
  open.triangles.pop_back();
  nan.positions_m[3].y = std::nan("");
  astray.triangles[5][1] = 99;
  EXPECT_EQ(
      words(soft, open),
      "scene.json#/objects/1: the hard mesh is not closed (3 edges with one triangle, 0 whose two disagree, limit "
      "0); close it (ct-mesh-clean), or turn its triangles to one side");
  EXPECT_NE(words(soft, mesh::shapes::inside_out(ball)).find("faces inwards"), std::string::npos);
  EXPECT_NE(words(nan, ball).find("vertex 3 of the soft mesh is not finite"), std::string::npos);
  EXPECT_NE(words(astray, ball).find("triangle 5 of the soft mesh names vertex 99 of 25"), std::string::npos);
  EXPECT_NE(words({}, ball).find("the soft mesh has no triangle"), std::string::npos);
}

}  // namespace
}  // namespace gonio::reassembly
