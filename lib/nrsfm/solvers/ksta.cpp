// Kernel shape trajectories (KSTA): the shape runs along a smooth curve x_f in few dimensions, and shapes depend on
// where the curve is in a way that is not linear.
//   S_f = S_0 + sum_b kappa(x_f, z_b) S_b,   kappa(x, z) = exp(-|x - z|^2 / (2 sigma^2)),   x_f = X' omega_f in R^q
// The fit is that of csf with other weights C_f(x_f), their slopes d kappa/dx = kappa (z - x) / sigma^2. It starts at
// the linear answer: x_f are the first q principal coordinates of csf's shapes (distances between them are distances
// between shapes), the z_b frames of that curve far from each other, sigma `width` times the median distance of frames
// (Gotardo & Martinez, ICCV 2011, "Kernel non-rigid structure from motion": the model; the way of its fit is derived
// here). Left out: centres z_b that move with the curve.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "nrsfm/solve/factorization.h"
#include "nrsfm/solve/principal_curve.h"
#include "nrsfm/solve/shape_trajectory.h"
#include "nrsfm/solve/solver_support.h"

namespace gonio::nrsfm::solvers {
namespace {

double median_distance(const Eigen::MatrixXd& along) {
  std::vector<double> distances;
  const Eigen::Index step = std::max<Eigen::Index>(1, along.rows() / 200);
  for (Eigen::Index f = 0; f < along.rows(); f += step) {
    for (Eigen::Index g = 0; g < f; g += step) distances.push_back((along.row(f) - along.row(g)).norm());
  }
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

// The frame farthest from the mean, then again and again the one farthest from those taken.
Eigen::MatrixXd centres_of(const Eigen::MatrixXd& along, Eigen::Index count) {
  Eigen::MatrixXd centres(count, along.cols());
  Eigen::VectorXd distance = along.rowwise().norm();
  for (Eigen::Index b = 0; b < count; ++b) {
    Eigen::Index farthest = 0;
    distance.maxCoeff(&farthest);
    centres.row(b) = along.row(farthest);
    const Eigen::VectorXd here = (along.rowwise() - centres.row(b)).rowwise().norm();
    distance = b == 0 ? here : Eigen::VectorXd(distance.cwiseMin(here));
  }
  return centres;
}

void set_kernel(ShapeTrajectoryProblem& problem, const Eigen::MatrixXd& centres, double sigma) {
  const auto kernels = [centres, sigma](const Eigen::VectorXd& x) {
    const Eigen::VectorXd squared = (centres.rowwise() - x.transpose()).rowwise().squaredNorm();
    Eigen::VectorXd c(centres.rows() + 1);
    c << 1, (-squared.array() / (2 * sigma * sigma)).exp().matrix();
    return c;
  };
  problem.coefficients = kernels;
  problem.slope = [centres, sigma, kernels](const Eigen::VectorXd& x) {
    const Eigen::VectorXd c = kernels(x);
    Eigen::MatrixXd slope = Eigen::MatrixXd::Zero(c.size(), x.size());
    slope.bottomRows(centres.rows()) =
        c.tail(centres.rows()).asDiagonal() * (centres.rowwise() - x.transpose()) / (sigma * sigma);
    return slope;
  };
}

class Ksta : public Solver {
 public:
  const SolverInfo& info() const override {
    static const SolverInfo info{
        "ksta",
        "kernel shape trajectories (KSTA)",
        "Shapes are a radial-basis function of a smooth curve in few dimensions; least reprojection error.",
        "Gotardo & Martinez, ICCV 2011 (kernel non-rigid structure from motion), the model",
        Prior::kernel,
        true,
        true,
        false,
        {rank_parameter("basis shapes of the linear start"),
         {"dimensions", 0, 0, 20, true, "of the curve, q; 0: one less than the rank, 3 at most"},
         {"centres", 0, 0, 100, true, "radial basis functions; 0: as many as the rank"},
         {"width", 1.5, 0.1, 20, false, "of the functions, over the median distance of two frames on the curve"},
         {"ridge", 1e-4, 0, 1, false, "weight of the squares of shapes after the first, over the tracks'"},
         dct_terms_parameter(),
         camera_rank_parameter(),
         free_scales_parameter()}};
    return info;
  }

  Solution solve(const Sequence& sequence, const SolverOptions& options) const override {
    const SolverValues values = values_in_force(info(), options.values);
    const Eigen::Index most = std::min(sequence.points() - 1, 2 * sequence.frames()) / 3;  // that tracks hold
    const Eigen::Index rank = std::min(most, std::max<Eigen::Index>(2, shapes_of_model(info(), sequence, options)));
    const Eigen::Index d = dct_terms_of(info(), sequence, options, rank);
    Eigen::Index q = static_cast<Eigen::Index>(values.at("dimensions"));
    if (q == 0) q = std::min<Eigen::Index>(3, rank - 1);
    q = std::min(q, rank);
    Eigen::Index centres = static_cast<Eigen::Index>(values.at("centres"));
    if (centres == 0) centres = std::min(rank, most - 1);  // beside the constant
    require_rank(sequence, centres + 1);
    Solution solution;
    Start start = start_for(info(), sequence, options, rank, solution);
    ShapeTrajectoryProblem problem = linear_problem(sequence, start, d);
    if (options.most_iterations > 0) problem.most_iterations = options.most_iterations;
    const ShapeTrajectory linear = fit_with_translation(problem, Eigen::MatrixXd::Identity(d, rank), start.translation);
    const Eigen::MatrixXd along = principal_coordinates(linear, q);
    const double unit = median_distance(along);
    if (unit > 0) {
      set_kernel(problem, centres_of(along / unit, centres), values.at("width"));
      problem.ridge = values.at("ridge");
      problem.natural_size = true;
      const Eigen::MatrixXd x = problem.omega.transpose() * along / unit;
      fill(start, fit_with_translation(problem, x, start.translation), solution);
    } else {
      fill(start, linear, solution);
      solution.notes.push_back("the shape does not deform: the linear answer stands");
    }
    solution.iterations += linear.iterations;
    solution.values.insert({{"rank", static_cast<double>(rank)},
                            {"dimensions", static_cast<double>(q)},
                            {"centres", static_cast<double>(centres)},
                            {"width", values.at("width")},
                            {"ridge", values.at("ridge")},
                            {"dct_terms", static_cast<double>(d)}});
    return solution;
  }
};

}  // namespace

const Solver& ksta() {
  static const Ksta solver;
  return solver;
}

}  // namespace gonio::nrsfm::solvers
