// Isolability, judged before any residual is looked at: what of a mechanism's signature survives the free parameters,
// which amplitude could be seen, and which mechanisms look alike in these very recordings.
#include <algorithm>
#include <cmath>

#include "explain/signature.h"
#include "stats/intervals.h"

namespace gonio::explain {
namespace {

constexpr double look_alike = 0.9;  // |cos| beyond which two signatures cannot be told apart
constexpr double invisible_share = 1e-3;

// G^-1/2 on the range of G.
Eigen::MatrixXd inverse_root(const Eigen::MatrixXd& gram) {
  const Eigen::VectorXd scale = gram.diagonal().unaryExpr([](double d) { return d > 0 ? 1 / std::sqrt(d) : 0.0; });
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scale.asDiagonal() * gram * scale.asDiagonal());
  const Eigen::VectorXd root =
      eigen.eigenvalues().unaryExpr([](double v) { return v > 1e-9 ? 1 / std::sqrt(v) : 0.0; });
  return scale.asDiagonal() * eigen.eigenvectors() * root.asDiagonal();
}

// How much of the smaller of two subspaces the other can imitate: root mean square of the canonical correlations.
double cosine(const Projection& p, const std::vector<Eigen::Index>& a, const std::vector<Eigen::Index>& b) {
  const Eigen::MatrixXd ga = p.surviving(a, a), gb = p.surviving(b, b);
  const Eigen::MatrixXd c = inverse_root(ga).transpose() * p.surviving(a, b) * inverse_root(gb);
  const double rank = static_cast<double>(std::min(a.size(), b.size()));
  return std::min(1.0, std::sqrt(c.squaredNorm() / rank));
}

}  // namespace

std::vector<Isolability> isolability(const System& system, const Projection& p, const Structures& structures,
                                     double level) {
  std::vector<Isolability> result;
  std::vector<std::vector<Eigen::Index>> places;
  for (std::size_t s = 0; s < structures.list.size(); ++s) {
    if (structures.list[s].kind != Structure::Kind::mechanism) continue;
    Isolability entry;
    entry.candidate = structures.list[s].index;
    places.push_back(p.foreign(structures, s));
    const std::vector<Eigen::Index>& own = places.back();
    const Eigen::MatrixXd root = inverse_root(p.full(own, own));
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> shares(root.transpose() * p.surviving(own, own) * root);
    entry.surviving_share = own.empty() ? 0 : std::sqrt(std::clamp(shares.eigenvalues().maxCoeff(), 0.0, 1.0));
    entry.visible = false;
    const Candidate& candidate = system.problem().candidates()[entry.candidate];
    for (std::size_t k = 0; k < own.size(); ++k) {
      const double length = p.surviving(own[k], own[k]);
      const Parameter& parameter = system.problem().parameters()[candidate.parameters[k]];
      const double limit =
          length > 0 ? stats::detectable_z(level, 0.8) / std::sqrt(length) : std::numeric_limits<double>::infinity();
      entry.detection_limit.push_back(limit);
      const double reach = std::max(parameter.upper - parameter.neutral, parameter.neutral - parameter.lower);
      if (limit < reach && entry.surviving_share > invisible_share) entry.visible = true;
    }
    result.push_back(std::move(entry));
  }
  for (std::size_t a = 0; a < result.size(); ++a)
    for (std::size_t b = 0; b < result.size(); ++b) {
      if (a == b || !result[a].visible || !result[b].visible) continue;
      const double c = cosine(p, places[a], places[b]);
      if (c > look_alike) result[a].look_alikes.emplace_back(result[b].candidate, c);
    }
  return result;
}

}  // namespace gonio::explain
