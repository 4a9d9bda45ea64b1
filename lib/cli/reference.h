// Reference material printed from a program's description: man page and shell completions.
#pragma once
#include <string>
#include <string_view>

#include "cli/program.h"

namespace gonio::cli {

// man1 page. `prose`: the hand-written Markdown with "# DESCRIPTION" and "# EXAMPLES"; OPTIONS, EXIT STATUS, FILES,
// REFERENCES and SEE ALSO come from the description.
std::string man_page(const Program& program, std::string_view prose);
// Header of any other page of the manual: .TH and NAME.
std::string man_header(const std::string& name, int section, const std::string& sentence);

std::string bash_completion(const Program& program);
std::string zsh_completion(const Program& program);
std::string fish_completion(const Program& program);

}  // namespace gonio::cli
