// board.shape: a board whose corners stand elsewhere than printed, smoothly. Equation: board_shape.h.
#include "camera/mechanisms/board_shape.h"

#include "mechanism/mechanism.h"

namespace gonio::mechanism {
namespace {

std::vector<Parameter> coefficients() {
  std::vector<Parameter> parameters;
  for (const equation::BoardShapeTerm& term : equation::board_shape_terms) {
    const bool height = term.axis == 2;
    const char* what = height ? "height" : term.axis == 0 ? "shift along the columns" : "shift along the rows";
    parameters.push_back(
        {.name = std::string(term.name),
         .unit = "m",
         .lower = height ? -0.01 : -0.002,
         .upper = height ? 0.01 : 0.002,
         .typical = height ? 1e-4 : 3e-5,
         .meaning = std::string(what) + ": P" + std::to_string(term.i) + "(x) P" + std::to_string(term.j) + "(y)"});
  }
  return parameters;
}

}  // namespace

const Mechanism& board_shape() {
  static const Mechanism declaration{
      .id = "board.shape",
      .sentence =
          "The corners of the calibration board do not stand where they should: the board is bent more than a plain "
          "sag, and its print is stretched unevenly.",
      .typical = "heights of 0.02 to 0.5 mm, shifts of 5 to 50 um",
      .equation =
          "(x, y, z) += sum of coefficient Pi(x) Pj(y), Legendre's polynomials over x, y in [-1, 1] of the board's "
          "inner corners; heights with 2 <= i + j <= 4, shifts within the board with 2 <= i + j <= 3",
      .source =
          "Lavest, Viala & Dhome, Do we really need an accurate calibration pattern to achieve a reliable camera "
          "calibration?, ECCV 1998 (corners free in the adjustment); Strobl & Hirzinger, ICCV Workshops 2011",
      .stage = "board",
      .target = Target::board,
      .domains = {"boards"},
      .parameters = coefficients(),
      .conditions = {"board.x", "board.y", "board.radius"},
      .mistaken_for = {{.with = "board.warp", .told_apart = "lay a straight edge on the board along both diagonals"},
                       {.with = "lens.radial",
                        .told_apart = "turn the board by 90 degrees, photograph it at two ranges"},
                       {.with = "lens.thin-prism", .told_apart = "turn the board by 90 degrees"},
                       {.with = "lens.non-central", .told_apart = "turn the board by 90 degrees"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
