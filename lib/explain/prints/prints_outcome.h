// What surrounds the prints problem: conditions of its rows, words, the upgraded manifest, pictures. Private to
// prints/.
#pragma once
#include <string>
#include <vector>

#include "explain/prints/ground.h"
#include "explain/prints/map_readings.h"
#include "explain/prints/print_term.h"
#include "inference/explanation.h"

namespace gonio::explain {

struct PrintUse {  // a form of a mechanism, and the places of all its declaration's parameters in the problem
  const prints::Term* term = nullptr;
  prints::Form form;
  std::size_t first = 0;
  std::vector<double> neutral;
};

std::vector<Condition> print_conditions(const PrintsInput& input, const prints::Readings& readings);
std::string prints_remarks(const PrintsInput& input, const prints::Readings& readings);
// Where the use is active: into the print's section, or into the mechanisms.
void upgrade_print(const PrintsInput& input, const PrintUse& use, const Explanation& explanation,
                   manifest::Document& document);
// What was asked apart: print.ground-noise, the candidate at this place, joins what is named.
void conclude_ground(const Problem& problem, const prints::Ground& ground, double layer_um, std::size_t candidate,
                     Explanation& e);
void write_ground(const PrintsInput& input, const prints::Ground& ground, manifest::Document& document);
// What is left of the heights, before and after, from above.
Illustration illustrate_prints(const PrintsInput& input, const prints::Readings& readings,
                               const Explanation& explanation);

}  // namespace gonio::explain
