// The entry of the manifest's "explanations": what the page shows, as data (gonio-manifest(5)).
#pragma once
#include "inference/explanation.h"
#include "manifest/value.h"

namespace gonio::inference {

// Written by the field table that readers check it against (manifest/sections/explanation.h).
manifest::Value entry_of(const Problem& problem, const Explanation& explanation, const Illustration& illustration);

}  // namespace gonio::inference
