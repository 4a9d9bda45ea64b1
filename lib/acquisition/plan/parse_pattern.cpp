// See parse_pattern.h.
#include "acquisition/plan/parse_pattern.h"

#include "base/assignment.h"
#include "base/error.h"
#include "base/quantity.h"
#include "base/text.h"

namespace gonio::acquisition {
namespace {

const ViewPattern& pattern_named(const std::string& name, const std::string& place) {
  std::string known;
  for (const ViewPattern* pattern : all_view_patterns()) {
    if (pattern->name == name) return *pattern;
    known += (known.empty() ? "" : ", ") + pattern->name;
  }
  throw Error(Exit::usage, place, "there is no pattern \"" + name + "\"", "there are " + known);
}

const PatternParameter& parameter_named(const ViewPattern& pattern, const std::string& name, const std::string& place) {
  std::string known;
  for (const PatternParameter& p : pattern.parameters) {
    if (p.name == name) return p;
    known += (known.empty() ? "" : ", ") + p.name;
  }
  throw Error(Exit::usage, place, pattern.name + " has no number \"" + name + "\"", "it takes " + known);
}

}  // namespace

PatternCall parse_pattern(const std::string& text, const std::string& place) {
  const std::size_t colon = text.find(':');
  PatternCall call;
  call.pattern = &pattern_named(text.substr(0, colon), place);
  for (const PatternParameter& p : call.pattern->parameters) call.numbers[p.name] = p.preset;
  if (colon != std::string::npos)
    for (const std::string& item : pieces(std::string_view(text).substr(colon + 1), ',')) {
      const auto [name, value] = parse_assignment(item, place, "type, say, " + call.pattern->name + ":NAME=VALUE");
      const PatternParameter& p = parameter_named(*call.pattern, name, place);
      const double number = parse_in_unit(value, p.unit, place);
      if (!(number >= p.lower && number <= p.upper))
        throw Error(Exit::usage, place, name + " " + value + " is out of bounds",
                    format("give %g to %g %s", p.lower, p.upper, p.unit == "1" ? "" : p.unit.c_str()));
      call.numbers[name] = number;
    }
  call.words = call.pattern->name;
  for (const PatternParameter& p : call.pattern->parameters)
    call.words += format(", %s %g", p.name.c_str(), call.numbers[p.name]) + (p.unit == "1" ? "" : " " + p.unit);
  return call;
}

}  // namespace gonio::acquisition
