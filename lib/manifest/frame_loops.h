// What the links of `frames` say of each other: where two ways lead from one frame to another, both say the same.
#pragma once
#include "manifest/document.h"

namespace gonio::manifest {

// Error(data) at NAME#/frames/i where link i goes from a frame to itself, stands twice with different values, or closes
// a loop of links that does not come back to where it began, within 5.5 standard deviations of the way there and back
// along the error (one in a million by chance). A link's deviation is its stated sigma, and in any case the rounding of
// what is written: 2e-6 rad, what a rotation that is orthonormal to 1e-6 leaves open, and one part in a million of the
// translation and a micrometre, the digits of a length in metres.
void check_frames(const Document& document);

}  // namespace gonio::manifest
