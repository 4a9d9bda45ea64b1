// See shape_count.h.
#include "nrsfm/solve/shape_count.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <limits>

#include "nrsfm/solve/shape_trajectory.h"
#include "nrsfm/solve/solver_support.h"

namespace gonio::nrsfm {
namespace {

constexpr int kStepsOfHalves = 30;
constexpr int kWorseInARow = 2;
constexpr double kExact = 1e-12;  // of the tracks' mean square: nothing is left to be told apart

std::vector<Eigen::Index> points_of_half(Eigen::Index points, Eigen::Index half) {
  std::vector<Eigen::Index> own;
  for (Eigen::Index p = half; p < points; p += 2) own.push_back(p);
  return own;
}

// Shapes of all points with weights that one half has determined, and the squares that these leave of the other half.
struct SeenByHalf {
  Shapes shapes;
  double left = 0;
};

SeenByHalf seen_by_half(const Sequence& sequence, const Start& start, Eigen::Index shapes, Eigen::Index half) {
  const Eigen::Index d = usual_cosines(sequence.frames(), shapes);
  ShapeTrajectoryProblem whole = linear_problem(sequence, start, d), part = whole;
  const std::vector<Eigen::Index> own = points_of_half(sequence.points(), half);
  part.tracks = whole.tracks(Eigen::all, own).eval();
  part.visible = whole.visible(Eigen::all, own).eval();
  part.most_iterations = kStepsOfHalves;
  Eigen::VectorXd translation = start.translation;
  const Eigen::MatrixXd x = fit_with_translation(part, Eigen::MatrixXd::Identity(d, shapes), translation).x;
  whole.held = shapes;
  translation = start.translation;
  const ShapeTrajectory all = fit_with_translation(whole, x, translation);
  SeenByHalf seen{shapes_of(all.coefficients, all.basis), 0};
  const std::vector<Eigen::Index> others = points_of_half(sequence.points(), 1 - half);
  for (Eigen::Index f = 0; f < sequence.frames(); ++f) {
    const Eigen::Matrix2Xd predicted = whole.rows.middleRows<2>(2 * f) * shape_of(seen.shapes, f);
    for (const Eigen::Index p : others)
      if (whole.visible(f, p)) seen.left += (whole.tracks.block<2, 1>(2 * f, p) - predicted.col(p)).squaredNorm();
  }
  return seen;
}

// e^2 of shape_count.h.
double expected_square(const Sequence& sequence, const Start& start, Eigen::Index shapes) {
  const SeenByHalf a = seen_by_half(sequence, start, shapes, 0), b = seen_by_half(sequence, start, shapes, 1);
  const double left = (a.left + b.left) / (2 * static_cast<double>(sequence.visible.count()));
  return 1.5 * left + (a.shapes - b.shapes).squaredNorm() / static_cast<double>(a.shapes.size());
}

}  // namespace

Eigen::Index usual_cosines(Eigen::Index frames, Eigen::Index shapes) {
  return std::min(frames, std::max((frames + 5) / 10, 2 * shapes));
}

Eigen::Index determined_shapes(const Sequence& sequence, const Start& start, Eigen::Index most,
                               Eigen::Index otherwise) {
  // A half of fewer points than the model has coordinates of its own says nothing of its weights.
  const Eigen::Index limit = std::min(most, (sequence.points() / 2 - 1) / 3);
  if (limit < 1) return otherwise;
  const double exact = kExact * start.w.squaredNorm() / static_cast<double>(start.w.size());
  double least = std::numeric_limits<double>::infinity();
  Eigen::Index chosen = 1;
  for (Eigen::Index shapes = 1; shapes <= limit && shapes <= chosen + kWorseInARow; ++shapes) {
    const double square = expected_square(sequence, start, shapes);
    if (!(square < least)) continue;
    least = square;
    chosen = shapes;
    if (least <= exact) break;
  }
  return chosen;
}

}  // namespace gonio::nrsfm
