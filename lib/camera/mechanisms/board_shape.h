// Where the corners of a board truly are, as a smooth field over it: board.shape. Board frame, metres; xi and eta in
// [-1, 1] over the rectangle of the inner corners, as for board.warp.
//
//   (x, y, z) += sum over the terms of coefficient * P_i(xi) P_j(eta) along the term's axis
//
// P_i are Legendre's polynomials. Heights z have 2 <= i + j <= 4, places within the board (a print that is stretched
// unevenly) 2 <= i + j <= 3: what is missing moves, tilts or scales the board as a whole, or is board.scale.
#pragma once
#include <array>
#include <cstddef>
#include <string_view>

#include "geom/vector.h"

namespace gonio::equation {

struct BoardShapeTerm {
  std::string_view name;
  int axis, i, j;  // axis 0: x, 1: y, 2: z
};
inline constexpr std::array<BoardShapeTerm, 26> board_shape_terms = {
    {{"z20_m", 2, 2, 0}, {"z11_m", 2, 1, 1}, {"z02_m", 2, 0, 2}, {"z30_m", 2, 3, 0}, {"z21_m", 2, 2, 1},
     {"z12_m", 2, 1, 2}, {"z03_m", 2, 0, 3}, {"z40_m", 2, 4, 0}, {"z31_m", 2, 3, 1}, {"z22_m", 2, 2, 2},
     {"z13_m", 2, 1, 3}, {"z04_m", 2, 0, 4}, {"x20_m", 0, 2, 0}, {"x11_m", 0, 1, 1}, {"x02_m", 0, 0, 2},
     {"x30_m", 0, 3, 0}, {"x21_m", 0, 2, 1}, {"x12_m", 0, 1, 2}, {"x03_m", 0, 0, 3}, {"y20_m", 1, 2, 0},
     {"y11_m", 1, 1, 1}, {"y02_m", 1, 0, 2}, {"y30_m", 1, 3, 0}, {"y21_m", 1, 2, 1}, {"y12_m", 1, 1, 2},
     {"y03_m", 1, 0, 3}}};

// P_i(xi) P_j(eta) of every term, in their order.
inline std::array<double, board_shape_terms.size()> board_shape_basis(double xi, double eta) {
  const auto legendre = [](double x) {
    return std::array<double, 5>{1, x, (3 * x * x - 1) / 2, (5 * x * x - 3) * x / 2,
                                 ((35 * x * x - 30) * x * x + 3) / 8};
  };
  const std::array<double, 5> p = legendre(xi), q = legendre(eta);
  std::array<double, board_shape_terms.size()> basis{};
  for (std::size_t k = 0; k < basis.size(); ++k)
    basis[k] =
        p[static_cast<std::size_t>(board_shape_terms[k].i)] * q[static_cast<std::size_t>(board_shape_terms[k].j)];
  return basis;
}

// Displacement of the corner at (xi, eta), m; `coefficients`: one for each term.
inline Vec3 board_shape(const double* coefficients, double xi, double eta) {
  const auto basis = board_shape_basis(xi, eta);
  std::array<double, 3> shift{};
  for (std::size_t k = 0; k < basis.size(); ++k)
    shift[static_cast<std::size_t>(board_shape_terms[k].axis)] += coefficients[k] * basis[k];
  return {shift[0], shift[1], shift[2]};
}

}  // namespace gonio::equation
