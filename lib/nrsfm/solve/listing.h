// The registries of solvers and animatronics as people read them: `nrsfm-solve --list` prints list_of_solvers(),
// gonio-nrsfm(7) is made of markdown().
#pragma once
#include <string>

namespace gonio::nrsfm {

std::string list_of_solvers();  // what they assume, their papers and parameters
std::string markdown();

}  // namespace gonio::nrsfm
