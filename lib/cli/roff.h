// A little Markdown to roff, for the hand-written prose of man pages: "# HEADING", paragraphs, "- item" lists, fenced
// code, `code`, **bold**, *emphasis* (a star that opens neither is a star), and "| a | b |" tables, with "\|"
// for a bar within a cell.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace gonio::cli {

std::string roff_text(std::string_view text);  // one line: escapes, `code`, **bold**, *emphasis*
std::string roff_from_markdown(std::string_view text);
// The part of `text` below the heading "# NAME" up to the next one; empty where there is none.
std::string section_of(std::string_view text, std::string_view name);
// The names of the "# NAME" headings, in their order.
std::vector<std::string> headings_of(std::string_view text);
// A section "# CONTENTS" that names the headings of `text` and the "## parts" under each; empty where there are fewer
// parts than that, and the text is not long either.
std::string contents_of(std::string_view text, std::size_t fewest = 12);

}  // namespace gonio::cli
