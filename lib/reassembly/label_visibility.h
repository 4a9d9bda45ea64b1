// What one view sees of a mesh: a depth per pixel, and whether a point lies at that depth.
#pragma once
#include <optional>
#include <vector>

#include "reassembly/labels.h"

namespace gonio::reassembly {

class Visibility {
 public:
  // Keeps `view` by reference. Pictures larger than some megapixels get a coarser depth.
  Visibility(const io::TriangleMesh& mesh, const LabelView& view);

  // The pixel position of a point of a surface with this unit normal, where the view sees it from the front, clear of
  // what stands before it by two pixels of depth; `cosine` is that of its incidence.
  struct Seen {
    Vec2 pixel;
    double cosine = 0;
    bool at_edge = false;  // beside it the view sees something far behind: the pixel may show both
  };
  std::optional<Seen> sees(Vec3 point_m, Vec3 normal) const;
  std::optional<Vec2> project(Vec3 point_m) const { return view_->camera->project(camera_from_world_ * point_m); }

 private:
  struct Corner {
    Vec3 point_m;  // camera frame
    Vec2 pixel;
    double depth = 0;  // as it is interpolated: 1 / distance; orthographic: -z
    bool seen = false;
  };
  Corner corner(Vec3 camera_m) const;
  void draw(const Corner& a, const Corner& b, const Corner& c, int deep);
  void fill(const Corner& a, const Corner& b, const Corner& c);
  bool even(const Corner& a, const Corner& b) const;

  const LabelView* view_;
  Rigid<frame::Camera, frame::World> camera_from_world_;
  int coarse_ = 1, width_ = 0, height_ = 0;
  double pixel_ = 0;          // of the coarse picture, at most: rad, or m where orthographic
  std::vector<float> depth_;  // the greatest `Corner::depth`; lowest: nothing there
};

}  // namespace gonio::reassembly
