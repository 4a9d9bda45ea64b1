// A real sensor that is known to be linear: nothing may be named.
#include "flea3.h"

#include <gtest/gtest.h>

#include "base/atomic_file.h"
#include "data.h"
#include "explain/tables/quick_table.h"
#include "table_world.h"

namespace gonio::explain::tables::tests {
namespace {

TEST(Flea3, RawCodesAreProportionalToTheExposure) {
  GONIO_NEEDS_DATA("hdr/flea3");
  gonio::tests::ScratchFolder folder;
  write_file(folder / "flea3.csv", gonio::tests::flea3_csv(gonio::tests::data("hdr/flea3")));
  QuickTable quick;
  quick.file = folder / "flea3.csv";
  quick.model = "sensor";
  quick.observed = {"value"};
  quick.group = "exposure_s";
  quick.block = "frame";
  const TablesProblem problem(quick_document(quick), "flea3", {}, false);
  EXPECT_GT(problem.observations().rows(), 250u);
  EXPECT_GE(problem.observations().groups(), 6u);
  const Explanation e = explain(problem, {});
  EXPECT_EQ(named(problem, e), "") << e.sentence;
  EXPECT_LT(e.held_out_before, 0.03);  // lamp and shutter differ from frame to frame by some per cent
}

}  // namespace
}  // namespace gonio::explain::tables::tests
