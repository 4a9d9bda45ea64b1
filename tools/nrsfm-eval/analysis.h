// nrsfm-eval's analysis of variance behind its options: of tables (--table) or of the manifest's evaluations
// (--analyse); what it means is in nrsfm/evaluate/analysis.h.
#pragma once
#include <optional>

#include "cli/program.h"
#include "nrsfm/evaluate/analysis.h"

namespace gonio::tools::nrsfm_eval {

std::vector<cli::Option> analysis_options();
bool analysis_asked(const cli::Invocation& call);
// Error(usage) where nothing would be written, where options of an analysis stand without one, or the other way round.
void check_analysis(const cli::Invocation& call);
// Nothing where none was asked for.
std::optional<nrsfm::Analysis> analysis_of(cli::Invocation& call);
// Below --out, where it was given.
void write_analysis(const cli::Invocation& call, const nrsfm::Analysis& analysis);

}  // namespace gonio::tools::nrsfm_eval
