// See ../register.h.
#include "mesh/register.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "linear/geom_matrices.h"
#include "linear/svd.h"
#include "mesh/register/adjustment.h"
#include "mesh/register/figures.h"
#include "mesh/register/open_words.h"

namespace gonio::mesh {
namespace {

constexpr double part_of = 0.2;      // of the largest: a view with less of a direction does not take part in it
constexpr double fewest_left = 0.5;  // share of residuals that a motion may not lose

// Places of a view's pairs, middle of them.
Vec3 centre_of(const std::vector<ViewOverlap>& overlaps, std::size_t view, Vec3 otherwise) {
  Vec3 sum;
  double count = 0;
  for (const ViewOverlap& o : overlaps)
    if (o.view == view || o.other == view)
      for (const OverlapPoint& p : o.points) sum += p.residual.at_m, ++count;
  return count > 0 ? sum / count : otherwise;
}

Eigen::MatrixXd open_of(const Adjustment& made, std::size_t view) {
  if (made.system.place[view] < 0 || made.open.cols() == 0) return Eigen::MatrixXd(6, 0);
  const auto parts_of = [&](std::size_t v) {
    const Eigen::MatrixXd rows = made.open.middleRows(made.system.place[v], 6);
    return linear::JacobiSvd<Eigen::MatrixXd>(rows, Eigen::ComputeThinU);
  };
  double most = 0;
  for (std::size_t v = 0; v < made.system.place.size(); ++v)
    if (made.system.place[v] >= 0) most = std::max(most, parts_of(v).singularValues()[0]);
  const auto own = parts_of(view);
  Eigen::Index count = 0;
  while (count < own.singularValues().size() && own.singularValues()[count] > part_of * most) ++count;
  return own.matrixU().leftCols(count);
}

ViewShift shift_of(const Adjustment& made, std::size_t view) {
  ViewShift shift;
  shift.motion = made.motions[view];
  shift.centre_m = centre_of(made.overlaps, view, made.scale.centre_m);
  const Vec3 before = inverse(shift.motion) * shift.centre_m;
  shift.turn_rad = rotation_vector_of(shift.motion.rotation), shift.shift_m = shift.centre_m - before;
  const int place = made.system.place[view];
  if (place < 0) {
    shift.held = 6;
    return shift;
  }
  Matrix6 to = Matrix6::Identity();  // turn in radians, and at the view's own centre
  to.topLeftCorner<3, 3>() /= made.scale.length_m;
  to.bottomLeftCorner<3, 3>() =
      -linear::cross_matrix(linear::as_eigen(shift.centre_m - made.scale.centre_m)) / made.scale.length_m;
  const Matrix6 covariance = to * made.covariance.block<6, 6>(place, place) * to.transpose();
  Eigen::Map<Matrix6>(shift.covariance.data()) = covariance;
  const Eigen::MatrixXd open = open_of(made, view);
  shift.open = open_words(open, made.scale);
  shift.held = 6 - static_cast<std::size_t>(open.cols());
  return shift;
}

// By how much a view's paired points moved, at most.
double largest_motion_m(const Adjustment& made) {
  double most = 0;
  for (const ViewOverlap& o : made.overlaps)
    for (const OverlapPoint& p : o.points)
      most = std::max(most, norm(p.residual.at_m - inverse(made.motions[o.view]) * p.residual.at_m));
  return most;
}

// Why the motions are none, where they are none.
std::string doubt_about(const Adjustment& made, const Registration& found, double most) {
  const double reach_m = found.reach_m;
  if (!made.converged) return format("it did not settle in %d steps", made.iterations);
  if (const double moved = largest_motion_m(made); moved > 3 * reach_m)
    return format("a view would move by %.3g mm, and pairs reach %.3g mm: views lie too far apart to begin with",
                  1e3 * moved, 1e3 * reach_m);
  if (static_cast<double>(found.after.residuals) < fewest_left * static_cast<double>(found.before.residuals))
    return format("of %zu pairs only %zu were left", found.before.residuals, found.after.residuals);
  if (found.after.typical > most)
    return format(
        "views would still lie apart by %.3g times what is stated (middle half, limit %.3g): they lie too far "
        "apart to begin with, or their points err by more than they state",
        found.after.typical, most);
  if (found.after.value > found.before.value + 2 * found.after.rest_sigma)
    return format("views agreed worse than before: %.3g times what is stated instead of %.3g", found.after.value,
                  found.before.value);
  return {};
}

void describe(const std::vector<ViewOverlap>& overlaps, const MotionScale& scale, Registration& found) {
  found.pairs = pair_figures(overlaps, sums_of(overlaps, scale), scale);
  found.residuals.clear();
  for (const ViewOverlap& o : overlaps)
    for (const OverlapPoint& p : o.points) found.residuals.push_back(p.residual);
}

}  // namespace

Registration register_views(const MeasuredPoints& points, const std::vector<std::optional<PoseDoubt>>& doubts,
                            const RegisterWish& wish) {
  std::vector<ViewSurface> surfaces;
  for (std::uint32_t v = 0; v < points.viewpoints_m.size(); ++v)
    surfaces.emplace_back(points, v, wish.samples, wish.seed);
  const std::size_t views = surfaces.size();
  Registration found;
  found.reach_m = wish.reach_m > 0 ? wish.reach_m : usual_reach_m(surfaces);
  const std::vector<ViewOverlap> stated = all_overlaps(surfaces, std::vector<ViewMotion>(views), found.reach_m);
  const MotionScale scale = scale_of(stated, surfaces);
  found.before = consistency_of(stated, sums_of(stated, scale), views, wish.fixed);
  found.after = found.before;
  describe(stated, scale, found);
  if (!wish.refine || found.before.residuals == 0) return found;
  Adjustment made = adjust(surfaces, stated, doubts, wish, found.reach_m);
  found.iterations = made.iterations, found.inflation = made.inflation;
  for (std::size_t v = 0; v < views; ++v) {
    found.views.push_back(shift_of(made, v));
    found.views.back().prior = v < doubts.size() && doubts[v].has_value();
    found.slides = found.slides || !found.views.back().open.empty();
  }
  for (ViewOverlap& o : made.overlaps)
    for (OverlapPoint& p : o.points) p.weight = 1;
  found.after = consistency_of(made.overlaps, sums_of(made.overlaps, made.scale), views, wish.fixed);
  found.refused = doubt_about(made, found, wish.most);
  found.slides = found.slides && found.refused.empty() && !wish.hold;
  if (found.slides) found.refused = "overlaps do not hold every motion";
  if (found.refused.empty())
    describe(made.overlaps, made.scale, found);
  else
    found.after = found.before;
  return found;
}

}  // namespace gonio::mesh
