// The engine below, by the names that the domains use: a domain is a Problem, and what comes of it an Explanation.
#pragma once
#include "inference/engine.h"
#include "inference/problem.h"

namespace gonio::explain {

using namespace inference;
using inference::explain;  // beside the namespace of that name

}  // namespace gonio::explain
