// Reference material printed from the field tables: JSON Schemas and the tables of gonio-manifest(5).
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "manifest/value.h"

namespace gonio::manifest {

// JSON Schema (draft 7) of the whole document; surfaces and lights list the registered models.
Value manifest_schema();
// Markdown: one heading and one table of fields per section, for the manual page.
std::string manifest_fields_text();

}  // namespace gonio::manifest
