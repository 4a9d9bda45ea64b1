// schemas/manifest-1.schema.json stays what people can read: what stands in it stands there once.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>

#include "base/atomic_file.h"
#include "data.h"
#include "manifest/value.h"
#include "mechanism/mechanism.h"

namespace gonio::tests {
namespace {

using manifest::Value;

constexpr std::ptrdiff_t most_lines = 5240, most_for_a_mechanism = 13, longest_repeat = 12;

std::string schema_text() {
  return read_file(std::filesystem::path(GONIO_SOURCE) / "schemas" / "manifest-1.schema.json");
}
Value schema() {
  return manifest::parse_json(schema_text(), "manifest-1.schema.json");
}

std::ptrdiff_t lines_of(const Value& value) {
  const std::string text = manifest::print_json(value);
  return std::count(text.begin(), text.end(), '\n') + 1;
}

// visit(object or list) for `value` and all below it.
template <class Visit>
void each_part(const Value& value, const Visit& visit) {
  visit(value);
  if (value.is_object())
    for (const auto& [key, member] : value.as_object()) each_part(member, visit);
  else if (value.is_array())
    for (const Value& member : value.as_array()) each_part(member, visit);
}

TEST(Schema, IsShortEnoughToRead) {
  const std::string text = schema_text();
  const auto mechanisms = static_cast<std::ptrdiff_t>(mechanism::all_mechanisms().size());
  EXPECT_LT(std::count(text.begin(), text.end(), '\n'), most_lines + most_for_a_mechanism * mechanisms);
}

TEST(Schema, NothingOfLengthStandsTwice) {
  std::map<std::string, int> seen;
  each_part(schema(), [&](const Value& part) {
    if (!part.is_object() || lines_of(part) < longest_repeat) return;
    Value bare = part;  // what is said of it differs by its user
    std::erase_if(bare.as_object(),
                  [](const Value::Member& m) { return m.first == "description" || m.first == "title"; });
    EXPECT_EQ(++seen[manifest::canonical_json(bare)], 1) << manifest::print_json(part).substr(0, 400);
  });
  EXPECT_GT(seen.size(), 100u);
}

TEST(Schema, EveryReferenceLeadsToADefinitionAndEveryDefinitionIsUsed) {
  const Value whole = schema();
  std::set<std::string> used, defined;
  each_part(whole, [&](const Value& part) {
    if (const Value* path = part.find("$ref"); path != nullptr) {
      ASSERT_TRUE(path->as_string().starts_with("#/$defs/")) << path->as_string();
      used.insert(path->as_string().substr(8));
    }
  });
  for (const auto& [name, definition] : whole.find("$defs")->as_object()) defined.insert(name);
  EXPECT_EQ(used, defined);
  EXPECT_GT(used.size(), 50u);
}

// A bare {"type": "object"} describes nothing: what may stand in it is said, or it holds options of programs.
TEST(Schema, EveryObjectSaysWhatMayStandInIt) {
  int bare = 0;
  each_part(schema(), [&](const Value& part) {
    const Value* type = part.find("type");
    if (type == nullptr || !type->is_string() || type->as_string() != "object") return;
    bare += part.find("properties") == nullptr && part.find("additionalProperties") == nullptr;
  });
  EXPECT_LE(bare, 1) << "provenance's options are the programs' own";
}

TEST(Schema, MechanismsExplanationsAndProvenanceAreDescribed) {
  const Value whole = schema();
  const Value& sections = *whole.find("properties");
  EXPECT_GT(sections.find("mechanisms")->find("properties")->as_object().size(), 60u);
  EXPECT_EQ(sections.find("explanations")->find("items")->find("$ref")->as_string(), "#/$defs/explanation");
  EXPECT_EQ(sections.find("provenance")->find("$ref")->as_string(), "#/$defs/provenance");
}

}  // namespace
}  // namespace gonio::tests
