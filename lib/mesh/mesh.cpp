// Checks a triangle mesh and gives it vertex normals.
//   n(v) ~ sum over triangles t at v of  area(t) angle(t, v) n(t)
// The area-weighted normal is half the cross product of two edges; the angle is taken with atan2, which keeps its
// precision for slivers where acos of a dot product loses it.
#include "mesh/mesh.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace gonio::mesh {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

Vec3 doubled_area(const std::vector<Vec3>& p, const Triangle& t) {
  return cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]);
}

void check_finite(const std::vector<Vec3>& values, const char* what, const std::string& place) {
  const auto bad = std::find_if(values.begin(), values.end(), [](Vec3 v) { return !is_finite(v); });
  if (bad != values.end())
    throw Error(Exit::data, place,
                std::string(what) + " of vertex " + std::to_string(bad - values.begin()) + " is not finite",
                "repair the mesh");
}

void check_indices(const io::TriangleMesh& raw, const std::string& place) {
  for (std::size_t i = 0; i < raw.triangles.size(); ++i)
    for (const std::uint32_t vertex : raw.triangles[i])
      if (vertex >= raw.positions_m.size())
        throw Error(Exit::data, place,
                    "triangle " + std::to_string(i) + " names vertex " + std::to_string(vertex) + " of " +
                        std::to_string(raw.positions_m.size()),
                    "repair the mesh");
}

// The file's normals at unit length; where one has none, the averaged normal of that vertex.
std::vector<Vec3> unit_normals(const io::TriangleMesh& raw) {
  std::vector<Vec3> averaged, normals = raw.normals;
  for (std::size_t v = 0; v < normals.size(); ++v) {
    const double length = norm(normals[v]);
    if (length > 0) {
      normals[v] = normals[v] / length;
      continue;
    }
    if (averaged.empty()) averaged = averaged_normals(raw.positions_m, raw.triangles);
    normals[v] = averaged[v];
  }
  return normals;
}

// Leaves out triangles without area, and their labels.
void drop_flat(io::TriangleMesh& raw) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < raw.triangles.size(); ++i) {
    if (!(norm(doubled_area(raw.positions_m, raw.triangles[i])) > 0)) continue;
    raw.triangles[kept] = raw.triangles[i];
    if (!raw.labels.empty()) raw.labels[kept] = raw.labels[i];
    ++kept;
  }
  raw.triangles.resize(kept);
  if (!raw.labels.empty()) raw.labels.resize(kept);
}

}  // namespace

std::vector<Vec3> averaged_normals(const std::vector<Vec3>& positions_m, const std::vector<Triangle>& triangles) {
  std::vector<Vec3> sum(positions_m.size());
  for (const Triangle& t : triangles) {
    const Vec3 area = doubled_area(positions_m, t);
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const Vec3 here = positions_m[t[corner]];
      const Vec3 a = positions_m[t[(corner + 1) % 3]] - here, b = positions_m[t[(corner + 2) % 3]] - here;
      sum[t[corner]] += area * std::atan2(norm(cross(a, b)), dot(a, b));
    }
  }
  for (Vec3& n : sum) {
    const double length = norm(n);
    n = length > 0 ? n / length : Vec3{0, 0, 1};
  }
  return sum;
}

Mesh prepare(io::TriangleMesh raw, Shading shading, const std::string& place, std::size_t* dropped) {
  check_finite(raw.positions_m, "position", place);
  check_finite(raw.normals, "normal", place);
  check_indices(raw, place);
  const std::size_t before = raw.triangles.size();
  drop_flat(raw);
  if (dropped) *dropped = before - raw.triangles.size();
  if (raw.triangles.empty())
    throw Error(Exit::data, place,
                before == 0 ? "mesh has no triangles" : "all " + std::to_string(before) + " triangles have zero area",
                "export a triangle mesh with an extent, in metres");
  Mesh mesh;
  if (shading == Shading::smooth)
    mesh.normals = raw.normals.empty() ? averaged_normals(raw.positions_m, raw.triangles) : unit_normals(raw);
  mesh.positions_m = std::move(raw.positions_m);
  mesh.texture = std::move(raw.texture);
  mesh.triangles = std::move(raw.triangles);
  mesh.properties = std::move(raw.properties);
  mesh.labels = std::move(raw.labels);
  return mesh;
}

double area_m2(const Mesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) sum += norm(doubled_area(mesh.positions_m, t)) / 2;
  return sum;
}

}  // namespace gonio::mesh
