// What to measure next on a table: at one exposure a sensor's offset is the surroundings' light; another one parts
// them.
#include <gtest/gtest.h>

#include "base/random.h"
#include "explain/domains.h"
#include "explain/engine.h"
#include "manifest/document.h"

namespace gonio::explain::tests {
namespace {

TEST(TablesPlan, AnotherExposurePartsOffsetFromAmbientLight) {
  Random random(7);
  std::string rows;
  for (int g = 0; g < 8; ++g)
    for (int i = 0; i < 30; ++i) {
      const double radiance = random.uniform(0.1, 2), value = 10 * radiance + 1.5 + 0.05 * random.normal();
      rows += (rows.empty() ? "[" : ",[") + std::to_string(radiance) + ",0.1," + std::to_string(g) + "," +
              std::to_string(value) + "]";
    }
  const std::string text =
      R"({"gonio":1,"tables":{"t":{"model":"sensor","columns":{"radiance":"1","exposure_s":"s","run":"1","value":"1"},)"
      R"("observed":["value"],"group":"run","parameters":{"gain":{"value":100,"free":true}},"rows":[)" +
      rows + "]}}}";
  const auto problems = problems_of(manifest::parse_document(text, "sensor.json", "."));
  ASSERT_EQ(problems.size(), 1u);
  const Explanation e = explain(*problems[0], {});
  ASSERT_EQ(e.verdict, Verdict::ambiguous) << e.sentence;
  ASSERT_FALSE(e.plan.empty()) << e.next_measurement;
  EXPECT_NE(e.plan[0].setup.find("exposure_s"), nullptr);
  EXPECT_NE(e.plan[0].setup.find("exposure_s")->as_number(), 0.1);
  EXPECT_GT(e.plan[0].z, 20);
}

}  // namespace
}  // namespace gonio::explain::tests
