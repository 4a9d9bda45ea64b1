// The generated JSON Schema against documents that programs accept and documents that they refuse, by an independent
// validator.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "base/atomic_file.h"
#include "base/error.h"
#include "data.h"
#include "manifest/document.h"
#include "manifest/reference.h"

namespace gonio::manifest {
namespace {

class SchemaTest : public testing::Test {
 protected:
  SchemaTest() {
    const auto text = nlohmann::json::parse(print_json(manifest_schema()));
    valijson::SchemaParser().populateSchema(valijson::adapters::NlohmannJsonAdapter(text), schema_);
  }
  bool valid(const std::string& text) {
    const auto json = nlohmann::json::parse(text);
    valijson::Validator validator;
    return validator.validate(schema_, valijson::adapters::NlohmannJsonAdapter(json), nullptr);
  }
  static bool accepted(const std::string& text) {
    try {
      parse_document(text, "test.json", ".");
      return true;
    } catch (const Error&) {
      return false;
    }
  }
  valijson::Schema schema_;
};

TEST_F(SchemaTest, AcceptsTheFixtureThatProgramsAccept) {
  const std::string text = read_file(std::filesystem::path(GONIO_SOURCE) / "tests/manifest/fixtures/manifest-1.json");
  EXPECT_TRUE(accepted(text));
  EXPECT_TRUE(valid(text));
  EXPECT_EQ(canonical_json(to_value(parse_document(text, "fixture", "."), ".")),
            canonical_json(parse_json(text, "fixture")));
}

TEST_F(SchemaTest, AcceptsThePracticeRecordings) {
  GONIO_NEEDS_DATA("recordings");
  for (int i = 1; i <= 6; ++i)
    EXPECT_TRUE(valid(read_file(tests::data("recordings") / ("practice-" + std::to_string(i) + ".json")))) << i;
}

TEST_F(SchemaTest, AndProgramsRefuseTheSame) {
  for (const char* text : {R"({"gonio":2})",
                           R"({})",
                           R"({"gonio":1,"camera":{}})",
                           R"({"gonio":1,"cameras":{"c":{"fx":1}}})",
                           R"({"gonio":1,"cameras":{"c":{"width_px":0}}})",
                           R"({"gonio":1,"cameras":{"c":{"model":"fish"}}})",
                           R"({"gonio":1,"images":[{}]})",
                           R"({"gonio":1,"images":{"id":"a"}})",
                           R"({"gonio":1,"goniometer":{"s":{"radius_m":0.1}}})",
                           R"({"gonio":1,"contrasts":[{"action":"guess"}]})",
                           R"({"gonio":1,"surface_fits":{"s":{"model":"diffuse","rms":-1}}})",
                           R"({"gonio":1,"patterns":{"p":{"rows":0}}})",
                           R"({"gonio":1,"reliefs":{"r":{"file":"f","width":0}}})",
                           R"({"gonio":1,"reliefs":{"r":{"width":4}}})",
                           R"({"gonio":1,"ground_noises":{"g":{"white_m":-1}}})",
                           R"({"gonio":1,"sequences":{"s":{"frames":60}}})",
                           R"({"gonio":1,"reconstructions":[{"id":"a"}]})",
                           R"({"gonio":1,"evaluations":[{"id":"a","flips":[{"frame":1,"kind":"odd"}]}]})",
                           R"({"gonio":1,"lights":{"l":{"model":"pont"}}})",
                           R"({"gonio":1,"meshes":{"m":{"sphere":{"r":1}}}})",
                           R"({"gonio":1,"images":[{"id":"a","noise":{"gain":0,"read":0}}]})",
                           R"({"gonio":1,"surfaces":{"s":{"model":"diffuse","albedo":"red"}}})"}) {
    EXPECT_FALSE(accepted(text)) << text;
    EXPECT_FALSE(valid(text)) << text;
  }
}

}  // namespace
}  // namespace gonio::manifest
