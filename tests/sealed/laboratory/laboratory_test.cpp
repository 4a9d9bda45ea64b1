// A laboratory from the plan to what explain names, by the programs themselves; scripts/proofs/sealed-laboratory asks
// many.
#include <gtest/gtest.h>

#include <set>

#include "base/atomic_file.h"
#include "data.h"
#include "manifest/value.h"
#include "sealed/laboratory/laboratory_run.h"

namespace gonio::sealed {
namespace {

std::set<std::string> named_in(const std::filesystem::path& folder) {
  std::set<std::string> names;
  const manifest::Value document = manifest::parse_json(read_file(folder / "out.json"), "out.json");
  for (const manifest::Value& entry : document.find("explanations")->as_array())
    for (const manifest::Value& name : entry.find("named")->as_array())
      names.insert(name.find("mechanism")->as_string());
  return names;
}

// Hypotheses that the small pictures are asked for: a whole race takes longer than a test may.
const std::vector<std::string> few{"robot.joint-offset", "board.scale"};

std::set<std::string> asked(std::uint64_t seed, const std::vector<Perturbation>& so) {
  const tests::ScratchFolder scratch;
  const std::filesystem::path folder = scratch.path() / "laboratory";
  const LaboratoryCase sealed = laboratory_with(seed, so, true, folder);
  const std::string wrong = run_laboratory(sealed, 1, folder, scratch.path() / "truths", few);
  EXPECT_EQ(wrong, "");
  if (!wrong.empty()) return {};
  EXPECT_EQ(read_file(folder / "out.json").find("truths"), std::string::npos) << "the truth's path is in a manifest";
  return named_in(folder);
}

TEST(SealedLaboratory, AnOffsetOfAJointIsNamed) {
  EXPECT_EQ(asked(41, {{"robot", "robot.joint-offset", {}, "joint_4_rad", 0.004, "", "", 0}}),
            std::set<std::string>{"robot.joint-offset"});
}

TEST(SealedLaboratory, NothingIsNamedWhereOnlyMountLensAndLampAreOthers) {
  EXPECT_EQ(asked(42, {}), std::set<std::string>{});
}

// Every offer is dealt, none more than three times, and a quarter of the laboratories have nothing to find.
TEST(SealedLaboratory, TheDeckIsDealtEvenly) {
  const tests::ScratchFolder scratch;
  std::map<std::string, int> dealt;
  int none = 0, pairs = 0;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    const LaboratoryCase made = laboratory_case(seed, true, scratch.path());
    none += made.perturbations.empty();
    pairs += made.perturbations.size() == 2;
    for (const Perturbation& p : made.perturbations) ++dealt[p.mechanism];
  }
  EXPECT_EQ(none, 6);
  EXPECT_EQ(pairs, 6);
  EXPECT_EQ(dealt.size(), 14U);
  for (const auto& [mechanism, count] : dealt) EXPECT_LE(count, 3) << mechanism;
}

}  // namespace
}  // namespace gonio::sealed
