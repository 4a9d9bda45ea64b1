// What a polarization camera reads, its polarizers as they are made (photograph/polarizer_array.h).
#pragma once
#include <vector>

#include "camera/camera_model.h"
#include "io/image.h"
#include "photograph/polarizer_array.h"

namespace gonio::render {

// One channel Y. `stokes`: pictures of three bands each, s0, s1, s2 and, where the array has a retardance, s3.
// `camera`: where its axis meets the picture; null: in the middle.
io::Image polarizer_reading(const std::vector<io::Image>& stokes, const photograph::PolarizerArray& array,
                            const camera::CameraModel* camera);

// From where the axis meets the picture to a pixel, over half the picture's width: PolarizerArray's radius.
Vec2 radius_of(const camera::CameraModel& camera, double x, double y);

}  // namespace gonio::render
