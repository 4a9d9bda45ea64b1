// Documents against the schema that gonio prints, by a validator that shares no line with gonio's own reader.
#pragma once
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include "manifest/document.h"
#include "manifest/reference.h"
#include "mechanism/reference.h"

namespace gonio::tests {

class SchemaCheck {
 public:
  SchemaCheck() {
    const auto text = nlohmann::json::parse(manifest::print_json(manifest::manifest_schema(mechanism::uses_schema())));
    valijson::SchemaParser().populateSchema(valijson::adapters::NlohmannJsonAdapter(text), schema_);
  }
  // What the schema has against it, the place first; empty: nothing.
  std::string complaint(const std::string& text) const {
    const auto json = nlohmann::json::parse(text);
    valijson::Validator validator;
    valijson::ValidationResults results;
    if (validator.validate(schema_, valijson::adapters::NlohmannJsonAdapter(json), &results)) return "";
    std::string all;
    for (valijson::ValidationResults::Error error; results.popError(error);) {
      for (const std::string& part : error.context) all += part;
      all += ": " + error.description + "\n";
    }
    return all.empty() ? "refused" : all;
  }
  bool valid(const std::string& text) const { return complaint(text).empty(); }

 private:
  valijson::Schema schema_;
};

// What a program wrote: the schema has it, gonio reads it, and what is read is written as it was.
inline void expect_described(const std::string& document) {
  static const SchemaCheck schema;
  EXPECT_EQ(schema.complaint(document), "");
  const manifest::Document read = manifest::parse_document(document, "written", ".", {.allow_outside = true});
  EXPECT_EQ(manifest::canonical_json(manifest::to_value(read, ".")),
            manifest::canonical_json(manifest::parse_json(document, "written")));
}

}  // namespace gonio::tests
