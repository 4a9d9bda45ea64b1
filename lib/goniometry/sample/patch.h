// A flat patch in the plane z = 0 of its own frame, and the pixels of a picture that lie wholly on it.
//
// A pixel is the quadrangle in which the rays through its four corners meet the plane; its area there is its weight, so
// that means over pixels are means over the patch's area whatever the lens does. Pixels that the patch's edge cuts are
// left out: they show what lies beside it.
#pragma once
#include <string>
#include <vector>

#include "camera/camera_model.h"
#include "geom/rigid.h"
#include "manifest/sections/forward.h"

namespace gonio::goniometry {

class Patch {
 public:
  // Error(data) at `place` for fewer than three corners, no area, numbers that are none.
  Patch(const manifest::FlatPatch& entry, const std::string& place);
  bool holds(Vec2 at) const;
  const std::vector<Vec2>& corners() const { return corners_; }  // of the polygon; of a disc 96 of them
  Vec2 middle() const { return middle_; }                        // the centroid
  double extent_m() const { return extent_m_; }                  // longest distance of a corner from it

 private:
  std::vector<Vec2> corners_;
  Vec2 middle_;
  double extent_m_ = 0;
};

struct PatchPixel {
  int x = 0, y = 0;
  Vec2 at;  // where its middle lies on the patch
  double area_m2 = 0;
};

struct Footprint {
  std::vector<PatchPixel> pixels;  // wholly within the patch
  std::string refusal;             // why there are none: the patch faces away or leaves the picture
};
Footprint footprint(const Patch& patch, const camera::CameraModel& camera,
                    const Rigid<frame::Camera, frame::Object>& camera_from_patch);

}  // namespace gonio::goniometry
