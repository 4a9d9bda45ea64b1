// See print_places.h.
#include "explain/boards/print_places.h"

#include "linear/blocks.h"

namespace gonio::explain {

PrintPlaces::PrintPlaces(std::span<const std::array<long, 2>> places) {
  const auto corners = static_cast<Eigen::Index>(places.size());
  Eigen::MatrixXd all(corners, 3);
  for (Eigen::Index k = 0; k < corners; ++k) {
    const std::array<long, 2>& at = places[static_cast<std::size_t>(k)];
    all.row(k) << static_cast<double>(at[0]), 1, static_cast<double>(at[1]);
  }
  common_ = {linear::basis_of(all.leftCols(2)), linear::basis_of(all.rightCols(2)), linear::basis_of(all)};
}

double PrintPlaces::slope(std::size_t axis, std::size_t corner, std::size_t of) const {
  const double own = corner == of ? 1 : 0;
  const Eigen::MatrixXd& q = common_[axis];
  if (q.size() == 0) return own;
  return own - q.row(static_cast<Eigen::Index>(corner)).dot(q.row(static_cast<Eigen::Index>(of)));
}

std::vector<std::array<double, 3>> PrintPlaces::displaced(std::vector<std::array<double, 3>> a) const {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Eigen::MatrixXd& q = common_[axis];
    if (q.size() == 0) continue;
    Eigen::VectorXd own(q.rows());
    for (Eigen::Index k = 0; k < q.rows(); ++k) own[k] = a[static_cast<std::size_t>(k)][axis];
    own -= q * (q.transpose() * own).eval();
    for (Eigen::Index k = 0; k < q.rows(); ++k) a[static_cast<std::size_t>(k)][axis] = own[k];
  }
  return a;
}

}  // namespace gonio::explain
