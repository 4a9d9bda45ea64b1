// From a manifest to an explained manifest: every domain is explained, its sections upgraded, its entry written, one
// page for all.
#pragma once
#include <filesystem>
#include <string>

#include "base/error.h"
#include "explain/domain.h"
#include "explain/engine.h"
#include "manifest/sections/forward.h"

namespace gonio::explain {

struct ExplainRequest {
  Options options;
  ProblemOptions recordings;
  std::size_t resample = 0;    // so many draws of a part of the recordings are explained as well (Stability)
  std::filesystem::path out;   // folder for masks; empty: none are written
  std::filesystem::path page;  // report page; empty: none
};
// done: nothing is left out, or it is named. negative: a mismatch that matters and no physics for it. quality: the fit
// did not converge, or a tenth of the observations had to be set aside.
Exit explain_document(manifest::Document& document, const ExplainRequest& request);

// The mechanisms that explain knows: id, sentence, conditions, confusions. Plain text.
std::string list_of_mechanisms();
// Error(usage) at --hypotheses for ids that are not registered.
void check_hypotheses(const std::vector<std::string>& ids);

}  // namespace gonio::explain
