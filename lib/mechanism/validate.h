// The manifest's `mechanisms` section against the registry: ids, parameters, bounds of lists, targets that exist.
#pragma once
#include "manifest/sections/forward.h"

namespace gonio::mechanism {

void validate_uses(const manifest::Document& document);  // Error(data) at NAME#/mechanisms/ID/...

}  // namespace gonio::mechanism
