// Reference material printed from the field tables: JSON Schemas and the tables of gonio-manifest(5) and
// gonio-surfaces(7).
#pragma once
#include <string>

#include "manifest/value.h"

namespace gonio::manifest {

// JSON Schema (draft 7) of the whole document; surfaces and lights list the registered models. What is used more than
// once stands under "$defs". `mechanisms`: the schema of that section, whose registry lies above
// (mechanism/reference.h).
Value manifest_schema(const Value& mechanisms);
std::string schema_text(const Value& schema);  // as a file: what fits a line stands in one
// Markdown: one heading and one table of fields per section, for the manual page.
std::string manifest_fields_text();
// Markdown: the registered surface models and laws with their parameters, defaults and bounds.
std::string surface_models_text();

// A cell of a Markdown table, in which a bar would begin the next one.
std::string in_cell(const std::string& text);

}  // namespace gonio::manifest
