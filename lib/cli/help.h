// --help and --describe from a program's description; the man page generator uses the same pieces.
#pragma once
#include <string>

#include "cli/program.h"

namespace gonio::cli {

std::string help_text(const Program& program);
manifest::Value describe(const Program& program);
std::string head_of(const Option& option);     // "-i, --input FILE"
std::string limits_of(const Option& option);   // "0 to 1 m", "" where there are none
std::string remarks_of(const Option& option);  // default, limits, company, separated by semicolons

}  // namespace gonio::cli
