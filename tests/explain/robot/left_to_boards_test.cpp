// What a domain leaves to another: poses fitted to corners cannot name of a lens what the corners themselves refused.
#include <gmock/gmock.h>

#include "explain/domains.h"
#include "inference/toy_frame.h"
#include "mechanism/mechanism.h"

namespace gonio::explain::tests {
namespace {

class WithCandidates : public ToyFrame {
 public:
  WithCandidates(std::string domain, const std::vector<std::string>& ids) : domain_(std::move(domain)) {
    for (const std::string& id : ids) candidates_.push_back({mechanism::find_mechanism(id), {}, {}, "", false});
  }
  std::string domain() const override { return domain_; }
  void predict(std::span<const double>, std::size_t, std::span<double>) const override {}

 private:
  std::string domain_;
};

const Domain& domain_named(const std::string& name) {
  return **std::ranges::find(all_domains(), name, &Domain::name);
}

TEST(LeftToBoards, OnlyWhatTheyNameOfALens) {
  const WithCandidates boards("boards", {"lens.radial", "lens.tangential", "lens.thin-prism", "board.scale"});
  const WithCandidates robot("robot",
                             {"robot.sag", "lens.radial", "lens.tangential", "lens.thin-prism", "board.scale"});
  Explanation e;
  e.named = {0};
  const Answered answer{&boards, &e};
  const auto asked = [&](const std::string& domain, const std::vector<std::string>& wanted) {
    return hypotheses_of(domain_named(domain), robot, {&answer, 1}, wanted);
  };
  EXPECT_THAT(asked("robot", {}), testing::ElementsAre("robot.sag", "lens.radial", "board.scale"));
  EXPECT_THAT(asked("images", {}), testing::IsEmpty());  // all of them, which leaves nothing to boards
  EXPECT_THAT(asked("robot", {"robot.sag", "lens.tangential"}), testing::ElementsAre("robot.sag"));
  e.not_told_apart = {{0, 2}};
  EXPECT_THAT(asked("robot", {}), testing::ElementsAre("robot.sag", "lens.radial", "lens.thin-prism", "board.scale"));
  EXPECT_THAT(hypotheses_of(domain_named("robot"), robot, {}, {}), testing::IsEmpty());
}

}  // namespace
}  // namespace gonio::explain::tests
