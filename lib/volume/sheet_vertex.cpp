#include "volume/sheet_vertex.h"

#include <algorithm>
#include <cmath>

namespace gonio::volume {
namespace {

constexpr double end_margin = 0x1p-7, cell_margin = 0x1p-10, plane_margin = 0x1p-9;

constexpr Vec3 axis_vector(int axis, double length) {
  return {axis == 0 ? length : 0, axis == 1 ? length : 0, axis == 2 ? length : 0};
}

Vec3 corner_point(int corner) {
  return {static_cast<double>(corner & 1), static_cast<double>(corner >> 1 & 1), static_cast<double>(corner >> 2)};
}

bool is_direction(Vec3 v, double& length) {
  length = norm(v);
  return length > 0 && std::isfinite(length);
}

struct Eigen3 {
  std::array<double, 3> value{};
  std::array<Vec3, 3> vector{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
};

// Cyclic Jacobi rotations (Golub & Van Loan, Matrix Computations, 8.5): three by three, this runs once for every
// vertex.
Eigen3 eigen_of_symmetric(Mat3 a) {
  Eigen3 found;
  const double small = 1e-24 * (a(0, 0) + a(1, 1) + a(2, 2)) * (a(0, 0) + a(1, 1) + a(2, 2));
  for (int sweep = 0; sweep < 12; ++sweep) {
    if (a(0, 1) * a(0, 1) + a(0, 2) * a(0, 2) + a(1, 2) * a(1, 2) <= small) break;
    for (int p = 0; p < 2; ++p)
      for (int q = p + 1; q < 3; ++q) {
        if (a(p, q) == 0) continue;
        const double theta = (a(q, q) - a(p, p)) / (2 * a(p, q));
        const double t = std::copysign(1.0, theta) / (std::abs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        const int r = 3 - p - q;
        const double arp = a(r, p), arq = a(r, q);
        a(p, p) -= t * a(p, q);
        a(q, q) += t * a(p, q);
        a(p, q) = a(q, p) = 0;
        a(r, p) = a(p, r) = c * arp - s * arq;
        a(r, q) = a(q, r) = s * arp + c * arq;
        Vec3& vp = found.vector[static_cast<std::size_t>(p)];
        Vec3& vq = found.vector[static_cast<std::size_t>(q)];
        const Vec3 old = vp;
        vp = c * old - s * vq;
        vq = s * old + c * vq;
      }
  }
  found.value = {a(0, 0), a(1, 1), a(2, 2)};
  return found;
}

// The point of least sum of (n_i . (x - p_i))^2; of those that the normals do not tell apart (singular values below
// `share` of the largest) the one nearest to `mean`.
Vec3 least_error(const std::array<Crossing, 12>& crossings, std::size_t count, Vec3 mean, double share) {
  Mat3 a{{}};
  Vec3 right{};
  for (std::size_t n = 0; n < count; ++n) {
    const Vec3 normal = crossings[n].normal;
    const double distance = dot(normal, crossings[n].point - mean);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) a(i, j) += normal[i] * normal[j];
    right += distance * normal;
  }
  const Eigen3 eigen = eigen_of_symmetric(a);
  const double least = share * share * std::max({eigen.value[0], eigen.value[1], eigen.value[2]});
  Vec3 step{};
  for (std::size_t n = 0; n < 3; ++n)
    if (eigen.value[n] > least && eigen.value[n] > 0)
      step += dot(eigen.vector[n], right) / eigen.value[n] * eigen.vector[n];
  return mean + step;
}

// The last point of the way from `inner` to `wanted` that lies in the sheet's region. `inner`, the mean of the
// crossings, does: it is at least 2^-7 / 7 from every face (at least one of at most seven crossings keeps its distance;
// on a loop of more, two do), and at least 2^-7 from the plane, as all of them are.
Vec3 held_within(const Sheet& sheet, Vec3 inner, Vec3 wanted) {
  const Vec3 way = wanted - inner;
  double share = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const bool up = way[axis] > 0;
    const double limit = up ? 1 - cell_margin : cell_margin;
    if (up ? wanted[axis] > limit : wanted[axis] < limit) share = std::min(share, (limit - inner[axis]) / way[axis]);
  }
  const Vec3 plane{static_cast<double>(sheet.plane[0]), static_cast<double>(sheet.plane[1]),
                   static_cast<double>(sheet.plane[2])};
  const double bound = sheet.bound - plane_margin;
  if (plane != Vec3{} && dot(plane, wanted) > bound)
    share = std::min(share, (bound - dot(plane, inner)) / dot(plane, way));
  if (share >= 1) return wanted;
  return inner + std::max(0.0, share) * way;
}

// Trilinear between the corners.
Vec3 gradient_at(const Neighbourhood& near, Vec3 p) {
  Vec3 sum{};
  for (int corner = 0; corner < 8; ++corner) {
    const double weight =
        ((corner & 1) != 0 ? p.x : 1 - p.x) * ((corner & 2) != 0 ? p.y : 1 - p.y) * ((corner & 4) != 0 ? p.z : 1 - p.z);
    sum += weight * near.gradient(corner);
  }
  return sum;
}

}  // namespace

double Neighbourhood::at(int corner) const {
  const auto x = static_cast<std::size_t>(corner & 1), y = static_cast<std::size_t>(corner >> 1 & 1),
             z = static_cast<std::size_t>(corner >> 2);
  return static_cast<double>(value[z + 1][y + 1][x + 1]);
}

Vec3 Neighbourhood::gradient(int corner) const {
  const auto x = static_cast<std::size_t>(corner & 1), y = static_cast<std::size_t>(corner >> 1 & 1),
             z = static_cast<std::size_t>(corner >> 2);
  const auto difference = [](float high, float low) { return static_cast<double>(high) - static_cast<double>(low); };
  return {difference(value[z + 1][y + 1][x + 2], value[z + 1][y + 1][x]) * per[0][x],
          difference(value[z + 1][y + 2][x + 1], value[z + 1][y][x + 1]) * per[1][y],
          difference(value[z + 2][y + 1][x + 1], value[z][y + 1][x + 1]) * per[2][z]};
}

Neighbourhood neighbourhood(const RowsRound& rows, std::size_t column) {
  Neighbourhood near;
  near.missing = rows.missing;
  near.per = {std::array{0.5, 0.5}, rows.per_y, rows.per_z};
  const std::size_t width = rows.width;
  std::array<std::size_t, 4> x{};
  for (std::size_t n = 0; n < 4; ++n) x[n] = std::min(column + n < 2 ? 0 : column + n - 2, width - 1);
  if (column <= 1 || column + 1 >= width) {
    if (column == 0) near.missing |= 0x55;
    if (column == width) near.missing |= 0xaa;
    near.per[0] = {x[2] - x[0] == 2 ? 0.5 : 1.0, x[3] - x[1] == 2 ? 0.5 : 1.0};
  }
  for (std::size_t z = 0; z < 4; ++z)
    for (std::size_t y = 0; y < 4; ++y)
      for (std::size_t n = 0; n < 4; ++n) near.value[z][y][n] = rows.row[z][y][x[n]];
  return near;
}

double crossing_parameter(double first, double second, double threshold) {
  const double t = (first - threshold) / (first - second);
  return t >= end_margin ? std::min(t, 1 - end_margin) : end_margin;
}

Crossing crossing(const Neighbourhood& near, int edge, double threshold) {
  const int axis = edge / 4, low = lower_corner(edge), high = upper_corner(edge);
  const bool low_missing = (near.missing >> low & 1) != 0, high_missing = (near.missing >> high & 1) != 0;
  if (low_missing || high_missing)
    return {corner_point(low) + axis_vector(axis, 0.5), axis_vector(axis, low_missing ? -1 : 1)};
  const double first = near.at(low), second = near.at(high);
  const double t = crossing_parameter(first, second, threshold);
  Vec3 outward = -((1 - t) * near.gradient(low) + t * near.gradient(high));
  // Where the samples beyond contradict the crossing itself (walls and gaps of one voxel), it is right.
  if ((outward[axis] > 0) != (first > second) || outward[axis] == 0)
    outward += axis_vector(axis, first - second - outward[axis]);
  double length = 0;
  const Vec3 normal = is_direction(outward, length) ? outward / length : axis_vector(axis, first > second ? 1 : -1);
  return {corner_point(low) + axis_vector(axis, t), normal};
}

SheetVertex sheet_vertex(const Neighbourhood& near, const Sheet& sheet, const VertexWish& wish) {
  std::array<Crossing, 12> crossings;
  Vec3 mean{}, normals{};
  for (std::size_t n = 0; n < sheet.count; ++n) {
    crossings[n] = crossing(near, sheet.edges[n], wish.threshold);
    mean += crossings[n].point;
    normals += crossings[n].normal;
  }
  mean = mean / sheet.count;
  SheetVertex vertex;
  const Vec3 wanted = wish.hermite ? least_error(crossings, sheet.count, mean, wish.sharpness) : mean;
  vertex.point = held_within(sheet, mean, is_finite(wanted) ? wanted : mean);
  const Vec3 outward = near.missing != 0 ? normals : -gradient_at(near, vertex.point);
  double length = 0;
  if (is_direction(outward, length) && dot(outward, normals) > 0)
    vertex.normal = outward / length;
  else
    vertex.normal = is_direction(normals, length) ? normals / length : crossings[0].normal;
  return vertex;
}

}  // namespace gonio::volume
