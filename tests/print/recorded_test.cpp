// Meshes that others made, as stacks of layers: their volumes by other programs, and a slicer's own layer.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "data.h"
#include "io/stl.h"
#include "print/coverage.h"

namespace gonio::print {
namespace {

struct Stack {
  double volume = 0, excess = 0;  // in the file's unit
};
// About `pixels` across the larger side, `layers` layers; not aligned with anything.
Stack stack_of(const io::TriangleMesh& mesh, int pixels, int layers) {
  Vec3 low = mesh.positions_m[0], high = low;
  for (const Vec3 p : mesh.positions_m) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const Vec3 size = high - low;
  const double pitch = std::max(size.x, size.y) / pixels, thickness = size.z / (layers - 0.7);
  const PixelGrid grid{static_cast<int>(size.x / pitch) + 2,
                       static_cast<int>(size.y / pitch) + 2,
                       {pitch, pitch},
                       {low.x - 0.37 * pitch, low.y - 0.61 * pitch}};
  CoverageSweep sweep(mesh.positions_m, mesh.triangles, grid, low.z - 0.3 * thickness);
  Stack stack;
  for (int layer = 1; layer <= layers; ++layer) {
    const LayerCoverage& l = sweep.next(low.z + (layer - 0.3) * thickness);
    double sum = 0;
    for (const double share : l.share) sum += share;
    stack.volume += sum * pitch * pitch * thickness;
    stack.excess = std::max(stack.excess, l.excess);
  }
  return stack;
}

// Signed volumes by trimesh, to four places (expected.csv of the set).
TEST(RecordedMeshes, StacksHaveTheirVolumes) {
  GONIO_NEEDS_DATA("print/meshes");
  const std::pair<const char*, double> meshes[] = {{"busted.STL", 526.4489},      {"featuretype.STL", 11.6277},
                                                   {"round.stl", 277.9147},       {"torus.STL", 4.9175},
                                                   {"unit_cube.STL", 1.0},        {"unit_sphere.STL", 4.1527},
                                                   {"origin_inside.STL", 0.9688}, {"plate_holes.STL", 767362.1126},
                                                   {"angle_block.STL", 1.1455},   {"20mm-xyz-cube.stl", 7938.6819},
                                                   {"20mmbox-CR.stl", 8000.0}};
  for (const auto& [name, volume] : meshes) {
    const Stack stack = stack_of(io::read_stl(tests::data("print/meshes") / name), 90, 50);
    EXPECT_NEAR(stack.volume, volume, 1e-5 * volume + 5e-5) << name;
    EXPECT_LT(stack.excess, 1e-9) << name;
  }
}

// Two bodies of which one faces inwards: edges disagree, and the sum says so.
TEST(RecordedMeshes, ABodyThatIsInsideOutIsSaid) {
  GONIO_NEEDS_DATA("print/meshes");
  EXPECT_GT(stack_of(io::read_stl(tests::data("print/meshes/multibody.stl")), 90, 50).excess, 0.5);
}

// The part that UVtools brings along, upright walls of 1 mm: layer 9 of the archive beside it, by PrusaSlicer at 0.05
// mm and 256 grey values, covers 1390.826 mm^2, every section of the file 1390.655 (SOURCE.md). Per pixel of an edge
// the two differ by 0.055 (rms).
TEST(RecordedMeshes, ALayerIsNearerThanASlicers) {
  GONIO_NEEDS_DATA("print/uvtools_demo");
  const io::TriangleMesh mesh = io::read_stl(tests::data("print/uvtools_demo/UVtools_demo_file.stl"));
  const PixelGrid grid{2560, 1620, {0.05, 0.05}, {-64, -40.5}};
  CoverageSweep sweep(mesh.positions_m, mesh.triangles, grid, 0);
  const LayerCoverage& layer = sweep.next(0.1);
  double area = 0;
  for (const double share : layer.share) area += share * 0.05 * 0.05;
  EXPECT_NEAR(area, 1390.655, 0.0006);
  EXPECT_LT(std::abs(area - 1390.655), 0.01 * std::abs(1390.826 - 1390.655));
}

}  // namespace
}  // namespace gonio::print
