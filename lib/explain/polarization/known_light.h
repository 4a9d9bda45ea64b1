// Several recordings of one stated scene: what the scene sends is traced for the first of them, and for the others it
// is known. Private to polarization/ and its tests.
#pragma once
#include <memory>
#include <vector>

#include "explain/polarization/mosaic_light.h"
#include "explain/polarization/polarization_problem.h"

namespace gonio::explain {

// As polarization_problems(). What `known` has is not traced again, and what is traced is entered: the files of the
// scene (pictures of its screens, meshes) have the same contents wherever `known` is handed over.
std::vector<std::unique_ptr<Problem>> polarization_problems(const manifest::Document& document,
                                                            const ProblemOptions& options,
                                                            polarization::KnownLight& known);

}  // namespace gonio::explain
