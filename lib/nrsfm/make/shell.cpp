// Equilibrium of shells: the matrix of second derivatives and Newton's method (shell.h).
#include "nrsfm/make/shell.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <set>

namespace gonio::nrsfm {
namespace {

constexpr int gauss_newton_steps = 6;  // they are cheaper, and robust far from the equilibrium

}  // namespace

// Only free vertices have places in the matrix, in compressed columns of 3 x 3 blocks: the three columns of a vertex
// hold the rows of its neighbours in rising order.
void Shell::lay_out() {
  laid_out_for_ = fixed;
  free_.clear();
  std::vector<int> place(fixed.size(), -1);
  for (std::size_t v = 0; v < fixed.size(); ++v)
    if (!fixed[v]) place[v] = static_cast<int>(free_.size()), free_.push_back(static_cast<Eigen::Index>(v));
  std::vector<std::set<int>> near(free_.size());
  const auto meet = [&](const auto& vertices) {
    for (const std::uint32_t a : vertices)
      for (const std::uint32_t b : vertices)
        if (place[a] >= 0 && place[b] >= 0) near[static_cast<std::size_t>(place[b])].insert(place[a]);
  };
  for (const auto& t : triangles_) meet(t);
  for (const Hinge& h : hinges_) meet(h.v);
  for (const Bond& bond : bonds) meet(std::array{bond.a, bond.b});
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<std::vector<int>> rows(free_.size());
  std::vector<int> first_block(free_.size());
  blocks_.clear();
  int start = 0;
  for (std::size_t j = 0; j < rows.size(); ++j) {
    rows[j].assign(near[j].begin(), near[j].end());
    first_block[j] = static_cast<int>(blocks_.size());
    const int degree = static_cast<int>(rows[j].size());
    for (int p = 0; p < degree; ++p) blocks_.push_back({start + 3 * p, 3 * degree});
    for (const int i : rows[j])
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) entries.emplace_back(3 * i + r, 3 * static_cast<int>(j) + c, 0.0);
    start += 9 * degree;
  }
  const auto size = static_cast<Eigen::Index>(3 * free_.size());
  matrix_.resize(size, size);
  matrix_.setFromTriplets(entries.begin(), entries.end());
  const auto block = [&](std::uint32_t a, std::uint32_t b) {
    if (place[a] < 0 || place[b] < 0) return -1;
    const auto& row = rows[static_cast<std::size_t>(place[b])];
    const auto at = std::lower_bound(row.begin(), row.end(), place[a]) - row.begin();
    return first_block[static_cast<std::size_t>(place[b])] + static_cast<int>(at);
  };
  for (std::size_t k = 0; k < triangles_.size(); ++k)
    for (std::size_t i = 0; i < 9; ++i) triangle_[k].slot[i] = block(triangles_[k][i / 3], triangles_[k][i % 3]);
  for (Hinge& h : hinges_)
    for (std::size_t i = 0; i < 16; ++i) h.slot[i] = block(h.v[i / 4], h.v[i % 4]);
  bonded_.clear();
  for (const Bond& b : bonds) bonded_.push_back({block(b.a, b.a), block(b.a, b.b), block(b.b, b.a), block(b.b, b.b)});
  solver_.analyzePattern(matrix_);
}

void Shell::add(int block, const Eigen::Matrix3d& value) {
  if (block < 0) return;
  const Block& at = blocks_[static_cast<std::size_t>(block)];
  double* values = matrix_.valuePtr() + at.first;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) values[c * at.stride + r] += value(r, c);
}

// d(A F S n_i) / dx_j, S linear in the strain, whose change is the symmetric part of n_j (F' dx)'.
void Shell::assemble_membrane(const Eigen::Matrix3Xd& x) {
  const double nu = material_.poisson;
  for (std::size_t k = 0; k < triangles_.size(); ++k) {
    const Element& e = triangle_[k];
    const Eigen::Matrix<double, 3, 2> f = deformation(k, x);
    const Eigen::Matrix2d s = stress(f);
    const Eigen::Matrix3d ff = f * f.transpose();
    const double c = e.area * material_.young_pa * material_.thickness_m / (1 - nu * nu);
    std::array<Eigen::Vector3d, 3> fn;
    for (std::size_t i = 0; i < 3; ++i) fn[i] = f * e.slope[i];
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        Eigen::Matrix3d h = c * ((1 - nu) / 2 * (fn[j] * fn[i].transpose() + e.slope[i].dot(e.slope[j]) * ff) +
                                 nu * fn[i] * fn[j].transpose());
        h.diagonal().array() += e.area * e.slope[i].dot(s * e.slope[j]);
        add(e.slot[3 * i + j], h);
      }
    }
  }
}

// Second derivatives of the angle by central differences of its gradient, made symmetric.
void Shell::add_curvature(const Hinge& h, std::array<Eigen::Vector3d, 4> corner, double moment) {
  const double step = 1e-5 * (corner[1] - corner[0]).norm();
  std::array<Eigen::Vector3d, 4> up, down;
  Eigen::Matrix<double, 12, 12> second;
  for (std::size_t j = 0; j < 4; ++j) {
    for (int axis = 0; axis < 3; ++axis) {
      const double kept = corner[j](axis);
      corner[j](axis) = kept + step;
      hinge_angle(corner, &up);
      corner[j](axis) = kept - step;
      hinge_angle(corner, &down);
      corner[j](axis) = kept;
      for (std::size_t i = 0; i < 4; ++i)
        second.block<3, 1>(3 * static_cast<int>(i), 3 * static_cast<int>(j) + axis) = (up[i] - down[i]) / (2 * step);
    }
  }
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      const int r = 3 * static_cast<int>(i), c = 3 * static_cast<int>(j);
      add(h.slot[4 * i + j], moment / 2 * (second.block<3, 3>(r, c) + second.block<3, 3>(c, r).transpose()));
    }
  }
}

