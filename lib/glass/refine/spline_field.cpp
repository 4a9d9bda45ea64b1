// See spline_field.h. Uniform cubic B-splines: de Boor 1978, "A Practical Guide to Splines", chapter IX.
#include "glass/refine/spline_field.h"

#include <algorithm>
#include <cmath>

namespace gonio::glass {

SplineField::SplineField(Vec3 low_m, double cell_m, Size nodes)
    : coefficients(static_cast<std::size_t>(nodes[0]) * static_cast<std::size_t>(nodes[1]) *
                   static_cast<std::size_t>(nodes[2])),
      low_m_(low_m),
      cell_m_(cell_m),
      nodes_(nodes) {}

void SplineField::fill(const std::function<double(Vec3)>& value_cells) {
  for (int k = 0; k < nodes_[2]; ++k)
    for (int j = 0; j < nodes_[1]; ++j)
      for (int i = 0; i < nodes_[0]; ++i)
        coefficients[index(i, j, k)] =
            value_cells(metres({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}));
}

SplineField::Support SplineField::support(Vec3 point) const {
  Support at;
  std::array<int, 3> low{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double u = std::clamp(point[static_cast<int>(axis)], 1.0, nodes_[axis] - 2.0 - 1e-9);
    const int cell = static_cast<int>(u);
    const double t = u - cell, s = 1 - t;
    low[axis] = cell - 1;
    at.weight[axis] = {s * s * s / 6, (3 * t * t * t - 6 * t * t + 4) / 6, (3 * s * s * s - 6 * s * s + 4) / 6,
                       t * t * t / 6};
    at.slope[axis] = {-s * s / 2, (3 * t * t - 4 * t) / 2, (4 * s - 3 * s * s) / 2, t * t / 2};
    at.curve[axis] = {s, 3 * t - 2, 3 * s - 2, t};
  }
  at.first = index(low[0], low[1], low[2]);
  return at;
}

// visit(place of the coefficient, i, j, k) for all 64.
template <class Visit>
void SplineField::visit(const Support& at, const Visit& visit) const {
  const auto row = static_cast<std::size_t>(nodes_[0]), layer = row * static_cast<std::size_t>(nodes_[1]);
  for (std::size_t k = 0; k < 4; ++k)
    for (std::size_t j = 0; j < 4; ++j)
      for (std::size_t i = 0; i < 4; ++i) visit(at.first + k * layer + j * row + i, i, j, k);
}

double SplineField::value(Vec3 point) const {
  const Support at = support(point);
  const auto row = static_cast<std::size_t>(nodes_[0]), layer = row * static_cast<std::size_t>(nodes_[1]);
  const auto& x = at.weight[0];
  double sum = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    double plane = 0;
    for (std::size_t j = 0; j < 4; ++j) {
      const double* c = &coefficients[at.first + k * layer + j * row];
      plane += at.weight[1][j] * (c[0] * x[0] + c[1] * x[1] + c[2] * x[2] + c[3] * x[3]);
    }
    sum += at.weight[2][k] * plane;
  }
  return sum;
}

SplineField::Jet SplineField::jet(Vec3 point) const {
  const Support at = support(point);
  const auto &w = at.weight, &d = at.slope, &e = at.curve;
  Jet jet;
  double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
  visit(at, [&](std::size_t place, std::size_t i, std::size_t j, std::size_t k) {
    const double c = coefficients[place];
    jet.value += c * w[0][i] * w[1][j] * w[2][k];
    jet.slope += Vec3{d[0][i] * w[1][j] * w[2][k], w[0][i] * d[1][j] * w[2][k], w[0][i] * w[1][j] * d[2][k]} * c;
    xx += c * e[0][i] * w[1][j] * w[2][k], yy += c * w[0][i] * e[1][j] * w[2][k];
    zz += c * w[0][i] * w[1][j] * e[2][k], xy += c * d[0][i] * d[1][j] * w[2][k];
    xz += c * d[0][i] * w[1][j] * d[2][k], yz += c * w[0][i] * d[1][j] * d[2][k];
  });
  jet.curve = Mat3{{xx, xy, xz, xy, yy, yz, xz, yz, zz}};
  return jet;
}

// One axis after the other: lines, planes, the whole.
std::array<double, 4> SplineField::gather(const Support& at, const std::vector<double>& of) const {
  const auto row = static_cast<std::size_t>(nodes_[0]), layer = row * static_cast<std::size_t>(nodes_[1]);
  const auto &w = at.weight, &d = at.slope;
  std::array<double, 4> sum{};
  for (std::size_t k = 0; k < 4; ++k) {
    double plain = 0, along_x = 0, along_y = 0;
    for (std::size_t j = 0; j < 4; ++j) {
      const double* c = &of[at.first + k * layer + j * row];
      const double line = c[0] * w[0][0] + c[1] * w[0][1] + c[2] * w[0][2] + c[3] * w[0][3];
      const double slope = c[0] * d[0][0] + c[1] * d[0][1] + c[2] * d[0][2] + c[3] * d[0][3];
      plain += line * w[1][j], along_x += slope * w[1][j], along_y += line * d[1][j];
    }
    sum[0] += plain * w[2][k], sum[1] += along_x * w[2][k], sum[2] += along_y * w[2][k], sum[3] += plain * d[2][k];
  }
  return sum;
}

void SplineField::scatter(const Support& at, const std::array<double, 4>& amounts, std::vector<double>& to) const {
  const auto row = static_cast<std::size_t>(nodes_[0]), layer = row * static_cast<std::size_t>(nodes_[1]);
  const auto &w = at.weight, &d = at.slope;
  for (std::size_t k = 0; k < 4; ++k) {
    const double plain = amounts[0] * w[2][k] + amounts[3] * d[2][k];
    const double along_x = amounts[1] * w[2][k], along_y = amounts[2] * w[2][k];
    for (std::size_t j = 0; j < 4; ++j) {
      double* c = &to[at.first + k * layer + j * row];
      const double line = plain * w[1][j] + along_y * d[1][j], slope = along_x * w[1][j];
      for (std::size_t i = 0; i < 4; ++i) c[i] += line * w[0][i] + slope * d[0][i];
    }
  }
}

void SplineField::scatter_squares(const Support& at, const std::array<double, 4>& amounts,
                                  std::vector<double>& to) const {
  const auto &w = at.weight, &d = at.slope;
  visit(at, [&](std::size_t place, std::size_t i, std::size_t j, std::size_t k) {
    const double v =
        w[2][k] * (w[1][j] * (amounts[0] * w[0][i] + amounts[1] * d[0][i]) + amounts[2] * w[0][i] * d[1][j]) +
        amounts[3] * w[0][i] * w[1][j] * d[2][k];
    to[place] += v * v;
  });
}

}  // namespace gonio::glass
