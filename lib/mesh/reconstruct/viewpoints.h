// Where clouds were seen from, and what frame they lie in: from the poses of images and rigs.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "geom/vector.h"
#include "manifest/sections/forward.h"

namespace gonio::mesh {

// Of each of `clouds` (names in document.clouds): its cameras' and projectors' places in the frame of its points, the
// first that along whose rays it was measured. `stated`: instead, for those that it has. Error(data) where a cloud has
// none, or where clouds do not lie in one frame.
std::vector<std::vector<Vec3>> viewpoints_of(const manifest::Document& document, const std::vector<std::string>& clouds,
                                             const std::map<std::string, Vec3>& stated);

// Places in document.images of what the cloud was made of: as structured-light names clouds, by the group of the
// images, else by their projection.
std::vector<std::size_t> images_of_cloud(const manifest::Document& document, const std::string& cloud);

}  // namespace gonio::mesh
