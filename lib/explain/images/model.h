// The image model below, room relighting, by the names that this domain uses.
#pragma once
#include "relighting/image_model.h"

namespace gonio::explain::images {

using namespace relighting;

}  // namespace gonio::explain::images
