// Line integrals through a closed mesh, exact but for their sampling: what a detector's pixels read of it, view by
// view.
//
// Views over half a turn, parallel beams in the slices' plane. At view angle a the ray through (u, z) runs along
// (-sin a, cos a, 0) where x cos a + y sin a = u. Triangles are drawn onto a grid of samples, finer than pixels; the
// path through the body is the sum of the depths where the ray leaves it less those where it enters. A pixel reads the
// mean intensity exp(-per_m path) over its samples, which move within it from view to view.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "mesh/mesh.h"

namespace gonio::explain::volumes {

struct Ball {
  Vec3 centre_m{};
  double radius_m = 0;
  double share = 0;  // of the material's attenuation; 0: not there
};

// Pixels: as many across as the diagonal of a slice needs, even or odd like the voxels across, so that the axis stands
// to them as to voxels; along z one a slice.
struct Detector {
  std::size_t views = 0, bins = 0, slices = 0;
  double bin_m = 0, slice_m = 0;
  double half_height() const { return 0.5 * (static_cast<double>(slices) - 1); }
  double middle() const { return 0.5 * (static_cast<double>(bins) - 1); }
  std::size_t line(std::size_t slice, std::size_t view) const { return (slice * views + view) * bins; }
  std::size_t size() const { return slices * views * bins; }
};

// values[line(slice, view) + bin]: the mean intensity behind the shape, and behind balls beside it.
std::vector<float> intensities(const mesh::Mesh& mesh, const Detector& detector, double per_m,
                               std::span<const Ball> beside = {});
// The mean path through balls, metres.
std::vector<float> paths(std::span<const Ball> balls, const Detector& detector);

}  // namespace gonio::explain::volumes
