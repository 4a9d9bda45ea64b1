// A solution as a file: the reconstruction (files.h), and beside it what the solver says about it, so that a call that
// was interrupted finds what it has answered already.
#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "nrsfm/solve/solver.h"

namespace gonio::nrsfm {

// SHA-256 of all that decides a solution: solver and program version, values that were set, limits, seed; tracks, what
// is visible, and the camera. Not the truth, which solvers do not see.
std::string identity_of(const Solver& solver, const Sequence& sequence, const SolverOptions& options);

void write_solution(const Solution& solution, const std::string& identity, const std::filesystem::path& file);
// Nothing where the file's identity is another; Error(data) where it cannot be read.
std::optional<Solution> read_solution(const std::filesystem::path& file, const std::string& identity);

}  // namespace gonio::nrsfm
