#include "volume/contour_shape.h"

#include <Eigen/Core>
#include <algorithm>

#include "linear/solve.h"

namespace gonio::volume {
namespace {

constexpr int rings = 3;
constexpr std::size_t most_members = 64;
constexpr double alike_normals = 0.8;        // cosine: beyond it there is a crease between them
constexpr double sharpest_curvature = 0.35;  // 1 / voxel
constexpr double flat_sd = 0.2;              // 1 / voxel: where little is known, surfaces are flat within this
constexpr double normal_sd = 0.05;           // rad: of a vertex' normal

// A vertex and those up to three edges away whose normals are like its own.
struct Members {
  std::array<std::uint32_t, most_members> vertex{};
  std::size_t count = 0;
  bool add(std::uint32_t v) {
    if (count == most_members || std::find(vertex.begin(), vertex.begin() + count, v) != vertex.begin() + count)
      return false;
    vertex[count++] = v;
    return true;
  }
};

}  // namespace

double area_of(const Contour& contour, Vec3 scale) {
  double area = 0;
  for (const auto& t : contour.triangles) {
    const Vec3 a = vector_of(contour.positions[t[0]]), b = vector_of(contour.positions[t[1]]),
               c = vector_of(contour.positions[t[2]]);
    area += norm(cross((b - a) * scale, (c - a) * scale)) / 2;
  }
  return area;
}

// Every edge of a closed surface is a side of two triangles, once in each direction: one neighbour a side.
ContourShapes::ContourShapes(const Contour& contour, Vec3 scale) : contour_(contour), scale_(scale) {
  first_.assign(contour.positions.size() + 1, 0);
  for (const auto& t : contour.triangles)
    for (const std::uint32_t v : t) ++first_[v + 1];
  for (std::size_t v = 0; v + 1 < first_.size(); ++v) first_[v + 1] += first_[v];
  neighbours_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (const auto& t : contour.triangles)
    for (std::size_t i = 0; i < 3; ++i) neighbours_[next[t[i]]++] = t[(i + 1) % 3];
}

LocalShape ContourShapes::at(std::size_t vertex) const {
  LocalShape shape{normal_of(contour_, vertex, scale_)};
  if (!is_finite(shape.normal)) return shape;
  const Basis basis(shape.normal);
  const Vec3 place = vector_of(contour_.positions[vertex]) * scale_;
  Members members;
  members.add(static_cast<std::uint32_t>(vertex));
  for (std::size_t ring = 0, from = 0; ring < rings; ++ring) {
    const std::size_t until = members.count;
    for (; from < until; ++from) {
      const std::uint32_t v = members.vertex[from];
      for (std::uint32_t n = first_[v]; n < first_[v + 1]; ++n)
        if (dot(normal_of(contour_, neighbours_[n], scale_), shape.normal) > alike_normals) members.add(neighbours_[n]);
    }
  }
  // Unknowns: the normal's two tilts, kuu, kuv, kvv.
  using Five = Eigen::Matrix<double, 5, 1>;
  Eigen::Matrix<double, 5, 5> h = Eigen::Matrix<double, 5, 5>::Zero();
  Five right = Five::Zero();
  for (std::size_t m = 0; m < members.count; ++m) {
    const Vec3 d = basis.to_local(vector_of(contour_.positions[members.vertex[m]]) * scale_ - place);
    const Vec3 n = basis.to_local(normal_of(contour_, members.vertex[m], scale_));
    if (!is_finite(n)) continue;
    Five along, across;
    along << 1, 0, d.x, d.y, 0;
    across << 0, 1, 0, d.x, d.y;
    h += along * along.transpose() + across * across.transpose();
    right += along * (n.x / n.z) + across * (n.y / n.z);
  }
  constexpr double prior = normal_sd * normal_sd / (flat_sd * flat_sd);
  for (const int k : {2, 3, 4}) h(k, k) += prior;
  const Five x = linear::solve_ldlt(h, right);
  const auto held = [](double k) { return std::clamp(k, -sharpest_curvature, sharpest_curvature); };
  shape.kuu = held(x[2]), shape.kuv = held(x[3]), shape.kvv = held(x[4]);
  shape.normal = normalized(basis.to_world({x[0], x[1], 1}));
  return shape;
}

}  // namespace gonio::volume
