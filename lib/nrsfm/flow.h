// Tracks as a tracker finds them: what deforms is painted, lit and rendered, and its points are followed from picture
// to picture by pyramidal Lucas-Kanade (Bouguet 2000). They drift, slip and get lost as such tracks do; the truth
// beside them stays the point of the material that each began on.
#pragma once
#include <cstdint>
#include <vector>

#include "nrsfm/camera_paths.h"
#include "nrsfm/occlusion.h"

namespace gonio::nrsfm {

struct GreyPicture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> value;
};

// A camera and its picture. Places in it are pixels from the upper left corner, the first pixel's centre at 0.5.
struct PictureView {
  CameraFromObject camera;
  Projection projection = Projection::perspective;
  Pinhole pinhole;  // orthographic: x_px = fx x + cx, lengths in metres
  int width = 0, height = 0;
};

// Paint that sticks to the material: noise of four octaves, the finest with a lattice of `grain_m`.
struct Paint {
  double grain_m = 0;
  std::uint64_t seed = 1;
};
// A lamp beside the object and light from everywhere; each pixel is the mean of 2 x 2 rays. Needs Motion::material_m.
GreyPicture picture_of(const Motion& motion, Eigen::Index frame, const PictureView& view, const Paint& paint);

// Points that begin at `start_px` (2 x P) of the first picture; NaN: nowhere. In each picture a point is found again
// where the way back ends within `back_px` of where it came from; else it is lost, and stays so. 2F x P.
Tracks follow(const std::vector<GreyPicture>& pictures, const Tracks& start_px, double back_px = 0.5);

// Tracks of `motion` before `cameras` in pixels of `view` (its camera is not used), NaN where lost. Points that the
// first camera does not see are never found. The paint's grain is two and a half pixels of the first picture.
Tracks flow_tracks(const Motion& motion, const std::vector<CameraFromObject>& cameras, const PictureView& view,
                   std::uint64_t seed);

// How far visible tracks lie from the projected truth, in the tracks' unit; 0 where there are none.
struct TrackErrors {
  double median = 0, upper = 0;  // upper: not exceeded by 95 %
};
TrackErrors track_errors(const Sequence& sequence);

}  // namespace gonio::nrsfm
