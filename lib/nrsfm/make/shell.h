// Thin elastic shells at rest: what a sheet, a sleeve or a ball does when its rim is led somewhere slowly. Metres,
// newton.
//
// The total energy over the vertices x, its minimum the equilibrium:
//   membrane  A t / 2 S : E          E = (F'F - 1) / 2, S = Y / (1 - nu^2) ((1 - nu) E + nu tr E 1)
//             linear triangles, St. Venant-Kirchhoff, plane stress (Bonet & Wood 2008, chapters 5 and 9)
//   bending   D l^2 / (A1 + A2) (angle - rest angle)^2 / 2       of each inner edge; D = Y t^3 / (12 (1 - nu^2))
//             discrete shells (Grinspun et al. 2003). On a lattice of equilateral triangles the sum is isotropic, that
//             of a plate whose Poisson's ratio in bending is -1/3: D / 2 ((tr K)^2 - 8/3 det K) per area, K the
//             curvature (Seung & Nelson 1988); det K = 0 where sheets hardly stretch. On other lattices vertices find
//             ways around it: right triangles with alternating diagonals bend at 5/6 of D.
//   weight    - sum m_i g . x_i
//   gas       p0 V - c - c ln(p0 V / c)   c = n R T: an ideal gas inside a closed shell, the pressure p0 > 0 outside
//   bonds     k |x_a - x_b|^2 / 2    hold two vertices of the same place together until they are broken
// Newton's method: the first steps leave out the curvature of the angle in the bending term (Gauss-Newton). The gas
// couples all vertices by one dyad (Sherman-Morrison). Where the matrix is not positive definite it is shifted.
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace gonio::nrsfm {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

struct ShellMaterial {
  double young_pa = 1e6, poisson = 0.3, thickness_m = 1e-3, density_kg_m3 = 1000;
  double bending_n_m = 0;  // D; 0: of a homogeneous plate
};

struct Bond {
  std::uint32_t a = 0, b = 0;
  double stiffness_n_m = 0;
  bool broken = false;
};

struct Equilibrium {
  bool converged = false;
  int iterations = 0;
  double residual_n = 0;  // largest force on a free vertex that is not balanced
  double scale_n = 0;     // largest sum of the magnitudes of the forces on a vertex
};

class Shell {
 public:
  // `rest` 3 x V: without stress and at its rest angles. Triangles have an area, edges at most two triangles.
  Shell(const Eigen::Matrix3Xd& rest, const Triangles& triangles, const ShellMaterial& material,
        std::vector<Bond> bonds = {});

  Eigen::Vector3d gravity_m_s2{0, 0, -9.81};
  double gas_nm = 0, outside_pa = 0;  // c and p0; c = 0: no gas
  std::vector<char> fixed;            // one per vertex
  std::vector<Bond> bonds;

  double energy(const Eigen::Matrix3Xd& x) const;
  Eigen::Matrix3Xd gradient(const Eigen::Matrix3Xd& x, Eigen::VectorXd* magnitude = nullptr) const;
  double bond_force(std::size_t bond, const Eigen::Matrix3Xd& x) const {
    return bonds[bond].stiffness_n_m * (x.col(bonds[bond].a) - x.col(bonds[bond].b)).norm();
  }
  double volume(const Eigen::Matrix3Xd& x) const;
  double area(const Eigen::Matrix3Xd& x) const;
  // Moves the free vertices of x to the minimum that lies downhill, until no residual exceeds `tolerance` times scale.
  Equilibrium settle(Eigen::Matrix3Xd& x, double tolerance = 1e-6, int most_iterations = 200);
  const Triangles& triangles() const { return triangles_; }

 private:
  struct Element {
    std::array<Eigen::Vector2d, 3> slope;  // gradients of the shape functions in the plane of rest
    double area = 0;
    std::array<int, 9> slot{};
  };
  struct Hinge {
    std::array<std::uint32_t, 4> v{};  // edge 0-1, opposite corners 2 and 3
    double stiffness = 0, rest = 0;
    int bonds[2] = {-1, -1};  // across a seam: holds while both do
    std::array<int, 16> slot{};
  };
  struct Block {  // where a 3 x 3 block stands among the values of the sparse matrix
    int first = 0, stride = 0;
  };
  bool holds(const Hinge& h) const {
    return h.bonds[0] < 0 ||
           (!bonds[static_cast<std::size_t>(h.bonds[0])].broken && !bonds[static_cast<std::size_t>(h.bonds[1])].broken);
  }
  void find_hinges(const Eigen::Matrix3Xd& rest);
  void lay_out();  // of the sparse matrix, for what is fixed
  void assemble_membrane(const Eigen::Matrix3Xd& x);
  void assemble_rest(const Eigen::Matrix3Xd& x, bool exact);
  void add_curvature(const Hinge& h, std::array<Eigen::Vector3d, 4> corner, double moment);
  double search(Eigen::Matrix3Xd& x, double before, const Eigen::VectorXd& step, double slope) const;
  Eigen::VectorXd downhill(const Eigen::Matrix3Xd& x, const Eigen::VectorXd& gradient, bool exact);
  Eigen::Matrix3Xd volume_gradient(const Eigen::Matrix3Xd& x) const;
  Eigen::Matrix2d stress(const Eigen::Matrix<double, 3, 2>& f) const;
  Eigen::Matrix<double, 3, 2> deformation(std::size_t triangle, const Eigen::Matrix3Xd& x) const;
  void add(int block, const Eigen::Matrix3d& value);

  Triangles triangles_;
  ShellMaterial material_;
  std::vector<Element> triangle_;
  std::vector<Hinge> hinges_;
  Eigen::VectorXd mass_;
  std::vector<Block> blocks_;
  std::vector<std::array<int, 4>> bonded_;  // blocks aa, ab, ba, bb
  Eigen::SparseMatrix<double> matrix_;
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> solver_;
  double shift_ = 0;
  std::vector<Eigen::Index> free_;  // vertices that are not fixed
  std::vector<char> laid_out_for_;
};

// Signed angle between the two triangles of a hinge, 0 where flat, and its gradient.
double hinge_angle(const std::array<Eigen::Vector3d, 4>& x, std::array<Eigen::Vector3d, 4>* gradient = nullptr);

}  // namespace gonio::nrsfm
