// Parameters and refusals that solvers share.
#include "nrsfm/solve/solver_support.h"

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "base/error.h"
#include "nrsfm/solve/low_rank.h"
#include "nrsfm/solve/rigid_motion.h"
#include "nrsfm/solve/shape_count.h"

namespace gonio::nrsfm {

namespace {
constexpr Eigen::Index kMostShapes = 12;
}

SolverParameter free_scales_parameter() {
  const char* meaning = "1: a scale per frame; 0: one for all; -1: free where the camera is perspective";
  return {"free_scales", -1, -1, 1, true, meaning};
}

bool free_scales_of(const SolverInfo& info, const Sequence& sequence, const SolverOptions& options) {
  const double value = values_in_force(info, options.values).at("free_scales");
  return value < 0 ? sequence.projection == Projection::perspective : value > 0;
}

SolverParameter rank_parameter(const std::string& meaning, const std::string& chosen) {
  return {"rank", 0, 0, 100, true, meaning + "; 0: " + chosen};
}

Eigen::Index terms_from_tracks(const Sequence& sequence, double share, Eigen::Index most) {
  if (!sequence.complete()) return completion_rank(sequence, share, most);
  return rank_of(sequence.tracks.colwise() - sequence.tracks.rowwise().mean(), share, most);
}

Eigen::Index terms_of(const SolverInfo& info, const Sequence& sequence, const SolverOptions& options,
                      const std::string& name, double share, Eigen::Index most) {
  const Eigen::Index given = static_cast<Eigen::Index>(values_in_force(info, options.values).at(name));
  const Eigen::Index terms = given > 0 ? given : terms_from_tracks(sequence, share, most);
  require_rank(sequence, terms);
  return terms;
}

SolverParameter dct_terms_parameter() {
  return {"dct_terms", 0, 0, 2000, true, "cosines over time, d; 0: a tenth of the frames, at least twice the rank"};
}

Eigen::Index dct_terms_of(const SolverInfo& info, const Sequence& sequence, const SolverOptions& options,
                          Eigen::Index rank) {
  const Eigen::Index frames = sequence.frames();
  const Eigen::Index given = static_cast<Eigen::Index>(values_in_force(info, options.values).at("dct_terms"));
  if (given == 0) return usual_cosines(frames, rank);
  if (given >= rank && given <= frames) return given;
  throw Error(Exit::data, "tracks",
              "dct_terms=" + std::to_string(given) + " with rank " + std::to_string(rank) + " and " +
                  std::to_string(frames) + " frames",
              "set it between the rank and the number of frames");
}

SolverParameter camera_rank_parameter() {
  const char* meaning = "rank at which rotations are estimated; -1: those of a rigid shape; 0: chosen from the tracks";
  return {"camera_rank", 0, -1, 100, true, meaning};
}

namespace {

constexpr Eigen::Index kMostFrames = 80, kMostPoints = 60;  // that the nuclear norm is taken of

struct Cameras {
  double rank = 0;  // as the parameter counts
  Upgrade upgrade;
  double cost = 0, norm = 0;
};

std::vector<Eigen::Index> evenly(Eigen::Index all, Eigen::Index most) {
  std::vector<Eigen::Index> taken;
  for (Eigen::Index k = 0; k < std::min(all, most); ++k) taken.push_back(k * all / std::min(all, most));
  return taken;
}

Cameras rigid_cameras(const Sequence& sequence, const Start& start, const Upgrade& from, bool free_scales) {
  std::vector<WeakCamera> cameras;
  for (Eigen::Index f = 0; f < sequence.frames(); ++f) {
    cameras.push_back(
        {from.rotations[static_cast<std::size_t>(f)], from.scales(f), start.translation.segment<2>(2 * f)});
  }
  const RigidMotion found = refine_rigid(sequence, std::move(cameras), {free_scales, 40, 1e-4});
  Cameras rigid{-1, {}, 0, 0};
  rigid.upgrade.scales.resize(sequence.frames());
  for (Eigen::Index f = 0; f < sequence.frames(); ++f) {
    const WeakCamera& camera = found.cameras[static_cast<std::size_t>(f)];
    rigid.upgrade.rotations.push_back(camera.rotation);
    rigid.upgrade.scales(f) = camera.scale;
  }
  return rigid;
}

// What a model of `rank` shapes with these cameras leaves of the tracks, after a few steps.
double reprojection_cost(const Sequence& sequence, const Start& start, Eigen::Index rank) {
  const Eigen::Index d = std::min(sequence.frames(), 4 * rank);
  ShapeTrajectoryProblem problem = linear_problem(sequence, start, d);
  problem.most_iterations = 4;
  return fit_shape_trajectory(problem, Eigen::MatrixXd::Identity(d, rank)).cost;
}

// The least nuclear norm of shapes (low_rank.h) that these cameras allow.
double nuclear_norm(const Start& start) {
  const std::vector<Eigen::Index> frames = evenly(start.w.rows() / 2, kMostFrames);
  const std::vector<Eigen::Index> points = evenly(start.w.cols(), kMostPoints);
  const auto count = static_cast<Eigen::Index>(frames.size());
  Eigen::MatrixXd w(2 * count, static_cast<Eigen::Index>(points.size())), rows(2 * count, 3);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Index f = frames[static_cast<std::size_t>(k)];
    w.middleRows<2>(2 * k) = start.w.middleRows<2>(2 * f)(Eigen::all, points);
    rows.middleRows<2>(2 * k) = start.rows.middleRows<2>(2 * f);
  }
  return low_rank_shapes({w, rows, {}, 0}, {1e-3, 100}).nuclear_norm;
}

double least_cost(const std::vector<Cameras>& all) {
  return std::min_element(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.cost < b.cost; })->cost;
}

