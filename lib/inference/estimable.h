// Which numbers of a hypothesis these recordings can tell at all, before any of them is fitted.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

namespace gonio::inference {

// Signatures are columns: the derivatives of all whitened rows by one parameter. A parameter is estimable where more
// than a share of its column's length is left once what is free, and the parameters of its hypothesis before it, are
// projected out; or where so much is left that a change of it of usual size would be beyond the noise all the same (a
// turn of a projector moves all points by far more than it bends a plane, and bends it by far more than they scatter).
class Estimable {
 public:
  using Column = std::vector<double>;
  explicit Estimable(const std::vector<Column>& free);
  // Places in `own` of those that are. `usual`: sizes of a change, one a column; empty: shares alone count.
  std::vector<std::size_t> kept(const std::vector<Column>& own, double least_share,
                                const std::vector<double>& usual = {}) const;

 private:
  std::vector<Column> basis_;  // orthonormal
};

class Problem;
// A parameter's column at `values`, one per parameter of the problem.
Estimable::Column whitened_slopes(const Problem& problem, std::size_t parameter, std::span<const double> values);

}  // namespace gonio::inference
