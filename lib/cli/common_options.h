// Options that mean the same in every program, as data like all others.
#pragma once
#include <string>
#include <vector>

#include "cli/program.h"

namespace gonio::cli {

std::vector<Option> common_options(const Program& program);  // those that `program` takes
Option report_option();                                      // --html, of every program that reports
// A name as people type it: "--poses"; operands, whose names are capitals, as they are.
std::string option_text(const std::string& name);
std::string metavar_of(const Option& option);  // its own, or one that its type suggests; empty for flags

}  // namespace gonio::cli
