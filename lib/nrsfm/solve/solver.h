// Solvers of non-rigid structure from motion. Each is one file in solvers/ (the stem names the function: pta.cpp
// defines `const Solver& pta()` in namespace gonio::nrsfm::solvers), with its paper, its equations and what it leaves
// out; the build gathers them. A solver is a function of its input and seed alone: same input, same bytes, whatever the
// threads.
#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "nrsfm/sequence.h"

namespace gonio::nrsfm {

// A number that a user may set: the rank of a low-rank model, the weight of a prior.
struct SolverParameter {
  std::string name;   // "rank", "dct_terms", ...
  double preset = 0;  // used where neither the user nor choose_parameters() says otherwise
  double lower = 0, upper = 0;
  bool integer = true;
  std::string meaning;  // one plain sentence
};
using SolverValues = std::map<std::string, double>;

enum class Prior { rigid, shape_basis, trajectory_basis, shape_and_trajectory, subspaces, kernel, isometry };

struct SolverInfo {
  std::string id;        // "pta"
  std::string title;     // "trajectory basis (PTA)"
  std::string sentence;  // what it assumes and what it minimizes
  std::string source;    // paper, equations
  Prior prior = Prior::rigid;
  bool takes_missing = false;
  bool orthographic = true;  // takes tracks of orthographic and weak-perspective cameras
  bool perspective = false;  // takes a pinhole into account; others see perspective tracks as if orthographic
  std::vector<SolverParameter> parameters;
};

struct SolverOptions {
  SolverValues values;      // what the user set; the rest is chosen from the data or preset
  int most_iterations = 0;  // 0: the solver's own
  std::uint64_t seed = 0;
};

struct Solution {
  Reconstruction reconstruction;
  SolverValues values;          // used
  double reprojection_rms = 0;  // over visible tracks, unit of the tracks
  int iterations = 0;
  bool converged = true;           // of iterative methods
  std::vector<std::string> notes;  // what a reader has to know: "2 of 60 frames have no estimate"
};

class Solver {
 public:
  virtual ~Solver() = default;
  virtual const SolverInfo& info() const = 0;
  // `sequence` is checked, and complete unless info().takes_missing; its truth, cameras and factors are NOT looked at.
  // Error(data) where this solver cannot answer (too few frames for the rank, degenerate motion), in words.
  virtual Solution solve(const Sequence& sequence, const SolverOptions& options) const = 0;
};

std::span<const Solver* const> all_solvers();      // sorted by id; defined in a generated source
const Solver* find_solver(const std::string& id);  // null pointer where there is none

// Values in force: the user's, else presets. Error(usage) for unknown names and values outside the bounds.
SolverValues values_in_force(const SolverInfo& info, const SolverValues& given);

// What every caller does: check, refuse missing data where the solver cannot take it, solve, fill in name, sequence,
// factors and reprojection_rms.
Solution solve(const Solver& solver, const Sequence& sequence, const SolverOptions& options);

}  // namespace gonio::nrsfm
