// The field tables of structured light: what is shown, and the points that come out.
#include "manifest/field_makers.h"
#include "manifest/section_tables.h"
#include "manifest/sections/cloud.h"
#include "manifest/sections/projection.h"

namespace gonio::manifest {

const std::vector<Field<ProjectedFrame>>& projected_frame_fields() {
  using F = ProjectedFrame;
  static const std::vector<Field<F>> table{
      field("show", &F::show, "", "what it is").one_of({"white", "black", "bit", "cosine"}).needed(),
      field("file", &F::file, "", "file id of the picture"),
      field("axis", &F::axis, "", "of bit and cosine: what it tells of the projector's pixel")
          .one_of({"column", "row"}),
      field("bit", &F::bit, "", "of the Gray code of the column or row, 0 the finest").range(0, 31),
      field("inverse", &F::inverse, "", "bit: dark where the bit is set"),
      field("periods", &F::periods, "", "cosine: over the whole width or height").positive(),
      field("shift_rad", &F::shift_rad, "rad",
            "cosine: light = (1 + cos(2 pi periods (u + 1/2) / size - shift)) / 2, u the column or row")};
  return table;
}

const std::vector<Field<Projection>>& projection_fields() {
  static const std::vector<Field<Projection>> table{
      field("width_px", &Projection::width_px, "", "of the projector").range(1, 1 << 16).needed(),
      field("height_px", &Projection::height_px, "", "of the projector").range(1, 1 << 16).needed(),
      field("frames", &Projection::frames, "", "in the order in which they are shown").needed()};
  return table;
}

const std::vector<Field<Cloud>>& cloud_fields() {
  static const std::vector<Field<Cloud>> table{
      field("file", &Cloud::file, "", "file id of the PLY file").needed(),
      field("cameras", &Cloud::cameras, "", "that saw it, the first one first; a projector is one"),
      field("projection", &Cloud::projection, "", "name in projections"),
      field("points", &Cloud::points, "", "how many").range(0, infinite),
      field("sigma_m", &Cloud::sigma_m, "m", "median of the points' largest standard deviation").range(0, infinite),
      field("reprojection_px", &Cloud::reprojection_px, "px",
            "median distance of a point's pictures from where they were seen")
          .range(0, infinite),
      field("epipolar_chi_square", &Cloud::epipolar_chi_square, "",
            "how far two cameras contradict each other, over what the stated noise says; 1: as much")
          .range(0, infinite),
      field("refused", &Cloud::refused, "", "pixels of the first camera without a point, by reason")};
  return table;
}

GONIO_RECORD(ProjectedFrame, projected_frame_fields);
GONIO_RECORD(Projection, projection_fields);
GONIO_RECORD(Cloud, cloud_fields);

}  // namespace gonio::manifest
