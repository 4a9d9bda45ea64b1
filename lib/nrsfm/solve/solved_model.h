// From a solver's answer to the model that it believes in (deforming_model.h).
#pragma once
#include <string>

#include "nrsfm/sequence.h"
#include "nrsfm/solve/deforming_model.h"

namespace gonio::nrsfm {

struct Solved {
  Sequence sequence;
  Reconstruction reconstruction;  // object frame, with rotations
  bool free_scales = false;       // the solver gave every frame a scale of its own
  std::string place;              // for messages
};

// The shapes' weights over time are their temporal singular vectors, as many as leave a thousandth of the shapes. Where
// as many cosines hold these they are fixed, as a trajectory basis fixes them. Otherwise they are free in every frame:
// that they are smooth, or one of them constant, is a solver's guess, and a scale for every frame would take up
// whatever of the deformation is not. At most 48 frames (more where the shapes are many) and 40 points take part,
// evenly taken, unless `all` do. Error(data) where rotations are missing, or too little is left to judge a model of so
// many shapes.
SolvedModel solved_model(const Solved& solved, bool all = false);

}  // namespace gonio::nrsfm
