// Estimates of a model whose predictions stand for a slower, exact simulation (Problem::bias). Deferred correction
// (Boehmer & Stetter, "Defect Correction Methods", 1984): the bias is measured where the fit stands and held fixed
// while the fit is made again, and once more from there. Each round leaves of an error of the estimates only what the
// bias itself changes along with them, a few parts in a hundred where predict() is off by as much. The scatter of the
// bias is in the residuals like the noise of the recordings, and so in the sandwich covariance (fit.h).
#pragma once
#include <optional>

#include "inference/race.h"

namespace gonio::inference {

struct Refined {
  System system;  // with the bias
  Fit fit;
};
// Nothing: the problem has no bias to tell, or the exact simulation fits the recordings worse than predict() did.
std::optional<Refined> refined(const System& system, const Model& model);

}  // namespace gonio::inference
