// See signature.h: scores against the noise that is stated, where a problem says that it holds. Signs of blocks need no
// noise model, and have no power where few blocks carry an effect.
#include <algorithm>

#include "inference/signature.h"
#include "linear/blocks.h"
#include "stats/distributions.h"

namespace gonio::inference {

double stated_noise_p(const Projection& p, const Structures& structures) {
  double least = 1, looks = 0;
  for (std::size_t s = 0; s < structures.list.size(); ++s) {
    if (structures.list[s].kind == Structure::Kind::negative_control) continue;
    std::vector<Eigen::Index> kept;
    for (const Eigen::Index c : p.foreign(structures, s))
      if (p.surviving(c, c) > visible_share * visible_share * p.full(c, c)) kept.push_back(c);
    if (kept.empty()) continue;
    const Eigen::VectorXd scale = p.surviving.diagonal()(kept).cwiseSqrt().cwiseInverse();
    const Eigen::VectorXd score = scale.cwiseProduct(p.score(kept));
    const linear::EigenPairs eigen =
        linear::eigen_of(scale.asDiagonal() * p.surviving(kept, kept) * scale.asDiagonal());
    double squares = 0, rank = 0;
    for (Eigen::Index k = 0; k < eigen.values.size(); ++k) {
      if (!(eigen.values[k] > 1e-6)) continue;
      const double along = eigen.vectors.col(k).dot(score);
      squares += along * along / eigen.values[k], rank += 1;
    }
    least = std::min(least, rank > 0 ? stats::chi2_upper(squares, rank) : 1.0);
    looks += 1;
  }
  return looks > 0 ? stats::sidak(least, looks) : 1;
}

}  // namespace gonio::inference
