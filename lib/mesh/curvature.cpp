#include "mesh/curvature.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"

namespace gonio::mesh {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

// A vertex's ring of triangles is closed where every neighbour ends one edge of it and begins another: the sum of
// hash(next) - hash(previous) vanishes.
std::vector<bool> closed_rings(const Mesh& mesh) {
  std::vector<std::uint64_t> balance(mesh.positions_m.size());
  for (const Triangle& t : mesh.triangles)
    for (std::size_t c = 0; c < 3; ++c) balance[t[c]] += split_mix(t[(c + 1) % 3]) - split_mix(t[(c + 2) % 3]);
  std::vector<bool> closed(balance.size());
  for (std::size_t v = 0; v < balance.size(); ++v) closed[v] = balance[v] == 0;
  return closed;
}

struct Operator {
  std::vector<Vec3> sum;     // of cot (v - w) over both triangles of each edge
  std::vector<double> area;  // mixed Voronoi areas
};

// One triangle's share. Angles at corners 0, 1, 2; the cotangent at a corner weighs the edge opposite to it.
void add(const Mesh& mesh, const Triangle& t, Operator& into) {
  std::array<double, 3> cotangent{}, square{};
  double doubled_area = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const Vec3 here = mesh.positions_m[t[c]];
    const Vec3 a = mesh.positions_m[t[(c + 1) % 3]] - here, b = mesh.positions_m[t[(c + 2) % 3]] - here;
    doubled_area = norm(cross(a, b));
    cotangent[c] = dot(a, b) / doubled_area;
    const Vec3 opposite = b - a;
    square[c] = dot(opposite, opposite);
  }
  const bool obtuse = std::any_of(cotangent.begin(), cotangent.end(), [](double x) { return x < 0; });
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t n = (c + 1) % 3, p = (c + 2) % 3;
    const Vec3 here = mesh.positions_m[t[c]];
    into.sum[t[c]] += (here - mesh.positions_m[t[n]]) * cotangent[p] + (here - mesh.positions_m[t[p]]) * cotangent[n];
    into.area[t[c]] +=
        obtuse ? doubled_area / (cotangent[c] < 0 ? 4 : 8) : (square[n] * cotangent[n] + square[p] * cotangent[p]) / 8;
  }
}

void fill_open(const Mesh& mesh, const std::vector<bool>& known, std::vector<float>& values) {
  std::vector<float> sum(values.size());
  std::vector<std::uint32_t> count(values.size());
  for (const Triangle& t : mesh.triangles)
    for (std::size_t c = 0; c < 3; ++c)
      for (const std::size_t other : {(c + 1) % 3, (c + 2) % 3})
        if (!known[t[c]] && known[t[other]]) {
          sum[t[c]] += values[t[other]];
          ++count[t[c]];
        }
  for (std::size_t v = 0; v < values.size(); ++v)
    if (!known[v]) values[v] = count[v] > 0 ? sum[v] / static_cast<float>(count[v]) : 0.0f;
}

}  // namespace

std::vector<float> mean_curvature_per_m(const Mesh& mesh) {
  std::vector<bool> known = closed_rings(mesh);
  Operator laplace{std::vector<Vec3>(known.size()), std::vector<double>(known.size())};
  for (const Triangle& t : mesh.triangles) add(mesh, t, laplace);
  std::vector<Vec3> averaged;
  if (mesh.normals.empty()) averaged = averaged_normals(mesh.positions_m, mesh.triangles);
  const std::vector<Vec3>& normals = mesh.normals.empty() ? averaged : mesh.normals;
  std::vector<float> values(known.size());
  for (std::size_t v = 0; v < known.size(); ++v) {
    const double value = -dot(laplace.sum[v], normals[v]) / (4 * laplace.area[v]);
    known[v] = known[v] && laplace.area[v] > 0 && std::isfinite(value);
    values[v] = known[v] ? static_cast<float>(value) : 0.0f;
  }
  fill_open(mesh, known, values);
  return values;
}

}  // namespace gonio::mesh
