// What explain writes is one table: it is read, checked, written and put into the schema by it, key for key.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "base/atomic_file.h"
#include "base/error.h"
#include "data.h"
#include "manifest/document.h"
#include "manifest/explanation_tables.h"
#include "manifest/sections/explanation.h"
#include "schema_check.h"

namespace gonio::manifest {
namespace {

Value fixture() {
  const auto path = std::filesystem::path(GONIO_SOURCE) / "tests/manifest/fixtures/explanations.json";
  return parse_json(read_file(path), "explanations.json");
}

class Explanations : public testing::Test {
 protected:
  static std::string schemas_complaint(const Value& document) {
    static const tests::SchemaCheck schema;
    return schema.complaint(print_json(document));
  }
  static std::string readers_complaint(const Value& document) {
    try {
      parse_document(print_json(document), "test.json", ".");
      return "";
    } catch (const Error& e) {
      return e.what();
    }
  }
  // Reader and schema say the same of a document, and that is `wanted`.
  static void expect(bool wanted, const Value& document, const std::string& what) {
    const std::string schema = schemas_complaint(document), reader = readers_complaint(document);
    EXPECT_EQ(schema.empty(), wanted) << "the schema, " << what << ": " << schema;
    EXPECT_EQ(reader.empty(), wanted) << "the reader, " << what << ": " << reader;
  }
};

// visit(object or list, where it stands) for everything below `value`.
template <class Visit>
void walk(Value& value, const std::string& where, const Visit& visit) {
  if (value.is_object() || value.is_array()) visit(value, where);
  if (value.is_object())
    for (std::size_t i = 0; i < value.as_object().size(); ++i)
      walk(value.as_object()[i].second, where + "/" + value.as_object()[i].first, visit);
  else if (value.is_array())
    for (std::size_t i = 0; i < value.as_array().size(); ++i)
      walk(value.as_array()[i], where + "/" + std::to_string(i), visit);
}

TEST_F(Explanations, AnEntryWithEveryKeyReadsAndIsWrittenAsItWas) {
  const Value document = fixture();
  expect(true, document, "as it is");
  const Value& entry = document.find("explanations")->as_array()[0];
  const ExplanationEntry read = Codec<ExplanationEntry>::read(entry, "entry");
  EXPECT_EQ(print_json(Codec<ExplanationEntry>::write(read)), print_json(entry));
  EXPECT_EQ(read.named.at(0).parameters.at(0).second.size(), 2u);
  EXPECT_EQ(read.located.value().condition, "camera.image-radius");
  EXPECT_EQ(read.not_told_apart.at(1).sets.at(1).size(), 2u);
  EXPECT_DOUBLE_EQ(read.outside.value().terms.at(0).shape.value().scale, 20);
}

// Every field of every table stands in the fixture, so that what follows speaks of all of them.
template <class Record>
void expect_all(const std::vector<Field<Record>>& fields, const std::set<std::string>& keys) {
  for (const auto& f : fields) EXPECT_TRUE(keys.contains(f.name)) << f.name;
}
TEST_F(Explanations, TheEntryHasEveryKey) {
  std::set<std::string> keys;
  Value document = fixture();
  walk(document, "", [&](Value& value, const std::string&) {
    if (value.is_object())
      for (const auto& [key, member] : value.as_object()) keys.insert(key);
  });
  expect_all(explanation_fields(), keys);
  expect_all(named_mechanism_fields(), keys);
  expect_all(misplaced_file_fields(), keys);
  expect_all(outside_library_fields(), keys);
  expect_all(law_term_fields(), keys);
  expect_all(term_shape_fields(), keys);
  expect_all(located_mismatch_fields(), keys);
  expect_all(mismatch_box_fields(), keys);
  expect_all(held_out_score_fields(), keys);
  expect_all(null_test_fields(), keys);
  expect_all(explained_noise_fields(), keys);
  expect_all(negative_controls_fields(), keys);
  expect_all(scored_hypothesis_fields(), keys);
  expect_all(mechanism_visibility_fields(), keys);
  expect_all(shifted_parameter_fields(), keys);
  expect_all(next_measurement_fields(), keys);
  expect_all(planned_measurement_fields(), keys);
  expect_all(planned_view_fields(), keys);
}

TEST_F(Explanations, UnknownKeysAreRefusedAndOwnKeysAreNot) {
  const Value whole = fixture();
  Value document = whole;
  int objects = 0;
  std::vector<std::string> places;
  walk(document, "", [&](Value& value, const std::string& where) {
    if (value.is_object() && !where.empty()) places.push_back(where);
  });
  for (const std::string& place : places)
    for (const bool own : {false, true}) {
      Value changed = whole;
      walk(changed, "", [&](Value& value, const std::string& where) {
        if (where == place) value[own ? "x-mine" : "nobody-knows"] = Value(Value::Array{"text"});
      });
      expect(own, changed, place);
      ++objects;
    }
  EXPECT_GT(objects, 40);
}

// A member of another kind is no member; null stands for numbers alone, and for what may be left out.
TEST_F(Explanations, ValuesOfAnotherKindAreRefusedByBoth) {
  const Value whole = fixture();
  Value document = whole;
  std::vector<std::pair<std::string, std::string>> members;
  walk(document, "", [&](Value& value, const std::string& where) {
    if (value.is_object() && !where.empty())
      for (const auto& [key, member] : value.as_object()) members.emplace_back(where, key);
  });
  int refused = 0;
  for (const auto& [place, name] : members)
    for (const Value& other : {Value(true), Value("text"), Value(-7.5), Value(), Value(Value::Array{Value::object()}),
                               Value::object({{"nobody-knows", "text"}})}) {
      Value changed = whole;
      walk(changed, "", [&, key = &name, at = &place](Value& value, const std::string& where) {
        if (value.is_object() && where == *at) value[*key] = other;
      });
      const bool valid = schemas_complaint(changed).empty();
      EXPECT_EQ(valid, readers_complaint(changed).empty())
          << place << "/" << name << " = " << print_json(other, -1) << "\nschema: " << schemas_complaint(changed)
          << "reader: " << readers_complaint(changed);
      refused += !valid;
    }
  EXPECT_GT(refused, 300);
}

// What explain wrote before there was a table for it.
TEST_F(Explanations, DocumentsOfEarlierVersionsAreRead) {
  for (
      const char* entry :
      {R"({"verdict": "null"})", R"({"verdict": "null", "outside": null, "located": null, "next_measurement": {}})",
       R"({"verdict": "named", "named": [{"mechanism": "lens.radial", "parameters": {"k1": -0.28}, "sigma": {"k1": 1}}],
            "not_told_apart": [["lens.radial"]], "outside": {"condition": "time"}, "sentence": "",
            "located": {"condition": "time", "range": [0, 1], "unit": "s", "share": 1,
                        "conditions": [{"condition": "time", "share": 1, "range": [0, 1], "unit": "s"}]},
            "compensation": [{"parameter": "a", "before": 1, "after": 2, "sigma": null}]})"}) {
    Value document = Value::object({{"gonio", 1}});
    document["explanations"].push_back(parse_json(entry, "entry"));
    expect(true, document, entry);
    EXPECT_EQ(to_value(parse_document(print_json(document), "again", "."), "."), document);
  }
  Value oldest = parse_json(R"({"gonio": 1, "explanations": [{"verdict": "unknown", "outside": "time"}]})", "oldest");
  EXPECT_EQ(readers_complaint(oldest), "") << "its first day";
}

TEST_F(Explanations, NumbersWithoutAValueAreNull) {
  ExplanationEntry entry;
  entry.verdict = "named";
  entry.held_out.before = std::numeric_limits<double>::infinity();
  entry.named.push_back({.mechanism = "lens.radial", .parameters = {{"k1", {not_known}}}});
  const Value written = Codec<ExplanationEntry>::write(entry);
  EXPECT_TRUE(written.find("held_out")->find("before")->is_null());
  EXPECT_TRUE(written.find("named")->as_array()[0].find("parameters")->find("k1")->is_null());
  EXPECT_TRUE(written.find("outside")->is_null());
  EXPECT_TRUE(std::isnan(Codec<ExplanationEntry>::read(written, "entry").held_out.before));
}

}  // namespace
}  // namespace gonio::manifest
