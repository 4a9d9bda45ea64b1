// See assignment.h.
#include "base/assignment.h"

#include <algorithm>

#include "base/error.h"

namespace gonio {

std::pair<std::string, std::string> parse_assignment(std::string_view text, const std::string& place,
                                                     const std::string& remedy) {
  const std::size_t equals = text.find('=');
  if (equals == std::string_view::npos || equals == 0 || equals + 1 == text.size())
    throw Error(Exit::usage, place, "\"" + std::string(text) + "\" is not NAME=VALUE", remedy);
  return {std::string(text.substr(0, equals)), std::string(text.substr(equals + 1))};
}

std::vector<std::string> pieces(std::string_view text, char separator) {
  std::vector<std::string> all;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(separator, at), text.size());
    all.emplace_back(text.substr(at, end - at));
    at = end + 1;
  }
  return all;
}

}  // namespace gonio
