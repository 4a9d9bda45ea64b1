// The null test on board corners: it sees unmodelled k3, a bent board and a rolling shutter, and nothing where nothing
// is; the program names the rolling shutter and shows it on held-out views. scripts/proofs/explain-residual-test has
// the full runs.
#include <gtest/gtest.h>

#include "explain/boards/residual_cases.h"
#include "explain/engine.h"
#include "inference/explanation.h"

namespace gonio::prove {
namespace {

// Six runs of each. With 90 % power fewer than 4 are found by chance in 1.6 % of seeds; at 5 % false alarms more than 2
// in 0.2 %.
TEST(ResidualTest, SeesWhatWasLeftOutAndNothingElse) {
  constexpr int runs = 6;
  for (const LeftOut& what : left_out_cases()) {
    if (what.present && what.power < 0.9) continue;  // too faint for six runs
    int found = 0;
    for (int run = 0; run < runs; ++run) found += residual_p(what, 500 + static_cast<std::uint64_t>(run)) <= 0.05;
    if (what.present)
      EXPECT_GE(found, 4) << what.name;
    else
      EXPECT_LE(found, 2) << what.name;
  }
}

// A hand that moves while the shutter rolls: 1 px from the first row to the last, another direction in every view.
TEST(ResidualTest, ARollingShutterIsNamedAndRepairsHeldOutViews) {
  LeftOut moving{"rolling shutter 1 px", {}, true};
  moving.truth.rolling_px = 1;
  int named = 0;
  for (std::uint64_t run = 0; run < 2; ++run) {
    const auto problem = residual_problem(moving, run);
    explain::Options options;
    options.draws = 399;
    options.seed = run;
    const explain::Explanation e = explain::explain(*problem, options);
    named += e.named.size() == 1 && problem->candidates()[e.named[0]].id() == "camera.rolling-shutter";
    EXPECT_LE(e.global_p, 0.01) << e.sentence;
    EXPECT_LE(e.held_out_after, e.held_out_before) << e.sentence;
  }
  EXPECT_EQ(named, 2);
}

}  // namespace
}  // namespace gonio::prove
