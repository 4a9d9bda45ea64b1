// The generated JSON Schema against documents that programs accept and documents that they refuse, by an independent
// validator.
#include <gtest/gtest.h>

#include "base/atomic_file.h"
#include "base/error.h"
#include "data.h"
#include "manifest/document.h"
#include "mechanism/validate.h"
#include "schema_check.h"

namespace gonio::manifest {
namespace {

class SchemaTest : public testing::Test {
 protected:
  static bool valid(const std::string& text) {
    static const tests::SchemaCheck schema;
    return schema.valid(text);
  }
  static bool accepted(const std::string& text) {
    try {
      mechanism::validate_uses(parse_document(text, "test.json", "."));
      return true;
    } catch (const Error&) {
      return false;
    }
  }
};

std::string with_parameter(const std::string& parameter) {
  return R"({"gonio":1,"cameras":{"c":{"fx_px":)" + parameter + "}}}";
}
std::string with_pose(const std::string& pose) {
  return R"({"gonio":1,"images":[{"id":"a","world_from_camera":)" + pose + "}]}";
}

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
                           R"({"gonio":1,"colour":{"c":{"model":"cubic","matrix":[],"white":[1,1,1],"to":"srgb"}}})",
                           R"({"gonio":1,"colour":{"c":{"model":"linear","white":[1,1,1],"to":"srgb"}}})",
                           R"({"gonio":1,"sequences":{"s":{"frames":60}}})",
                           R"({"gonio":1,"reconstructions":[{"id":"a"}]})",
                           R"({"gonio":1,"evaluations":[{"id":"a","flips":[{"frame":1,"kind":"odd"}]}]})",
                           R"({"gonio":1,"lights":{"l":{"model":"pont"}}})",
                           R"({"gonio":1,"lights":{"l":{"model":"point"}}})",
                           R"({"gonio":1,"meshes":{"m":{"sphere":{"r":1}}}})",
                           R"({"gonio":1,"images":[{"id":"a","noise":{"gain":0,"read":0}}]})",
                           R"({"gonio":1,"images":[{"id":"a","light":7}]})",
                           R"({"gonio":1,"images":[{"id":"a","developed":["black"]}]})",
                           R"({"gonio":1,"images":[{"id":"a","developed":[{"step":"toast"}]}]})",
                           R"({"gonio":1,"images":[{"id":"a","developed":[{"step":"merge","frames":0}]}]})",
                           R"({"gonio":1,"images":[{"id":"a","joints_rad":[0,"x"]}]})",
                           R"({"gonio":1,"boards":{"b":{"kind":"checkerboard","square_m":1,"inner_corners":[9,1]}}})",
                           R"({"gonio":1,"surfaces":{"s":{"model":"diffuse","albedo":"red"}}})",
                           R"({"gonio":1,"surfaces":{"s":{"model":"diffuse","albedo":0.5,"base":"t"}}})",
                           R"({"gonio":1,"surfaces":{"s":{"model":"diffuse","albedo":0.5,"sigma":{"albedo":-1}}}})",
                           R"({"gonio":1,"surfaces":{"s":{"model":"diffuse","laws":{"albedo":{"law":"none"}}}}})",
                           R"({"gonio":1,"surfaces":{"s":{"model":"diffuse","labels":{"albedo":{"a":"x"}}}}})"}) {
    EXPECT_FALSE(accepted(text)) << text;
    EXPECT_FALSE(valid(text)) << text;
  }
}

