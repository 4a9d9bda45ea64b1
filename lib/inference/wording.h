// Numbers, units and names as people read them.
#pragma once
#include <string>
#include <vector>

#include "inference/explanation.h"

namespace gonio::inference {

std::string printed(double value, int digits = 3);       // significant digits, no trailing zeros
std::string plain_number(double value, int digits = 2);  // no exponents for large ones: "243"

// Units as people use them: degrees for angles, millimetres for small lengths, milliseconds for short times. `size`: of
// the numbers to be shown together.
struct Shown {
  double factor = 1;
  std::string unit;  // empty: a plain number
};
Shown shown_in(const std::string& unit, double size);
std::string quantity(double value, const std::string& unit, int digits = 2);         // "18 degrees", "0.8 m", "3.1 mm"
std::string share_in_words(double share);                                            // "3.1 %"; no exponents
std::string probability_in_words(double probability);                                // "94 %", "over 99 %"
std::string score_in_words(double score, const std::string& unit);                   // ratios as per cent
std::string estimate_in_words(double value, double sigma, const std::string& unit);  // "35.0 ± 0.4 mm"

std::string condition_in_words(const std::string& name);  // "surface.half-angle": "half angle"
// "above 0.6 of the half diagonal", "between 20 and 45 degrees"; empty where it is everywhere.
std::string range_in_words(const LocatedCondition& located);
// "the half angle"; "bands along the image y, 17 px from one to the next, begun anew in every image".
std::string place_in_words(const Problem& problem, const LocatedCondition& located);
// Below these shares of the excess, and of what the named physics does, a condition does not say where the mismatch is,
// and that is then said.
inline constexpr double telling_share = 0.2, telling_share_of_effect = 0.5;
bool tells_where(const LocatedCondition& located);
// "no condition carries it: the most telling, the hue, holds 4 % of the excess"
std::string nowhere_in_words(const Problem& problem, const LocatedCondition& located);
std::string mechanism_in_words(const Problem& problem, std::size_t candidate);  // "surface.interface on bunny"
// The mechanism's sentence, with its id, its targets and its clearest numbers by what they mean: "A clear interface
// lies over the matte base ... (surface.interface on bunny: reflectance at normal incidence 0.043 ± 0.002, ...)."
std::string physics_in_words(const Problem& problem, const Explanation& explanation, std::size_t candidate);
// Ids of mechanisms that are there, but matter too little; each once, and none that is named.
std::vector<std::string> minor_mechanisms(const Problem& problem, const Explanation& explanation);
// "f0 0.043 ± 0.002, alpha 0.10 ± 0.01": of one named candidate, the two clearest. By their names, or by what the
// mechanism declares that they mean.
enum class Called { by_name, by_meaning };
std::string parameters_in_words(const Problem& problem, const Explanation& explanation, std::size_t candidate,
                                Called called = Called::by_name);

}  // namespace gonio::inference
