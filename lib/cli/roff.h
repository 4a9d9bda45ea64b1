// A little Markdown to roff, for the hand-written prose of man pages: "# HEADING", paragraphs, "- item" lists, fenced
// code, `code`,
// **bold**, *emphasis*, and "| a | b |" tables.
#pragma once
#include <string>
#include <string_view>

namespace gonio::cli {

std::string roff_text(std::string_view text);  // one line: escapes, `code`, **bold**, *emphasis*
std::string roff_from_markdown(std::string_view text);
// The part of `text` below the heading "# NAME" up to the next one; empty where there is none.
std::string section_of(std::string_view text, std::string_view name);

}  // namespace gonio::cli
