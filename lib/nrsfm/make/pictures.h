// Pictures of what deforms: painted with noise that sticks to the material, lit, and seen by a virtual camera.
#pragma once
#include <cstdint>
#include <vector>

#include "nrsfm/make/occlusion.h"

namespace gonio::nrsfm {

struct GreyPicture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> value;
  std::vector<float> depth_m;  // along the ray, from somewhere before the object; infinite where nothing is met
};

// A camera and its picture. Places in it are pixels from the upper left corner, the first pixel's centre at 0.5.
struct PictureView {
  CameraFromObject camera;
  Projection projection = Projection::perspective;
  Pinhole pinhole;  // orthographic: x_px = fx x + cx, lengths in metres
  int width = 0, height = 0;
};
// Width of a pixel at a place of the object, metres.
double pixel_m(const PictureView& view, const Eigen::Vector3d& place_m);

// Noise of four octaves, the finest with a lattice of `grain_m`.
struct Paint {
  double grain_m = 0;
  std::uint64_t seed = 1;
};
double albedo(const Paint& paint, const Eigen::Vector3d& material_m);  // 0.05 to 0.95

// A lamp beside the object and light from everywhere; each pixel is the mean of 2 x 2 rays. `material_m`: for every
// vertex of the mesh the place of the paint that sticks to it.
GreyPicture picture_of(const FrameMesh& mesh, const Eigen::Matrix3Xd& material_m, const PictureView& view,
                       const Paint& paint);

// Whether one smooth surface fills the square of 2 half + 1 pixels a side about a place: its depths lie within half
// its size, `extent_m`, of a plane.
bool is_one_surface(const GreyPicture& picture, const Eigen::Vector2d& place_px, int half_px, double extent_m);

}  // namespace gonio::nrsfm
