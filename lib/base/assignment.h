// NAME=VALUE and lists, as people type them on command lines.
#pragma once
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gonio {

// Name and value: what stands before the first '=' and after it. Error(usage) at `place` where either is empty.
std::pair<std::string, std::string> parse_assignment(std::string_view text, const std::string& place,
                                                     const std::string& remedy);
// What the separators part; of an empty text one empty piece.
std::vector<std::string> pieces(std::string_view text, char separator);

}  // namespace gonio
