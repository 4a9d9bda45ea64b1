// A real arm that warmed up for half a day: all its joints did, with time constants much like one another.
#include <gtest/gtest.h>

#include <string>

#include "base/atomic_file.h"
#include "data.h"
#include "explain/tables/quick_table.h"
#include "process.h"
#include "table_world.h"

namespace gonio::explain::tables::tests {
namespace {

TEST(Cobotops, AllJointsWarmUpWithinTheHour) {
  GONIO_NEEDS_DATA("robots/ur3_cobotops");
  const std::string table = gonio::tests::data("robots/ur3_cobotops/dataset_02052023.csv.gz").string();
  const gonio::tests::ScratchFolder folder;
  for (int joint = 0; joint < 6; ++joint) {
    const gonio::tests::Ended script = gonio::tests::run(
        {std::string(GONIO_SOURCE) + "/scripts/recordings/ur3_cobotops", table, std::to_string(joint)});
    ASSERT_EQ(script.status, 0) << script.err;
    write_file(folder / "joint.csv", script.out);
    QuickTable quick;
    quick.file = folder / "joint.csv";
    quick.model = "temperature";
    quick.observed = {"temperature_K"};
    const TablesProblem problem(quick_document(quick), "joint", {}, false);
    EXPECT_GT(problem.observations().rows(), 200u);
    const Explanation e = explain(problem, {});
    ASSERT_EQ(e.named.size(), 1u) << e.sentence;
    EXPECT_TRUE(problem.candidates()[e.named[0]].id().starts_with("robot.")) << e.sentence;
    EXPECT_GT(e.held_out_before, 1.5) << joint;
    EXPECT_LT(e.held_out_after, 0.2) << joint;
    for (const Estimate& estimate : e.estimates)
      if (problem.parameters()[estimate.parameter].name.ends_with("rate_per_s")) {
        EXPECT_GT(estimate.value, 1.0 / 3600) << joint;
        EXPECT_LT(estimate.value, 1.0 / 1500) << joint;
        EXPECT_LT(estimate.sigma, 0.1 * estimate.value) << joint;
      }
  }
}

}  // namespace
}  // namespace gonio::explain::tables::tests