// What stands once in the schema is refused wherever it is referred to.
TEST_F(SchemaTest, SharedPartsAreHeldToTheirSchema) {
  for (const char* good :
       {"5", "[5]", R"({"value":5,"free":true,"min":1,"max":9,"sigma":2,"share":"f","x-note":[]})"}) {
    EXPECT_TRUE(accepted(with_parameter(good))) << good;
    EXPECT_TRUE(valid(with_parameter(good))) << good;
  }
  for (const char* bad :
       {"\"5\"", "[]", "[null]", "{}", R"({"value":[]})", R"({"value":5,"free":1})", R"({"value":5,"sigma":0})",
        R"({"value":5,"fre":true})", R"({"value":5,"share":7})", "null"}) {
    EXPECT_FALSE(accepted(with_parameter(bad))) << bad;
    EXPECT_FALSE(valid(with_parameter(bad))) << bad;
  }
  for (const char* good : {R"({"rotation":[1,0,0,0],"translation_m":[0,0,1]})", R"({"translation_m":[0,0,1],"x-a":0})",
                           R"({"translation_m":[0,0,1],"sigma":{"rotation_rad":0.1,"translation_m":[1,2,3]}})"}) {
    EXPECT_TRUE(accepted(with_pose(good))) << good;
    EXPECT_TRUE(valid(with_pose(good))) << good;
  }
  for (const char* bad :
       {R"({"rotation":[1,0,0]})", R"({"translation":[0,0,1]})", R"({"matrix":[[1,0,0,0]]})", "[1,0,0,0]",
        R"({"translation_m":[0,0,1],"sigma":{"rotation_rad":[1,2]}})",
        R"({"translation_m":[0,0,1],"sigma":{"rotation":1}})", R"({"translation_m":[0,0,1],"sigma":0.1})"}) {
    EXPECT_FALSE(accepted(with_pose(bad))) << bad;
    EXPECT_FALSE(valid(with_pose(bad))) << bad;
  }
}

TEST_F(SchemaTest, MechanismsAreThoseOfTheRegistry) {
  const auto with = [](const std::string& uses) {
    return R"({"gonio":1,"cameras":{"c":{"fx_px":5}},"mechanisms":)" + uses + "}";
  };
  for (const char* good : {R"({})", R"({"lens.radial":{"k1":-0.2,"sigma":{"k1":0.01},"on":"c","x-mine":1}})",
                           R"({"lens.radial":{"on":["c"],"k1":{"value":-0.2,"free":true}},"x-mine":1})"}) {
    EXPECT_TRUE(accepted(with(good))) << good;
    EXPECT_TRUE(valid(with(good))) << good;
  }
  for (const char* bad :
       {R"({"lens.radail":{}})", R"({"lens.radial":{"k9":1}})", R"({"lens.radial":{"k1":"x"}})",
        R"({"lens.radial":{"on":7}})", R"({"lens.radial":{"sigma":{"k1":-1}}})", "[]", R"({"lens.radial":[]})"}) {
    EXPECT_FALSE(accepted(with(bad))) << bad;
    EXPECT_FALSE(valid(with(bad))) << bad;
  }
}

TEST_F(SchemaTest, ProvenanceIsAGraphOfSteps) {
  const auto with = [](const std::string& graph) { return R"({"gonio":1,"provenance":)" + graph + "}"; };
  Document d;
  record_step(d, {.program = "render",
                  .version = "1",
                  .options = Value::object({{"spp", "4"}, {"with", Value::array()}}),
                  .input_hashes = {"ff", "ee"},
                  .input_id = "ab"});
  record_step(d, {.program = "compare", .version = "1", .input_hashes = {}, .input_id = "", .time = "t", .host = "h"});
  const std::string written = print_document(d, ".");
  EXPECT_EQ(d.provenance.find("steps")->as_object().size(), 2u);
  EXPECT_TRUE(accepted(written)) << written;
  EXPECT_TRUE(valid(written)) << written;
  for (const char* bad : {"[]", R"({"step":{}})", R"({"steps":[]})", R"({"steps":{"a":{}}})",
                          R"({"steps":{"a":{"program":"p","inputs":"f"}}})", R"({"last":7})",
                          R"({"steps":{"a":{"program":"p","options":[]}}})", R"({"runs":{"a":{"when":"t"}}})",
                          R"({"steps":{"a":{"program":"p","by":"me"}}})"}) {
    EXPECT_FALSE(accepted(with(bad))) << bad;
    EXPECT_FALSE(valid(with(bad))) << bad;
  }
}

TEST_F(SchemaTest, StandsInTheRepositoryAsItIsPrinted) {
  EXPECT_EQ(read_file(std::filesystem::path(GONIO_SOURCE) / "schemas/manifest-1.schema.json"),
            schema_text(manifest_schema(mechanism::uses_schema())))
      << "run scripts/regenerate";
}

}  // namespace
}  // namespace gonio::manifest
