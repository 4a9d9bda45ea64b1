// The table of evidence: every observation with what the base model and the upgraded model say of it, and how strongly
// the effect that was found acts on it. For people's own plots, and to judge the location.
//
// CSV, one row per observation in the problem's order: row, group, observed, before, after, sigma, effect. `before` and
// `after` are predictions; `sigma` is the noise after step one; `effect` is |after - before| / sigma where physics is
// named, else what the law beyond the library says over sigma, else what the free curve over the most telling condition
// says: dimensionless, at least zero.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "inference/explanation.h"
#include "manifest/sections/forward.h"

namespace gonio::inference {

std::vector<double> effects(const Problem& problem, const Explanation& explanation);  // one per observation
// Writes evidence-NAME.csv below `out`, enters it in the document and returns its id.
std::string write_evidence(const Problem& problem, const Explanation& explanation, const std::string& name,
                           const std::filesystem::path& out, manifest::Document& document);

}  // namespace gonio::inference
