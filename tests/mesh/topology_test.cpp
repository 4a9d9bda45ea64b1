// Closedness, holes, volume, winding numbers and distances of meshes whose answers are known.
#include "mesh/topology.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mesh/inside.h"

namespace gonio::mesh {
namespace {

// The unit cube, its corners repeated on every face as exporters do.
Mesh cube() {
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {0.0, 1.0}) {
      const auto at = [&](double u, double v) {
        return axis == 0 ? Vec3{side, u, v} : axis == 1 ? Vec3{v, side, u} : Vec3{u, v, side};
      };
      const auto first = static_cast<std::uint32_t>(mesh.positions_m.size());
      for (const Vec3 p : {at(0, 0), at(1, 0), at(1, 1), at(0, 1)}) mesh.positions_m.push_back(p);
      const std::uint32_t b = side > 0 ? 1 : 2, c = side > 0 ? 2 : 1;
      mesh.triangles.push_back({first, first + b, first + c});
      mesh.triangles.push_back({first, first + (side > 0 ? 2u : 3u), first + (side > 0 ? 3u : 2u)});
    }
  return mesh;
}

TEST(Topology, ACubeIsClosedThoughItsCornersRepeat) {
  const Topology topology = topology_of(cube());
  EXPECT_TRUE(topology.closed());
  EXPECT_EQ(topology.crowded_edges, 0u);
  EXPECT_NEAR(topology.volume_m3, 1, 1e-12);
}

TEST(Topology, TurnedInsideOutItsVolumeIsNegative) {
  Mesh mesh = cube();
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  EXPECT_TRUE(topology_of(mesh).closed());
  EXPECT_NEAR(topology_of(mesh).volume_m3, -1, 1e-12);
}

TEST(Topology, HolesAreCountedByTheirPieces) {
  Mesh mesh = cube();
  mesh.triangles.erase(mesh.triangles.begin() + 11);  // one triangle of the last face
  mesh.triangles.erase(mesh.triangles.begin() + 9);   // and of the one opposite: two triangles of holes
  const Topology topology = topology_of(mesh);
  EXPECT_FALSE(topology.closed());
  EXPECT_EQ(topology.boundary_edges, 6u);
  EXPECT_EQ(topology.holes, 2u);
}

TEST(Topology, ATriangleTheWrongWayRound) {
  Mesh mesh = cube();
  std::swap(mesh.triangles[4][0], mesh.triangles[4][1]);
  const Topology topology = topology_of(mesh);
  EXPECT_EQ(topology.boundary_edges, 0u);
  EXPECT_EQ(topology.disagreeing_edges, 3u);
  EXPECT_FALSE(topology.closed());
}

TEST(Topology, ThreeTrianglesAtAnEdgeAndACollapsedOne) {
  Mesh mesh = cube();
  mesh.positions_m.push_back({-1, -1, 0.5});
  const auto fin = static_cast<std::uint32_t>(mesh.positions_m.size() - 1);
  mesh.triangles.push_back({mesh.triangles[0][0], mesh.triangles[0][1], fin});
  mesh.triangles.push_back({mesh.triangles[0][0], mesh.triangles[0][0], fin});
  const Topology topology = topology_of(mesh);
  EXPECT_EQ(topology.crowded_edges, 1u);
  EXPECT_EQ(topology.collapsed_triangles, 1u);
  EXPECT_EQ(topology.boundary_edges, 2u);
}

TEST(Inside, WindingNumbersAndDistancesOfACube) {
  const Mesh mesh = cube();
  EXPECT_NEAR(winding_number(mesh, {0.3, 0.4, 0.9}), 1, 1e-12);
  EXPECT_NEAR(winding_number(mesh, {0.3, 0.4, 1.1}), 0, 1e-12);
  EXPECT_NEAR(distance_m(mesh, {0.3, 0.4, 0.9}), 0.1, 1e-12);
  EXPECT_NEAR(distance_m(mesh, {0.3, 0.4, 1.2}), 0.2, 1e-12);
  EXPECT_NEAR(distance_m(mesh, {2, 2, 0.5}), std::sqrt(2), 1e-12);
}

}  // namespace
}  // namespace gonio::mesh
