// The schema as it is committed: what fits a line stands in one.
#include <string>
#include <vector>

#include "manifest/reference.h"
#include "manifest/value.h"

namespace gonio::manifest {

namespace {
// `head` stands before it in its first line, one comma may follow.
std::string text_at(const Value& v, const std::string& head, std::size_t depth) {
  constexpr std::size_t width = 120;
  const bool object = v.is_object();
  if (!object && !v.is_array()) return head + print_json(v, -1);
  std::vector<std::string> lines;
  std::size_t length = depth + head.size() + 3;
  const auto add = [&](const std::string& key, const Value& member) {
    lines.push_back(text_at(member, key, depth + 1));
    length += lines.back().find('\n') == std::string::npos ? lines.back().size() + 2 : width;
  };
  if (object)
    for (const auto& [key, member] : v.as_object()) add(print_json(Value(key), -1) + ": ", member);
  else
    for (const Value& member : v.as_array()) add("", member);
  const bool one = length <= width;
  std::string out = head + (object ? "{" : "[");
  for (std::size_t i = 0; i < lines.size(); ++i)
    out += std::string(i == 0 ? "" : one ? ", " : ",") + (one ? "" : "\n" + std::string(depth + 1, ' ')) + lines[i];
  return out + (one ? "" : "\n" + std::string(depth, ' ')) + (object ? "}" : "]");
}
}  // namespace

std::string schema_text(const Value& schema) {
  return text_at(schema, "", 0) + "\n";
}

}  // namespace gonio::manifest
