// Tracks as a tracker finds them: what deforms is painted, lit and filmed, and its points are followed through the
// film. They drift, slip and get lost as such tracks do; the truth beside them stays the point of the material that
// each began on.
#pragma once
#include "nrsfm/make/pictures.h"

namespace gonio::nrsfm {

// Tracks of `points_m` (3F x P, on the surface of `motion`) in pixels of `view` (its camera is not used), NaN where not
// followed. A point is followed from the first frame that sees it (`seen`, F x P) and nothing but one surface about it,
// as far as the tracker's patch reaches. There is one camera for each picture of the film, every frame's and as many
// between each two, in which the surface moves evenly. The paint's grain is four pixels of the first picture. Needs
// Motion::material_m.
Tracks flow_tracks(const Motion& motion, const Shapes& points_m, const Visible& seen,
                   const std::vector<CameraFromObject>& cameras, const PictureView& view, std::uint64_t seed);

// How far visible tracks lie from the projected truth, in the tracks' unit; 0 where there are none.
struct TrackErrors {
  double median = 0, upper = 0;  // upper: not exceeded by 95 %
};
TrackErrors track_errors(const Sequence& sequence);

}  // namespace gonio::nrsfm
