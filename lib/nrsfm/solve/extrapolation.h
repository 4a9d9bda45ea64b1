// Faster turns: squared extrapolation of a map that creeps towards its fixed point (Varadhan & Roland, Scandinavian
// Journal of Statistics 35, 2008, scheme S3).
//   theta' = theta - 2 a r + a^2 v,   r = F(theta) - theta,   v = F(F(theta)) - F(theta) - r,   a = -|r| / |v|
// The length -a is between 1 (two plain steps) and a bound that grows where it has been reached and held. The caller
// goes one more step from theta', compares, and keeps the two plain steps where they are better.
#pragma once
#include <Eigen/Core>
#include <algorithm>

namespace gonio::nrsfm {

class Extrapolation {
 public:
  // theta' - theta, from F(theta) - theta and F(F(theta)) - theta. Coordinates should be of like size.
  Eigen::VectorXd operator()(const Eigen::VectorXd& first, const Eigen::VectorXd& second) {
    const Eigen::VectorXd bend = second - 2 * first;
    length_ = std::clamp(first.norm() / std::max(bend.norm(), 1e-300), 1.0, most_);
    return 2 * length_ * first + length_ * length_ * bend;
  }
  void judge(bool better) {
    if (better && length_ == most_) most_ *= 4;
    if (!better) most_ = std::max(1.0, length_ / 4);
  }

 private:
  double length_ = 1, most_ = 4;
};

}  // namespace gonio::nrsfm
