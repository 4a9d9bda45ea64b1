// Patterns of views: what a person asks for in one word and a few numbers, spread out into steps that say where the
// camera and the lamp are to be; who gets them there is plan/planner.h's matter. One file a pattern:
// lib/acquisition/plan/patterns/<name>.cpp defines `const ViewPattern& <name>()` in namespace
// gonio::acquisition::patterns; the program's options, its manual page and its validation come from the list.
#pragma once
#include <map>
#include <span>
#include <string>
#include <vector>

#include "geom/angle.h"
#include "manifest/sections/plan.h"

namespace gonio::acquisition {

struct PatternParameter {
  std::string name;  // as on the command line, without its unit: "step"
  std::string unit;  // of its value here: "rad", "m", "1", "s"
  double preset = 0;
  double lower = 0, upper = 0;
  std::string meaning;
};
using PatternNumbers = std::map<std::string, double>;  // by name, presets filled in, within their bounds

// What all patterns are told besides their own numbers.
struct PatternScene {
  Vec3 target_m{};   // world: what is looked at
  Vec3 up{0, 0, 1};  // world: pole of hemispheres; the picture's upper edge looks along it where it can
  std::string camera;
  std::vector<std::string> lamps;  // the first is the one that is moved, where an arm holds it
  std::vector<double> exposures_s;
  std::string turntable{};  // that a series turns
};

struct ViewPattern {
  std::string name;      // "hemisphere"
  std::string sentence;  // what it is, in one plain sentence
  std::string source;    // who uses it
  std::vector<PatternParameter> parameters;
  // Steps without joints, in the order in which a person would name them; cameras stand by render/looking_at.h. Error
  // (usage) where the scene lacks what the pattern needs: lamps, a turntable.
  std::vector<manifest::PlanStep> (*make)(const PatternScene& scene, const PatternNumbers& numbers);
};
std::span<const ViewPattern* const> all_view_patterns();  // by name; defined in a generated source

// The pattern's presets with `given` over them. Error(usage) at `place` for names that the pattern does not have and
// for values out of their bounds.
PatternNumbers pattern_numbers(const ViewPattern& pattern, const PatternNumbers& given, const std::string& place);
// Error(usage) at `place` that lists the names there are.
const ViewPattern& find_view_pattern(const std::string& name, const std::string& place);

}  // namespace gonio::acquisition
