// ASCII letters in lower case, whatever the locale; all other bytes as they are.
#pragma once
#include <string>

namespace gonio {

inline std::string lower_case(std::string text) {
  for (char& c : text) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  return text;
}

}  // namespace gonio
