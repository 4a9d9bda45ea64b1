// Reference material printed from a program's description: man page and shell completions.
#pragma once
#include <string>
#include <string_view>

#include "cli/program.h"

namespace gonio::cli {

// man1 page, its sections in the order of man-pages(7). `prose`: the hand-written Markdown. Its own sections follow
// "# DESCRIPTION" in their order, "# EXAMPLES" and remarks such as "# NOTES" stand late; what it says under the name of
// a section that comes from the description (OPTIONS, EXIT STATUS, FILES, REFERENCES, SEE ALSO) opens that section.
std::string man_page(const Program& program, std::string_view prose);
// Header of any other page of the manual: .TH and NAME.
std::string man_header(const std::string& name, int section, const std::string& sentence);

std::string bash_completion(const Program& program);
std::string zsh_completion(const Program& program);
std::string fish_completion(const Program& program);

}  // namespace gonio::cli
