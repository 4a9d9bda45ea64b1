// Recordings whose files belong to other pictures of the set (metric/mix_ups.h), at the scene as it is given: asked
// before any physics, which would be fitted to the wrong pictures.
#pragma once
#include <string>
#include <vector>

#include "explain/engine.h"
#include "explain/images/model.h"

namespace gonio::explain::images {

// `picked`: per image, places in its view's cache.
Misplaced misplaced_files(const Recordings& recordings, const ImageModel& model,
                          const std::vector<std::vector<std::uint32_t>>& picked);

}  // namespace gonio::explain::images
