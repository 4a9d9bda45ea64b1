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

using Samples = std::array<std::array<std::array<float, 4>, 4>, 4>;  // [z][y][x]; the cell's own at 1 and 2

constexpr float scharr_side = 3.0f / 16, scharr_middle = 10.0f / 16;

// Four numbers along x at once; smoothing and differences along x come last.
using Four = std::array<float, 4>;
Four smooth(const Four& a, const Four& b, const Four& c) {
  Four sum;
  for (std::size_t n = 0; n < 4; ++n) sum[n] = scharr_side * (a[n] + c[n]) + scharr_middle * b[n];
  return sum;
}
Four difference(const Four& a, const Four& c, float per) {
  Four rise;
  for (std::size_t n = 0; n < 4; ++n) rise[n] = (c[n] - a[n]) * per;
  return rise;
}
float smooth_along(const Four& v, std::size_t x) {
  return scharr_side * (v[x] + v[x + 2]) + scharr_middle * v[x + 1];
}

void add_gradients(const Samples& samples, const std::array<std::array<float, 2>, 3>& per, Neighbourhood& near) {
  for (std::size_t y = 0; y < 2; ++y) {
    std::array<Four, 4> smoothed, rising;  // along y, by z
    for (std::size_t z = 0; z < 4; ++z) {
      smoothed[z] = smooth(samples[z][y], samples[z][y + 1], samples[z][y + 2]);
      rising[z] = difference(samples[z][y], samples[z][y + 2], per[1][y]);
    }
    for (std::size_t z = 0; z < 2; ++z) {
      const Four both = smooth(smoothed[z], smoothed[z + 1], smoothed[z + 2]);
      const Four along_y = smooth(rising[z], rising[z + 1], rising[z + 2]);
      const Four along_z = difference(smoothed[z], smoothed[z + 2], per[2][z]);
      for (std::size_t x = 0; x < 2; ++x) {
        const std::size_t corner = x + 2 * y + 4 * z;
        near.gradient[0][corner] = (both[x + 2] - both[x]) * per[0][x];
        near.gradient[1][corner] = smooth_along(along_y, x);
        near.gradient[2][corner] = smooth_along(along_z, x);
      }
    }
  }
}

// Trilinear between the corners.
Vec3 gradient_at(const Neighbourhood& near, Vec3 p) {
  Vec3 sum{};
  for (int corner = 0; corner < 8; ++corner) {
    const double weight =
        ((corner & 1) != 0 ? p.x : 1 - p.x) * ((corner & 2) != 0 ? p.y : 1 - p.y) * ((corner & 4) != 0 ? p.z : 1 - p.z);
    sum += weight * near.gradient_at(corner);
  }
  return sum;
}

}  // namespace

Vec3 Neighbourhood::gradient_at(int corner) const {
  const auto c = static_cast<std::size_t>(corner);
  return {static_cast<double>(gradient[0][c]), static_cast<double>(gradient[1][c]),
          static_cast<double>(gradient[2][c])};
}

Neighbourhood neighbourhood(const RowsRound& rows, std::size_t column) {
  Neighbourhood near;
  near.missing = rows.missing;
  const std::size_t width = rows.width;
  Samples samples;
  std::array<std::array<float, 2>, 3> per{std::array{0.5f, 0.5f}, rows.per_y, rows.per_z};
  if (column >= 2 && column + 1 < width) {
    for (std::size_t z = 0; z < 4; ++z)
      for (std::size_t y = 0; y < 4; ++y)
        for (std::size_t x = 0; x < 4; ++x) samples[z][y][x] = rows.row[z][y][column - 2 + x];
  } else {
    if (column == 0) near.missing |= 0x55;
    if (column == width) near.missing |= 0xaa;
    std::array<std::size_t, 4> from{};
    for (std::size_t x = 0; x < 4; ++x) from[x] = std::min(column + x < 2 ? 0 : column + x - 2, width - 1);
    per[0] = {from[2] - from[0] == 2 ? 0.5f : 1.0f, from[3] - from[1] == 2 ? 0.5f : 1.0f};
    for (std::size_t z = 0; z < 4; ++z)
      for (std::size_t y = 0; y < 4; ++y)
        for (std::size_t x = 0; x < 4; ++x) samples[z][y][x] = rows.row[z][y][from[x]];
  }
  for (std::size_t c = 0; c < 8; ++c) near.value[c] = samples[1 + (c >> 2)][1 + (c >> 1 & 1)][1 + (c & 1)];
  add_gradients(samples, per, near);
  return near;
}

double crossing_parameter(double first, double second, double threshold) {
  const double t = (first - threshold) / (first - second);
  return t >= end_margin ? std::min(t, 1 - end_margin) : end_margin;
}

double crossing_along(const RowsRound& rows, std::size_t column, int axis, double threshold) {
  const int x = axis == 0, high = 1 << axis;
  if ((rows.missing & (1 | 1 << high)) != 0 || column == 0 || (x == 1 && column == rows.width)) return 0.5;
  const std::size_t y = axis == 1 ? 2 : 1, z = axis == 2 ? 2 : 1;
  const float first = rows.row[1][1][column - 1], second = rows.row[z][y][x == 1 ? column : column - 1];
  return crossing_parameter(static_cast<double>(first), static_cast<double>(second), threshold);
}

Crossing crossing(const Neighbourhood& near, int edge, double threshold) {
  const int axis = edge / 4, low = lower_corner(edge), high = upper_corner(edge);
  const bool low_missing = (near.missing >> low & 1) != 0, high_missing = (near.missing >> high & 1) != 0;
  if (low_missing || high_missing)
    return {corner_point(low) + axis_vector(axis, 0.5), axis_vector(axis, low_missing ? -1 : 1)};
  const double first = near.at(low), second = near.at(high);
  const double t = crossing_parameter(first, second, threshold);
  Vec3 outward = -((1 - t) * near.gradient_at(low) + t * near.gradient_at(high));
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