// Three questions, each of what the one before leaves: with which cameras does a model of `rank` shapes reproject
// within twice the least error; do the shapes have the least nuclear norm, within 1 %; is the error within 10 % of the
// least. Of what is left the highest rank. The error alone does not tell: cameras that turn too little, with shapes too
// deep, let what deforms pass for rotation (bas-relief), and they reproject best. Such depths weigh in the norm, and so
// does the deformation that wrong rotations call for.
const Cameras& best_cameras(const Sequence& sequence, Start& start, std::vector<Cameras>& all, Eigen::Index rank) {
  const double floor = 1e-12 * start.w.squaredNorm();
  for (Cameras& cameras : all) {
    take_cameras(start, cameras.upgrade);
    cameras.cost = std::max(floor, reprojection_cost(sequence, start, rank));
  }
  const auto keep_near = [&](double ratio) {
    const double most = ratio * ratio * least_cost(all);
    std::erase_if(all, [&](const Cameras& cameras) { return cameras.cost > most; });
  };
  keep_near(2);
  double least_norm = std::numeric_limits<double>::infinity();
  for (Cameras& cameras : all) {
    if (all.size() == 1) break;
    take_cameras(start, cameras.upgrade);
    cameras.norm = nuclear_norm(start);
    least_norm = std::min(least_norm, cameras.norm);
  }
  std::erase_if(all, [&](const Cameras& cameras) { return cameras.norm > 1.01 * least_norm; });
  keep_near(1.1);
  return all.back();
}

}  // namespace

Start start_for(const SolverInfo& info, const Sequence& sequence, const SolverOptions& options, Eigen::Index rank,
                Solution& solution) {
  const bool free_scales = free_scales_of(info, sequence, options);
  const int given = static_cast<int>(values_in_force(info, options.values).at("camera_rank"));
  const bool guess = given == 0 && !sequence.complete();  // what completion adds supports no more than the model's rank
  const Eigen::Index terms = guess ? rank : given < 0 ? 1 : terms_of(info, sequence, options, "camera_rank", 1e-3, 15);
  Start start = centred_start(sequence, terms);
  const std::vector<Upgrade> upgrades = metric_upgrades(motion_rows(start.w, terms), {free_scales, options.seed});
  std::vector<Cameras> all;
  if (given <= 0) all.push_back(rigid_cameras(sequence, start, upgrades.front(), free_scales));
  for (Eigen::Index k = given > 0 ? terms : 1; given >= 0 && k <= terms; ++k)
    all.push_back({static_cast<double>(k), upgrades[static_cast<std::size_t>(k - 1)], 0, 0});
  const Cameras& chosen = all.size() > 1 ? best_cameras(sequence, start, all, rank) : all.front();
  take_cameras(start, chosen.upgrade);
  solution.values["camera_rank"] = chosen.rank;
  solution.values["free_scales"] = free_scales ? 1 : 0;
  return start;
}

ShapeTrajectoryProblem linear_problem(const Sequence& sequence, const Start& start, Eigen::Index dct_terms) {
  ShapeTrajectoryProblem problem;
  problem.visible = sequence.visible;
  problem.tracks = sequence.tracks.colwise() - start.translation;
  for (Eigen::Index row = 0; row < problem.tracks.rows(); ++row) {
    for (Eigen::Index p = 0; p < problem.tracks.cols(); ++p) {
      if (!sequence.visible(row / 2, p)) problem.tracks(row, p) = 0;
    }
  }
  problem.rows = start.rows;
  problem.omega = dct_basis(sequence.frames(), dct_terms);
  problem.coefficients = [](const Eigen::VectorXd& x) { return x; };
  problem.slope = [](const Eigen::VectorXd& x) { return Eigen::MatrixXd::Identity(x.size(), x.size()); };
  return problem;
}

void fill(const Start& start, const ShapeTrajectory& fit, Solution& solution) {
  solution.reconstruction.shapes = shapes_of(fit.coefficients, fit.basis);
  solution.reconstruction.rotations = start.upgrade.rotations;
  solution.iterations = fit.iterations;
  solution.converged = fit.converged;
  turn_to_first_camera(solution.reconstruction);
}

Eigen::Index shapes_from_tracks(const Sequence& sequence) {
  const Eigen::Index most = std::min(sequence.points() - 1, 2 * sequence.frames()) / 3;
  return std::clamp<Eigen::Index>(terms_from_tracks(sequence, 1e-2, 11) + 1, 1, std::max<Eigen::Index>(most, 1));
}

Eigen::Index shapes_of_model(const SolverInfo& info, const Sequence& sequence, const SolverOptions& options) {
  const Eigen::Index given = static_cast<Eigen::Index>(values_in_force(info, options.values).at("rank"));
  if (given > 0) {
    require_rank(sequence, given);
    return given;
  }
  const Eigen::Index reproject = shapes_from_tracks(sequence);
  require_rank(sequence, reproject);
  Solution unused;
  return determined_shapes(sequence, start_for(info, sequence, options, reproject, unused), kMostShapes, reproject);
}

void require_rank(const Sequence& sequence, Eigen::Index terms) {
  const Eigen::Index most = std::min(sequence.points() - 1, 2 * sequence.frames());
  if (3 * terms <= most) return;
  throw Error(Exit::data, "tracks",
              std::to_string(sequence.points()) + " points in " + std::to_string(sequence.frames()) +
                  " frames have no rank of 3 x " + std::to_string(terms),
              "set it to " + std::to_string(most / 3) + " or less");
}

}  // namespace gonio::nrsfm
