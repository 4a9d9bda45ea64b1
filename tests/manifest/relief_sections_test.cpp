// Sections about heights: typed, checked, changed entry by entry.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "manifest/document.h"
#include "manifest/sections/file.h"
#include "manifest/sections/ground_noise.h"
#include "manifest/sections/relief.h"

namespace gonio::manifest {
namespace {

constexpr const char* two = R"({"gonio": 1, "files": {"f": {"path": "a.sur"}},
 "reliefs": {"x-note": "ours",
  "a": {"file": "f", "x-lab": {"who": "me"}, "step_m": [1e-6, 2e-6], "design": {"pitch_m": [1e-4]}},
  "b": {"file": "f", "width": 4}}})";

TEST(ReliefSections, UntouchedEntriesStayAsTheyWere) {
  Document d = parse_document(two, "m.json", ".");
  EXPECT_EQ(d.reliefs.at("a").design.at("pitch_m"), std::vector<double>{1e-4});
  d.reliefs.at("a").missing = 3;
  d.ground_noises["g"].reliefs = {"b"};
  const Value v = to_value(d, ".");
  const Value before = parse_json(two, "m.json");
  EXPECT_EQ(*v.find("reliefs")->find("b"), *before.find("reliefs")->find("b"));
  EXPECT_EQ(*v.find("reliefs")->find("a")->find("x-lab"), *before.find("reliefs")->find("a")->find("x-lab"));
  EXPECT_EQ(v.find("reliefs")->find("x-note")->as_string(), "ours");
  EXPECT_EQ(v.find("reliefs")->find("a")->find("missing")->as_integer(), 3);
  const Document again = parse_document(print_json(v), "again", ".");
  EXPECT_EQ(again.ground_noises.at("g").reliefs, std::vector<std::string>{"b"});
}

TEST(ReliefSections, StandInADocumentThatWasNotRead) {
  Document d;
  d.files["f"].path = "a.sur";
  EXPECT_TRUE(d.reliefs.empty());
  d.reliefs["a"].file = "f";
  EXPECT_EQ(parse_document(print_document(d, "."), "m", ".").reliefs.at("a").file, "f");
  EXPECT_NE(content_id(d), content_id(Document()));
}

TEST(ReliefSections, RefuseWhatDoesNotExist) {
  const auto refusal = [](const std::string& section) {
    try {
      parse_document(R"({"gonio": 1, "files": {"f": {"path": "a"}}, )" + section + "}", "m.json", ".");
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string("none");
  };
  using testing::HasSubstr;
  EXPECT_THAT(refusal(R"("reliefs": {"a": {"file": "g"}})"), HasSubstr("m.json#/reliefs/a/file: names \"g\""));
  EXPECT_THAT(refusal(R"("reliefs": {"a": {"file": "f", "table": "t"}})"), HasSubstr("/reliefs/a/table"));
  EXPECT_THAT(refusal(R"("reliefs": {"a": {"file": "f", "step_m": [1]}})"), HasSubstr("/reliefs/a/step_m"));
  EXPECT_THAT(refusal(R"("reliefs": {"a": {"file": "f", "heigth": 3}})"), HasSubstr("did you mean \"height\"?"));
  EXPECT_THAT(refusal(R"("ground_noises": {"g": {"reliefs": ["a"]}})"), HasSubstr("/ground_noises/g/reliefs/0"));
  EXPECT_THAT(refusal(R"("relief": {})"), HasSubstr("did you mean \"reliefs\"?"));
  EXPECT_EQ(refusal(R"("reliefs": {"a": {"file": "f"}})"), "none");
}

}  // namespace
}  // namespace gonio::manifest
