// Small things about words: numbers as text, names for files, the nearest word.
#pragma once
#include <cstddef>
#include <string>
#include <string_view>

namespace gonio {

std::string shortest_text(double value);  // the shortest digits that read back to the same double
// printf's patterns, of any length.
[[gnu::format(printf, 1, 2)]] std::string format(const char* pattern, ...);
std::string file_stem(std::string_view id);  // an id as part of a file's name: other characters become _
std::size_t edit_distance(std::string_view a, std::string_view b);  // Levenshtein's, for "did you mean"

}  // namespace gonio
