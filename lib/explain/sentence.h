// What was found, in plain English, and the cheapest measurement that would say more.
#pragma once
#include "explain/explanation.h"

namespace gonio::explain {

// Fills `sentence` and `next_measurement`.
void write_sentence(const Problem& problem, Explanation& explanation);
std::string printed(double value, int digits = 3);  // significant digits, no trailing zeros

// Units as people use them: degrees for angles, millimetres for small lengths, milliseconds for short times, per cent
// for small shares. `size`: of the numbers to be shown together.
struct Shown {
  double factor = 1;
  std::string unit;  // empty: a plain number
};
Shown shown_in(const std::string& unit, double size);
std::string quantity(double value, const std::string& unit, int digits = 2);  // "18 degrees", "0.8 m", "3.1 mm"

}  // namespace gonio::explain
