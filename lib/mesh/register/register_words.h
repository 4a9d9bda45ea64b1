// What was found of views, as lines of the log, and as sentences that the page shares.
#pragma once
#include <string>
#include <vector>

#include "mesh/register.h"

namespace gonio::mesh {

std::string consistency_sentence(const Consistency& c);  // "views agree: ...", whose fault it is where they do not
std::string shift_words(const ViewShift& shift);         // "0.31 +- 0.02 mm, 0.12 +- 0.01 deg"
void log_registration(const Registration& found, const std::vector<std::string>& names, const RegisterWish& wish);

}  // namespace gonio::mesh
