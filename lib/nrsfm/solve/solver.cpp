// What every call of a solver has in common: values in force, refusals, names, the reprojection error.
#include "nrsfm/solve/solver.h"

#include <Eigen/Core>
#include <cmath>
#include <sstream>

#include "base/error.h"
#include "nrsfm/solve/factorization.h"

namespace gonio::nrsfm {
namespace {

std::string number(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

const SolverParameter* find_parameter(const SolverInfo& info, const std::string& name) {
  for (const SolverParameter& parameter : info.parameters) {
    if (parameter.name == name) return &parameter;
  }
  return nullptr;
}

std::string parameter_names(const SolverInfo& info) {
  std::string names;
  for (const SolverParameter& parameter : info.parameters) names += (names.empty() ? "" : ", ") + parameter.name;
  return names.empty() ? info.id + " has none" : info.id + " has " + names;
}

// Squared distances of one frame's tracks from the shape as a pinhole sees it.
Eigen::ArrayXd pinhole_squares(const Eigen::Matrix2Xd& tracks, const Eigen::Matrix3Xd& shape, const Pinhole& k) {
  Eigen::Matrix2Xd seen(2, shape.cols());
  seen.row(0) = (k.fx_px * shape.row(0).array() / shape.row(2).array() + k.cx_px).matrix();
  seen.row(1) = (k.fy_px * shape.row(1).array() / shape.row(2).array() + k.cy_px).matrix();
  return (tracks - seen).colwise().squaredNorm().array();
}

// The same of a camera of unknown scale and translation, which least squares finds.
Eigen::ArrayXd weak_squares(const Eigen::Matrix2Xd& tracks, const Eigen::Array<bool, 1, Eigen::Dynamic>& used,
                            const Eigen::Matrix2Xd& seen) {
  Eigen::Vector2d track_mean = Eigen::Vector2d::Zero(), seen_mean = Eigen::Vector2d::Zero();
  double count = 0;
  for (Eigen::Index p = 0; p < used.size(); ++p) {
    if (!used(p)) continue;
    track_mean += tracks.col(p);
    seen_mean += seen.col(p);
    ++count;
  }
  track_mean /= std::max(count, 1.0);
  seen_mean /= std::max(count, 1.0);
  double dot = 0, energy = 0;
  for (Eigen::Index p = 0; p < used.size(); ++p) {
    if (!used(p)) continue;
    dot += (tracks.col(p) - track_mean).dot(seen.col(p) - seen_mean);
    energy += (seen.col(p) - seen_mean).squaredNorm();
  }
  const double scale = energy > 0 ? dot / energy : 0;
  return ((tracks.colwise() - track_mean) - scale * (seen.colwise() - seen_mean)).colwise().squaredNorm().array();
}

// Over tracks that are visible and have an estimate; one scale and one translation per frame are free but where a
// pinhole camera's own frame of reference has been recovered.
double reprojection_rms(const Sequence& sequence, const SolverInfo& info, const Reconstruction& answer) {
  double sum = 0, count = 0;
  for (Eigen::Index f = 0; f < sequence.frames(); ++f) {
    const Eigen::Matrix3Xd shape = shape_of(answer.shapes, f);
    const Eigen::Matrix2Xd tracks = sequence.tracks.middleRows<2>(2 * f);
    Eigen::Array<bool, 1, Eigen::Dynamic> used = sequence.visible.row(f);
    for (Eigen::Index p = 0; p < used.size(); ++p) used(p) = used(p) && shape.col(p).allFinite();
    Eigen::ArrayXd squares;
    if (info.perspective && answer.frame == ShapeFrame::camera && sequence.pinhole) {
      squares = pinhole_squares(tracks, shape, *sequence.pinhole);
    } else {
      const bool known = !answer.rotations.empty() && answer.frame == ShapeFrame::object;
      const CameraRows rows =
          known ? answer.rotations[static_cast<std::size_t>(f)] : CameraRows(CameraRows::Identity());
      squares = weak_squares(tracks, used, rows * shape);
    }
    for (Eigen::Index p = 0; p < used.size(); ++p) {
      if (!used(p)) continue;
      sum += squares(p);
      ++count;
    }
  }
  return count > 0 ? std::sqrt(sum / count) : 0;
}

// Tracks that coincide in every frame hold no shape.
void require_extent(const Sequence& sequence, const std::string& place) {
  for (Eigen::Index f = 0; f < sequence.frames(); ++f) {
    Eigen::Index first = -1;
    for (Eigen::Index p = 0; p < sequence.points(); ++p) {
      if (!sequence.visible(f, p)) continue;
      if (first < 0) first = p;
      if (sequence.tracks.block<2, 1>(2 * f, p) != sequence.tracks.block<2, 1>(2 * f, first)) return;
    }
  }
  throw Error(Exit::data, place, "all points lie in one place, in every frame", "give tracks of a thing with extent");
}

}  // namespace

const Solver* find_solver(const std::string& id) {
  for (const Solver* solver : all_solvers()) {
    if (solver->info().id == id) return solver;
  }
  return nullptr;
}

SolverValues values_in_force(const SolverInfo& info, const SolverValues& given) {
  SolverValues values;
  for (const SolverParameter& parameter : info.parameters) values[parameter.name] = parameter.preset;
  for (const auto& [name, value] : given) {
    const SolverParameter* parameter = find_parameter(info, name);
    if (parameter == nullptr) throw Error(Exit::usage, "--set", "no parameter " + name, parameter_names(info));
    const bool whole = !parameter->integer || value == std::floor(value);
    if (!whole || !(value >= parameter->lower && value <= parameter->upper)) {
      throw Error(Exit::usage, "--set", name + "=" + number(value) + " is out of bounds",
                  std::string(parameter->integer ? "whole numbers" : "numbers") + " from " + number(parameter->lower) +
                      " to " + number(parameter->upper));
    }
    values[name] = value;
  }
  return values;
}

Solution solve(const Solver& solver, const Sequence& sequence, const SolverOptions& options) {
  const SolverInfo& info = solver.info();
  const std::string place = sequence.name.empty() ? "sequence" : sequence.name;
  check(sequence, place);
  require_extent(sequence, place);
  values_in_force(info, options.values);
  if (!sequence.complete() && !info.takes_missing) {
    std::string others;
    for (const Solver* other : all_solvers()) {
      if (other->info().takes_missing) others += (others.empty() ? "" : ", ") + other->info().id;
    }
    throw Error(
        Exit::data, place,
        number(100 * sequence.missing_share()) + " % of the tracks are missing, and " + info.id + " needs all of them",
        "take one of " + others);
  }
  Solution solution;
  try {
    solution = solver.solve(sequence, options);
  } catch (const Error& error) {
    if (error.place() != "tracks") throw;
    throw Error(error.code(), place, info.id + ": " + error.problem(), error.remedy());
  }
  Reconstruction& answer = solution.reconstruction;
  answer.name = info.id;
  answer.sequence = sequence.name;
  answer.factors = sequence.factors;
  answer.factors["algorithm"] = info.id;
  solution.reprojection_rms = reprojection_rms(sequence, info, answer);
  if (!std::isfinite(solution.reprojection_rms) || answer.shapes.array().isInf().any())
    throw Error(Exit::data, place, info.id + ": the answer is not finite", "take another solver, or a lower rank");
  return solution;
}

}  // namespace gonio::nrsfm
