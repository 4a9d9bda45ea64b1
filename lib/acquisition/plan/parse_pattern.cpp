// See parse_pattern.h.
#include "acquisition/plan/parse_pattern.h"

#include <algorithm>

#include "base/assignment.h"
#include "base/quantity.h"
#include "base/text.h"
#include "geom/angle.h"

namespace gonio::acquisition {

PatternCall parse_pattern(const std::string& text, const std::string& place) {
  const std::size_t colon = text.find(':');
  PatternCall call;
  call.pattern = &find_view_pattern(text.substr(0, colon), place);
  PatternNumbers given;
  if (colon != std::string::npos)
    for (const std::string& item : pieces(std::string_view(text).substr(colon + 1), ',')) {
      const auto [name, value] = parse_assignment(item, place, "type, say, " + call.pattern->name + ":NAME=VALUE");
      const auto p = std::ranges::find(call.pattern->parameters, name, &PatternParameter::name);
      given[name] = p == call.pattern->parameters.end() ? 0 : parse_in_unit(value, p->unit, place);
    }
  call.numbers = pattern_numbers(*call.pattern, given, place);
  call.words = call.pattern->name;
  for (const PatternParameter& p : call.pattern->parameters) {
    const bool is_angle = p.unit == "rad";
    call.words += format(", %s %g", p.name.c_str(), call.numbers[p.name] / (is_angle ? degree : 1));
    if (p.unit != "1") call.words += " " + (is_angle ? "deg" : p.unit);
  }
  return call;
}

}  // namespace gonio::acquisition
