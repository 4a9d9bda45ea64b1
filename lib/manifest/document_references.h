// What sections of the manifest say of each other: names that stand in the section they refer to, ids that stand once,
// columns that a table has.
#pragma once
#include "manifest/document.h"

namespace gonio::manifest {

void check_references(const Document& document);  // Error(data) at NAME#/json/pointer

}  // namespace gonio::manifest
