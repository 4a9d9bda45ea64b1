// develop --merge: raw frames to radiance. Options and call, and what other modes ask of raw frames as well.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "cli/program.h"
#include "photograph/raw_frame.h"

namespace gonio::tools::develop {

std::vector<cli::Option> merge_options();
void check_merge(cli::Invocation& call);
Exit merge(cli::Invocation& call);

// Files given by an option or operand, and what --mosaic, --black and --full-scale state.
std::vector<std::filesystem::path> paths(const cli::Invocation& call, const std::string& option);
photograph::RawStated stated(const cli::Invocation& call);

}  // namespace gonio::tools::develop