void Shell::assemble_rest(const Eigen::Matrix3Xd& x, bool exact) {
  std::array<Eigen::Vector3d, 4> turn;
  for (const Hinge& h : hinges_) {
    if (!holds(h)) continue;
    const std::array<Eigen::Vector3d, 4> corner{x.col(h.v[0]), x.col(h.v[1]), x.col(h.v[2]), x.col(h.v[3])};
    const double angle = hinge_angle(corner, &turn) - h.rest;
    for (std::size_t i = 0; i < 16; ++i) add(h.slot[i], h.stiffness * turn[i / 4] * turn[i % 4].transpose());
    if (exact) add_curvature(h, corner, h.stiffness * angle);
  }
  for (std::size_t b = 0; b < bonds.size(); ++b) {
    if (bonds[b].broken) continue;
    const Eigen::Matrix3d k = bonds[b].stiffness_n_m * Eigen::Matrix3d::Identity();
    add(bonded_[b][0], k), add(bonded_[b][1], -k), add(bonded_[b][2], -k), add(bonded_[b][3], k);
  }
  if (gas_nm <= 0) return;
  const double pressure = outside_pa - gas_nm / volume(x);  // V = sum a . (b x c) / 6
  for (std::size_t k = 0; k < triangles_.size(); ++k) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3, l = (i + 2) % 3;
      const Eigen::Vector3d c = pressure / 6 * x.col(triangles_[k][l]);
      Eigen::Matrix3d cross;  // d(b x c) / db = -[c]
      cross << 0, c.z(), -c.y(), -c.z(), 0, c.x(), c.y(), -c.x(), 0;
      add(triangle_[k].slot[3 * i + j], cross);
      add(triangle_[k].slot[3 * j + i], cross.transpose());
    }
  }
}

// -(H + shift + c/V^2 v v')^-1 gradient, v the gradient of the volume; all of the free vertices.
Eigen::VectorXd Shell::downhill(const Eigen::Matrix3Xd& x, const Eigen::VectorXd& gradient, bool exact) {
  std::fill(matrix_.valuePtr(), matrix_.valuePtr() + matrix_.nonZeros(), 0.0);
  assemble_membrane(x);
  assemble_rest(x, exact);
  const double typical = matrix_.diagonal().mean(), least = 1e-7 * typical;
  shift_ = shift_ < least ? 0 : shift_ / 4;
  for (int attempt = 0; attempt < 40; ++attempt) {
    solver_.setShift(shift_);
    solver_.factorize(matrix_);
    if (solver_.info() == Eigen::Success) break;
    shift_ = std::max(8 * shift_, least);
  }
  Eigen::VectorXd step = -solver_.solve(gradient);
  if (gas_nm <= 0) return step;
  const Eigen::VectorXd u = volume_gradient(x)(Eigen::all, free_).reshaped(), hu = solver_.solve(u);
  const double volume_now = volume(x), c = gas_nm / (volume_now * volume_now);
  step -= hu * (c * u.dot(step) / (1 + c * u.dot(hu)));
  return step;
}

// Shorter steps until one leads downhill; longer ones while they lead farther, where the shift has made them short.
// Returns the energy.
double Shell::search(Eigen::Matrix3Xd& x, double before, const Eigen::VectorXd& step, double slope) const {
  const double noise = 1e-13 * (std::abs(before) + std::abs(slope));
  const auto at = [&](double share) {
    Eigen::Matrix3Xd trial = x;
    trial(Eigen::all, free_) += share * step.reshaped(3, step.size() / 3);
    return trial;
  };
  double share = 1, after = energy(at(1));
  while (!(after <= before + 1e-4 * share * slope + noise) && share > 1e-9) after = energy(at(share /= 2));
  while (shift_ > 0 && share >= 1 && share < 1000) {
    const double farther = energy(at(2 * share));
    if (!(farther < after - noise)) break;
    share *= 2, after = farther;
  }
  x = at(share);
  return after;
}

Equilibrium Shell::settle(Eigen::Matrix3Xd& x, double tolerance, int most_iterations) {
  if (laid_out_for_ != fixed) lay_out();
  Equilibrium result;
  Eigen::VectorXd magnitude;
  double before = energy(x);
  while (true) {
    const Eigen::Matrix3Xd g = gradient(x, &magnitude)(Eigen::all, free_);
    result.residual_n = g.colwise().norm().maxCoeff();
    result.scale_n = magnitude.maxCoeff();
    result.converged = result.residual_n <= tolerance * result.scale_n;
    if (result.converged || result.iterations == most_iterations) return result;
    ++result.iterations;
    const Eigen::VectorXd flat = g.reshaped();
    const Eigen::VectorXd step = downhill(x, flat, result.iterations > gauss_newton_steps);
    before = search(x, before, step, flat.dot(step));
  }
}

}  // namespace gonio::nrsfm
