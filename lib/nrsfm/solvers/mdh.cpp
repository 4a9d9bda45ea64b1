// Maximum depth heuristic (MDH): a surface that bends without stretching, seen by a pinhole camera.
//   max sum z   subject to   |z_fi q_fi - z_fj q_fj| <= d_ij between neighbours, sum d = constant   (inextensible.h)
// Distances along a surface are never shorter than straight ones, and those of neighbours hardly longer; nothing but
// the sum of depths keeps surfaces from lying nearer, hence the name (Chhatkuli, Pizarro, Collins & Bartoli, CVPR 2016;
// PAMI 40 (2018), section 4). The graph is that of the paper: nearest neighbours by the largest image distance over
// frames, here in the plane at depth 1. Answers stand in each frame's camera; lengths are known up to one factor for
// the sequence, chosen so that depths are 1 on average. Points that a frame does not see have no estimate there. What
// the prior leaves out: stretching, and points whose neighbours lie across a fold.
#include <Eigen/Core>
#include <cmath>
#include <cstdio>
#include <limits>

#include "base/error.h"
#include "nrsfm/solve/inextensible.h"
#include "nrsfm/solve/solver_support.h"

namespace gonio::nrsfm::solvers {
namespace {

Pinhole pinhole_of(const Sequence& sequence) {
  if (sequence.projection != Projection::perspective) {
    throw Error(Exit::data, "tracks", "the camera is orthographic: depth along lines of sight has no meaning there",
                "take a solver of orthographic models");
  }
  if (!sequence.pinhole) {
    throw Error(Exit::data, "tracks", "the pinhole camera is not known", "give K with the tracks");
  }
  const Pinhole& k = *sequence.pinhole;
  if (!(std::isfinite(k.fx_px) && std::isfinite(k.fy_px) && k.fx_px != 0 && k.fy_px != 0)) {
    throw Error(Exit::data, "tracks", "the pinhole's focal lengths are not numbers other than 0", "give another K");
  }
  return k;
}

std::vector<Eigen::Matrix3Xd> sight_of(const Sequence& sequence, const Pinhole& k) {
  std::vector<Eigen::Matrix3Xd> sight;
  for (Eigen::Index f = 0; f < sequence.frames(); ++f) {
    Eigen::Matrix3Xd& q = sight.emplace_back(3, sequence.points());
    q.row(0) = (sequence.tracks.row(2 * f).array() - k.cx_px) / k.fx_px;
    q.row(1) = (sequence.tracks.row(2 * f + 1).array() - k.cy_px) / k.fy_px;
    q.row(2).setOnes();
  }
  return sight;
}

std::string gap_note(const InextensibleDepths& found, std::size_t edges) {
  char text[160];
  std::snprintf(text, sizeof text, "%zu edges; the sum of depths is no more than %.2g %% below the largest", edges,
                100 * found.gap / found.sum);
  return text;
}

class Mdh : public Solver {
 public:
  const SolverInfo& info() const override {
    static const SolverInfo info{
        "mdh",
        "maximum depth heuristic (MDH)",
        "Neighbours keep their distance while the surface bends; of all such surfaces the deepest.",
        "Chhatkuli, Pizarro, Collins & Bartoli, CVPR 2016 and PAMI 40 (2018), section 4",
        Prior::isometry,
        true,
        false,
        true,
        {{"neighbours", 20, 2, 500, true, "nearest neighbours of a point that its graph holds"}}};
    return info;
  }

  Solution solve(const Sequence& sequence, const SolverOptions& options) const override {
    InextensibleProblem problem{sight_of(sequence, pinhole_of(sequence)), sequence.visible, {}};
    const double neighbours = values_in_force(info(), options.values).at("neighbours");
    problem.edges = neighbour_edges(problem.sight, problem.visible, static_cast<Eigen::Index>(neighbours));
    double apart = 0;
    for (const auto& [i, j] : problem.edges) {
      for (Eigen::Index f = 0; f < sequence.frames(); ++f) {
        const Eigen::Matrix3Xd& q = problem.sight[static_cast<std::size_t>(f)];
        if (sequence.visible(f, i) && sequence.visible(f, j)) apart = std::max(apart, (q.col(i) - q.col(j)).norm());
      }
    }
    if (!(apart > 0)) {
      throw Error(Exit::data, "tracks", "no two points that frames see together lie apart",
                  "follow points that stay visible together");
    }
    InextensibleOptions barrier;
    if (options.most_iterations > 0) barrier.most_iterations = options.most_iterations;
    const InextensibleDepths found = deepest(problem, barrier);
    if (!(std::isfinite(found.sum) && found.sum > 0)) {
      throw Error(Exit::data, "tracks", "the depths are not bounded", "follow more points, or set more neighbours");
    }
    Solution solution;
    solution.iterations = found.iterations;
    solution.converged = found.converged;
    solution.values = {{"neighbours", neighbours}};
    solution.notes.push_back(gap_note(found, problem.edges.size()));
    fill(sequence, problem, found, solution);
    return solution;
  }

 private:
  static void fill(const Sequence& sequence, const InextensibleProblem& problem, const InextensibleDepths& found,
                   Solution& solution) {
    Reconstruction& answer = solution.reconstruction;
    answer.frame = ShapeFrame::camera;
    answer.shapes.setConstant(3 * sequence.frames(), sequence.points(), std::numeric_limits<double>::quiet_NaN());
    const Visible held = found.depths.array().isFinite();
    const double unit = found.sum / static_cast<double>(held.count());
    for (Eigen::Index f = 0; f < sequence.frames(); ++f) {
      for (Eigen::Index p = 0; p < sequence.points(); ++p) {
        if (!held(f, p)) continue;
        answer.shapes.block<3, 1>(3 * f, p) =
            found.depths(f, p) / unit * problem.sight[static_cast<std::size_t>(f)].col(p);
      }
    }
    const Eigen::Index alone = sequence.visible.count() - held.count();
    if (alone > 0) {
      solution.notes.push_back(std::to_string(alone) +
                               " visible tracks have no neighbour in their frame, and no estimate");
    }
  }
};

}  // namespace

const Solver& mdh() {
  static const Mdh solver;
  return solver;
}

}  // namespace gonio::nrsfm::solvers
