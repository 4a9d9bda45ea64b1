#include "mesh/register/propagated.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace gonio::mesh {
namespace {

// What one standard deviation of a point does to the pull of its view against another: that on the other is opposite.
struct Influence {
  std::uint32_t point = 0, other = 0;
  Vector6 pull = Vector6::Zero();
};

// Of `view`'s points in residuals of their own.
void add_own(const ViewSurface& own, const ViewMotion& motion, const ViewOverlap& overlap, const MotionScale& scale,
             std::vector<Influence>& all) {
  const ViewMotion back = inverse(motion);
  for (const OverlapPoint& p : overlap.points) {
    const double sigma = std::sqrt(own.variance_m2(p.point, back.rotate(p.normal)));
    all.push_back(
        {p.point, static_cast<std::uint32_t>(overlap.other),
         slopes_of(p.residual.at_m, p.normal, scale) * (p.weight * sigma / (p.residual.sigma_m * p.residual.sigma_m))});
  }
}

// Of `overlap.other`'s points in the surfaces that residuals of `overlap.view` are measured from.
void add_fitted(const ViewSurface& target, const ViewMotion& motion, const ViewOverlap& overlap,
                const MotionScale& scale, std::vector<Influence>& all) {
  const ViewMotion back = inverse(motion);
  std::vector<std::vector<Influence>> found(overlap.points.size());
  parallel_for(
      0, found.size(),
      [&](std::size_t i) {
        const OverlapPoint& p = overlap.points[i];
        std::vector<FitMember> members;
        const ViewFit fit = target.fit(back * p.residual.at_m, &members);
        const Vector6 pull =
            slopes_of(p.residual.at_m, p.normal, scale) * (p.weight / (p.residual.sigma_m * p.residual.sigma_m));
        for (const FitMember& m : members)
          found[i].push_back({m.point, static_cast<std::uint32_t>(overlap.view),
                              pull * (m.share * std::sqrt(target.variance_m2(m.point, fit.normal)))});
      },
      64);
  for (const auto& some : found) all.insert(all.end(), some.begin(), some.end());
}

}  // namespace

Eigen::MatrixXd propagated_scatter(const std::vector<ViewSurface>& surfaces, const std::vector<ViewMotion>& motions,
                                   const std::vector<ViewOverlap>& overlaps, const MotionScale& scale,
                                   const JointSystem& system) {
  Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(system.unknowns(), system.unknowns());
  for (std::size_t view = 0; view < surfaces.size(); ++view) {
    std::vector<Influence> all;
    for (const ViewOverlap& o : overlaps) {
      if (o.view == view) add_own(surfaces[view], motions[view], o, scale, all);
      if (o.other == view) add_fitted(surfaces[view], motions[view], o, scale, all);
    }
    std::ranges::sort(all, {}, [](const Influence& i) { return std::pair(i.point, i.other); });
    Eigen::VectorXd pull = Eigen::VectorXd::Zero(system.unknowns());
    for (std::size_t i = 0; i < all.size();) {
      pull.setZero();
      const std::uint32_t point = all[i].point;
      for (; i < all.size() && all[i].point == point; ++i) {
        if (system.place[view] >= 0) pull.segment<6>(system.place[view]) += all[i].pull;
        if (const int b = system.place[all[i].other]; b >= 0) pull.segment<6>(b) -= all[i].pull;
      }
      scatter.selfadjointView<Eigen::Lower>().rankUpdate(pull);
    }
  }
  return scatter.selfadjointView<Eigen::Lower>();
}

}  // namespace gonio::mesh
