// A pattern as typed on a command line: NAME or NAME:NUMBER=VALUE,NUMBER=VALUE. Quantities take units as elsewhere:
// hemisphere:step=10deg,radius=40cm.
#pragma once
#include <string>

#include "acquisition/plan/view_pattern.h"

namespace gonio::acquisition {

struct PatternCall {
  const ViewPattern* pattern = nullptr;
  PatternNumbers numbers;  // all of them, presets filled in
  std::string words;       // "hemisphere, step 0.1745 rad, radius 0.4 m"
};
// Error(usage) at `place`: unknown names list those there are, numbers outside their bounds say these.
PatternCall parse_pattern(const std::string& text, const std::string& place);

}  // namespace gonio::acquisition
