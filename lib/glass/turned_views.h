// The views of one object of a set as one recording: the object stands still, cameras and screens go round it, each
// view with a screen of its own. What a person has who photographed it: mosaics under the screen's light, masks, no
// shape. glass-refine(1) reads it.
#pragma once
#include "glass/set.h"

namespace gonio::glass {

// Of cells that are made. World: the object's own frame, its platform at z = -0.2 mm. Masks are written to the set's
// folder of masks; the document belongs into the set's folder. Its images are "view-0", "view-1", ...
manifest::Document turned_views(const GlassSet& set, std::size_t object);

}  // namespace gonio::glass
