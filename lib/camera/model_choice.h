// Which lens model the views support, judged on views that the fit did not see.
//
// K-fold over shots (Stone, "Cross-validatory choice", J. R. Stat. Soc. B 36, 1974): the lens is fitted to the other
// folds; of a held-out view only the pose is fitted, to its own corners, and the residuals that remain are scored. A
// model that bends the lens to fit noise, or to fit the board's own bulge, pays for it there. The simplest model within
// one standard error of the best wins (Breiman et al., "Classification and regression trees", 1984, section 3.4.3),
// with and without the board's warp.
//
// Whatever it predicts, a model cannot be chosen whose fit to all views does not converge, or is not determined by
// them: terms that others can stand in for all but wholly (multiple correlation above 0.999, own polynomial apart),
// with no term among those that hold each other up that exceeds its own standard uncertainty.
#pragma once
#include <string>
#include <vector>

#include "camera/calibration.h"

namespace gonio::camera {

struct ModelScore {
  std::string model;
  bool warp = false;
  int parameters = 0;             // of the lens and the board
  double held_out_px = 0;         // root mean square of a corner's distance
  double gap = 0, gap_sigma = 0;  // of the robust score above the best one's, and its standard error over shots
  bool failed = false;            // some fold could not be fitted
  std::string unfit{};            // why it cannot be chosen although it was scored; empty: it can
  bool eligible() const { return !failed && unfit.empty(); }
};
struct ModelChoice {
  std::vector<ModelScore> scores;  // simplest first
  std::size_t best = 0, chosen = 0;
  std::vector<std::string> sentences;  // one per model
};

// Scores all calibrated models; `setup.boards` whose warp is free keep it so. Error(data) where none can be chosen.
ModelChoice score_models(const std::vector<View>& views, const CalibrationSetup& setup);

// Sets the model of all cameras and the boards' warp, and says why (log).
void choose_model(const std::vector<View>& views, CalibrationSetup& setup);

}  // namespace gonio::camera
