// Where board.print puts the corners of a board: beside each other, not all of them together.
//
// One number a_k of every corner k and axis says too much: what shifts or stretches the whole board along the axis is
// its pose and board.scale, and out of its plane a shift or a tilt is its pose. So the corners are displaced by
// d = a - Q Q'a, with Q orthonormal over the board's corners and spanning (1, x) along x, (1, y) along y, (1, x, y) out
// of the plane. A print that is narrower than stated cannot pass for one that is uneven, and the errors of d are those
// of one corner beside the others.
#pragma once
#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

namespace gonio::explain {

class PrintPlaces {
 public:
  PrintPlaces() = default;  // d = a: corners whose displacements are stated
  // `places`: of the corners, whole squares.
  explicit PrintPlaces(std::span<const std::array<long, 2>> places);

  // d(displacement of `corner`) / d(number of `of`), along `axis` of the board.
  double slope(std::size_t axis, std::size_t corner, std::size_t of) const;
  // d of all corners; `a`: their numbers, x, y, z, as many as places.
  std::vector<std::array<double, 3>> displaced(std::vector<std::array<double, 3>> a) const;

 private:
  std::array<Eigen::MatrixXd, 3> common_;  // Q of each axis: corners x (2 or 3), or nothing
};

}  // namespace gonio::explain
