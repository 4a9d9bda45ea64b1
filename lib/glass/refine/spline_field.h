// A body as a smooth function of space: positive inside, about the distance from its surface, given by cubic B-splines
// on a grid. Lengths are in cells of the grid, whose node (0, 0, 0) is the origin of "cell coordinates".
//
// The surface is where the function is zero; its outward normal is -slope / |slope|. Value, slope and curvature at a
// point depend on the 64 coefficients round it, linearly: that is what makes every measurement of the surface a row of
// a linear system (normal_equations.h).
#pragma once
#include <array>
#include <functional>
#include <vector>

#include "geom/vector.h"

namespace gonio::glass {

class SplineField {
 public:
  using Size = std::array<int, 3>;
  SplineField(Vec3 low_m, double cell_m, Size nodes);

  Vec3 cells(Vec3 point_m) const { return (point_m - low_m_) / cell_m_; }
  Vec3 metres(Vec3 cells) const { return low_m_ + cells * cell_m_; }
  Vec3 low_m() const { return low_m_; }
  double cell_m() const { return cell_m_; }
  Size nodes() const { return nodes_; }
  std::size_t size() const { return coefficients.size(); }
  std::size_t index(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * static_cast<std::size_t>(nodes_[1]) + static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(nodes_[0]) +
           static_cast<std::size_t>(i);
  }
  // Coefficients from values at the nodes (cells): a quasi-interpolation, which smooths by a third of a cell.
  void fill(const std::function<double(Vec3 point_m)>& value_cells);

  // The 64 coefficients that a point depends on, and how. Points beyond the outermost full cells are moved there.
  struct Support {
    std::size_t first = 0;
    std::array<std::array<double, 4>, 3> weight{}, slope{}, curve{};  // along x, y, z
  };
  Support support(Vec3 point) const;

  struct Jet {
    double value = 0;
    Vec3 slope{};
    Mat3 curve{{0, 0, 0, 0, 0, 0, 0, 0, 0}};
  };
  double value(Vec3 point) const;
  Jet jet(Vec3 point) const;

  // Value and slope at a point of the function with other coefficients (a change), and the transposed operation.
  std::array<double, 4> gather(const Support& at, const std::vector<double>& of) const;
  void scatter(const Support& at, const std::array<double, 4>& amounts, std::vector<double>& to) const;
  // Adds to `to`, for each coefficient, the square of what the functional `amounts` weighs it with.
  void scatter_squares(const Support& at, const std::array<double, 4>& amounts, std::vector<double>& to) const;

  std::vector<double> coefficients;

 private:
  template <class Visit>
  void visit(const Support& at, const Visit& visit) const;

  Vec3 low_m_;
  double cell_m_;
  Size nodes_;
};

}  // namespace gonio::glass
