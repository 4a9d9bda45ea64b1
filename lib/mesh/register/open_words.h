// Names for motions that nothing holds: slides first, then what is left as turns about axes.
#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

#include "mesh/register/overlap.h"

namespace gonio::mesh {

// `open`: six rows, orthonormal columns: motions of one view, as in overlap.h.
std::vector<std::string> open_words(const Eigen::MatrixXd& open, const MotionScale& scale);

}  // namespace gonio::mesh
