// Recordings that are explained so badly that no physics can be at fault: a mesh in other units, mirrored or with its
// axes exchanged, poses the wrong way round, pictures that are flipped (readings.h), or files that show something else.
// Asked before any physics, at the scene as it is given, and only where more than `least_own` of the pictures' rms is
// left after every surface was given its own factors (reading_errors.h).
//
// A reading is said where, of the errors e of the pictures as they are and f as they would be meant,
//   - the rms over the pictures at least halves and ends below `most_other`, and
//   - of the pictures with e above `least_own`, at least `agreeing` fall to `fallen` of it.
// Poses and flips may hold for single pictures, too: those with e above `own_of_one` and f below a third of it and
// below twice what is usual of the others. Readings that help without shadows are weighed with them; the least error
// wins, and what does nearly as well (a body may be its own mirror image) is listed beside it.
//
// Where no reading helps: pictures of which the scene explains no more than an even grey does, at an error of at least
// `grey_of_file`; a single one only where most of the others are explained.
#pragma once
#include <vector>

#include "explain/engine.h"
#include "explain/images/model.h"
#include "scene/scene.h"

namespace gonio::explain::images {

inline constexpr double least_own = 0.08, most_other = 0.3, agreeing = 0.8, fallen = 0.75;
inline constexpr double own_of_one = 0.2, grey_of_file = 0.3;

// Nothing where the files are what the scene takes them for. Of a reading, `shows` is the picture as it would be meant;
// of a file that shows something else it is empty words, and `other` the error under an even grey.
Misplaced misread(const scene::Scene& scene, const ImageModel& model);

}  // namespace gonio::explain::images
