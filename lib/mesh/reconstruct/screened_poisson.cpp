// PCL 1.13's copy of Kazhdan's code. What bites:
// - Threads: sums run over threads in any order, and two threads give other last digits than one. One is asked for.
// - Its tree counts nodes and takes memory in statics: no two reconstructions at once, in whatever thread.
// - Positions are floats: points are taken about their middle, in units of their extent, and put back in double.
// - The cube is 1.1 times the longest side of the bounding box, and 2^depth cells wide: stray points coarsen all.
// - "Confidence" (lengths of normals) weighs the normal field and the density from which the tree takes its depth:
//   lengths of 10 throughout are not the same as 1. The screening weighs all points alike (point weight 4).
// - Depths below the smallest one (5 by default) are ignored silently, unless it is lowered as well.
// - The density at vertices, by which Kazhdan's SurfaceTrimmer cuts, is not handed out.
// - It prints "Vertex pair not in list" to standard output, where the manifest goes, for each polygon that it leaves
//   out between two depths, a dozen in a million: the mesh has a hole there. On standard error it remarks on residuals
//   that are small. Both are turned away meanwhile.
// - reconstruct() makes a search tree that nothing asks: performReconstruction() goes straight to work. libpcl_surface
//   brings VTK along, for a hull that nobody here asks for: a module is linked with it and loaded here.
#include "mesh/reconstruct/screened_poisson.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "base/loaded_library.h"
#include "mesh/reconstruct/screened_poisson_module.h"

namespace gonio::mesh {
namespace {

class Mute {
 public:
  Mute(std::FILE* file, int descriptor) : file_(file), descriptor_(descriptor), kept_(::dup(descriptor)) {
    std::fflush(file_);
    const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (kept_ >= 0 && nowhere >= 0) ::dup2(nowhere, descriptor_);
    if (nowhere >= 0) ::close(nowhere);
  }
  ~Mute() {
    std::fflush(file_);
    if (kept_ < 0) return;
    ::dup2(kept_, descriptor_);
    ::close(kept_);
  }
  Mute(const Mute&) = delete;
  Mute& operator=(const Mute&) = delete;

 private:
  std::FILE* file_;
  int descriptor_, kept_;
};

}  // namespace

io::TriangleMesh screened_poisson(const std::vector<Vec3>& positions_m, const std::vector<Vec3>& normals, int depth,
                                  bool by_length) {
  io::TriangleMesh mesh;
  if (positions_m.empty()) return mesh;
  Vec3 low = positions_m[0], high = low;
  for (const Vec3 p : positions_m) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const Vec3 middle = 0.5 * (low + high);
  const double extent = max_component(high - low);
  if (!(extent > 0)) return mesh;
  std::vector<float> points, vertices;
  points.reserve(6 * positions_m.size());
  for (std::size_t i = 0; i < positions_m.size(); ++i) {
    const Vec3 p = (positions_m[i] - middle) / extent, n = normals[i];
    for (const double value : {p.x, p.y, p.z, n.x, n.y, n.z}) points.push_back(static_cast<float>(value));
  }
  static const auto reconstruct =
      loaded_from_module<decltype(gonio_screened_poisson)>("screened_poisson", "gonio_screened_poisson");
  std::vector<std::uint32_t> polygons;
  {
    const Mute out(stdout, STDOUT_FILENO), err(stderr, STDERR_FILENO);
    reconstruct(points, depth, by_length, vertices, polygons);
  }
  for (std::size_t i = 0; i < vertices.size(); i += 3)
    mesh.positions_m.push_back(middle + Vec3{vertices[i], vertices[i + 1], vertices[i + 2]} * extent);
  for (std::size_t at = 0; at < polygons.size(); at += 1 + polygons[at])
    for (std::size_t k = 3; k <= polygons[at]; ++k)
      mesh.triangles.push_back({polygons[at + 1], polygons[at + k - 1], polygons[at + k]});
  return mesh;
}

}  // namespace gonio::mesh
