// Designs on which explain's null test must see what was left out: 20 views, 0.1 px noise, and an amplitude that a user
// would not notice in the residuals' RMS.
#pragma once
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "explain/boards/board_world.h"
#include "explain/boards/boards_problem.h"
#include "explain/engine.h"
#include "manifest/document.h"

namespace gonio::prove {

struct LeftOut {
  std::string name;
  CaseTruth truth;
  bool present = false;
  double power = 0.9;  // to reach at a level of 5 %
};

inline std::vector<LeftOut> left_out_cases() {
  LeftOut nothing{"nothing left out", {}, false}, k3{"unmodelled k3 = 0.2", {}, true},
      warp{"board warp 0.1 mm", {}, true}, rolling{"rolling shutter, rows displaced by up to 0.3 px", {}, true},
      half_as_fast{"rolling shutter, 0.3 px from the first row to the last", {}, true, 0.75};
  k3.truth.lens.k3 = 0.2;
  warp.truth.board.sag_x_m = 1e-4;
  rolling.truth.rolling_px = 0.6;
  half_as_fast.truth.rolling_px = 0.3;
  return {nothing, k3, warp, rolling, half_as_fast};
}

// One run: a design and views of its own, drawn from `seed`. The base model knows k1, k2, p1, p2.
inline std::unique_ptr<explain::Problem> residual_problem(const LeftOut& what, std::uint64_t seed) {
  std::mt19937_64 g(seed * 7919 + 17);
  const auto between = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(g); };
  CaseDesign design;
  design.width_px = static_cast<int>(between(1150, 2580));  // 1 to 5 megapixels at 4 : 3
  design.height_px = design.width_px * 3 / 4;
  design.focal_px = between(0.85, 1.1) * design.width_px;
  design.columns = 9 + static_cast<int>(between(0, 6));
  design.rows = 6 + static_cast<int>(between(0, 4));
  design.square_m = 0.2 / (design.columns - 1);
  design.least_noise_px = design.most_noise_px = 0.1;
  design.misplaced = 0;
  design.knows_lens = true;
  CaseTruth truth = what.truth;
  truth.lens.k1 = between(-0.2, 0.1);
  truth.lens.k2 = between(-0.05, 0.1);
  truth.lens.p1 = between(-1e-3, 1e-3);
  truth.lens.p2 = between(-1e-3, 1e-3);
  const double side = between(0, 1) < 0.5 ? -1 : 1;
  truth.lens.k3 *= side;
  truth.board.sag_x_m *= side;
  const BoardCase sealed = board_case(what.name, truth, 20, g(), design);
  const manifest::Document document = manifest::parse_document(sealed.manifest, sealed.name, ".");
  return explain::boards_problem(explain::boards_input(document));
}

// The p-value of explain's null test.
inline double residual_p(const LeftOut& what, std::uint64_t seed) {
  explain::Options options;
  options.draws = 399;
  options.negative_controls = 0;
  options.seed = seed;
  return explain::null_test(*residual_problem(what, seed), options);
}

}  // namespace gonio::prove
