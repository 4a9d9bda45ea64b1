// Mechanisms: every optional term of a simulator is a hypothesis about the physics that was left out.
//
// A mechanism is declared once, in one file (lib/<subject>/mechanisms/<name>.cpp; the file's stem with '_' for '.' and
// '-' names the function: lens_radial.cpp defines `const Mechanism& lens_radial()`). The build gathers all into
// all_mechanisms(). An equation that more than one simulator evaluates stands in the header beside it, in namespace
// gonio::equation, and nowhere else. Simulators bind to mechanisms in files of their own (scene/edits, render/links,
// explain/*/terms, ...), `explain` walks the list, the man page and the schema are printed from it. At the neutral
// values the term vanishes exactly.
#pragma once
#include <span>
#include <string>
#include <vector>

namespace gonio::mechanism {

struct Parameter {
  std::string name;             // with its unit: "radius_m", "k1"
  std::string unit;             // "m", "rad", "1", ...
  double neutral = 0;           // the term vanishes here
  double lower = 0, upper = 0;  // physical bounds of a plausible fit
  double start = 0;             // where a fit begins (never the neutral value where the slope vanishes there)
  // Usual size of a deviation from the neutral value, one standard deviation (of what has no effect by itself, such as
  // the roughness of a gloss: from where a fit begins); 0: it goes with the scene's own units, or any value is as
  // usual.
  double typical = 0;
  std::string meaning{};
};
struct Confusion {
  std::string with;        // canonical id (or a plain word where the list has none)
  std::string told_apart;  // the cheapest measurement that separates the two
};
struct Input {  // what an equation needs to know of one value, besides the parameters
  std::string name, unit;
  double lower = 0, upper = 1;  // in which it is met
};
enum class Target { scene, surface, light, camera, board, object };  // what one set of parameters belongs to

struct Mechanism {
  std::string id;        // canonical: "lens.radial"
  std::string sentence;  // what it is, in one plain sentence
  std::string typical;   // size met in practice, with its unit: "10-50 % at the picture's edge"
  std::string equation;  // in plain text, with the parameter names above
  std::string source;    // paper, equation number
  std::string stage;     // of the simulator: board, lens, optics, sensor, light, surface, transport, pose
  Target target = Target::scene;
  std::vector<std::string> domains;  // "boards", "images"
  std::vector<Parameter> parameters;
  std::vector<std::string> conditions;  // that carry its signature, the most telling first: "camera.image-radius"
  std::vector<Confusion> mistaken_for;
  // The equation, where it takes one value to another: `at` has the inputs and `p` the parameters in their order. `v`
  // comes back to the last bit at the neutral values; a factor is never negative within the bounds.
  std::vector<Input> inputs{};
  double (*act)(double v, std::span<const double> at, std::span<const double> p) = nullptr;
  bool lists = false;  // in a manifest its numbers are lists of one length: an entry for each thing that it tells of
};

std::span<const Mechanism* const> all_mechanisms();  // sorted by id; defined in a generated source
const Mechanism* find_mechanism(const std::string& id);

}  // namespace gonio::mechanism
