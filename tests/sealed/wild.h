// Cases that another renderer recorded (tests/wild, in Python): their truths, which names count for an effect, and what
// is asked of them.
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "sealed/judge.h"

namespace gonio::sealed {

// Effect -> names of the library that count for it, the first stands for all; none: outside the library.
using Rights = std::map<std::string, std::vector<std::string>>;
Rights read_rights(const std::filesystem::path& file);  // tests/wild/right.json

// The truth NAME.json, with NAME.effect beside it, of the folder of truths; names as `rights` has them now.
Case read_wild_truth(const std::filesystem::path& truths, const std::string& name, const Rights& rights);
// Names that count for an effect of this case become the first of them.
void use_first_names(const Case& made, const Rights& rights, Answer& answer);

Asking wild_asking();

}  // namespace gonio::sealed
