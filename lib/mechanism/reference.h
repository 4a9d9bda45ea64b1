// The schema of the manifest's `mechanisms`, printed from the registry.
#pragma once
#include "manifest/value.h"

namespace gonio::mechanism {

manifest::Value uses_schema();  // every mechanism with its parameters; for manifest::manifest_schema

}  // namespace gonio::mechanism
