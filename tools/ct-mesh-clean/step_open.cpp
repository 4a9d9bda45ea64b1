// Step: open the volume; where its voxels lie is read or asked for, never guessed.
#include "base/text.h"
#include "tools/ct-mesh-clean/work.h"

namespace gonio::tools::ct_mesh_clean {
namespace {

double determinant(const Mat3& a) {
  return dot(Vec3{a(0, 0), a(1, 0), a(2, 0)}, cross(Vec3{a(0, 1), a(1, 1), a(2, 1)}, Vec3{a(0, 2), a(1, 2), a(2, 2)}));
}

}  // namespace

void open(Work& work) {
  const std::string& path = work.path;
  work.file = io::open_volume(path, work.asked.file);
  const io::VolumeHead& head = work.file->head();
  for (const auto& file : head.files) work.call.note_input(file);
  work.spacing_m = io::stated_spacing(head);
  work.origin_m = head.origin_m.value_or(Vec3{});
  work.axes = head.axes.value_or(Mat3{});
  work.left_handed = determinant(work.axes) < 0;
  work.volume = work.file.get();
  auto& entry = step(work, "open",
                     head.format + ", " + std::to_string(head.size[0]) + " x " + std::to_string(head.size[1]) + " x " +
                         std::to_string(head.size[2]) + " voxels of " + io::name_of(head.type) +
                         (head.origin_m ? "" : "; the file says no origin: voxel (0, 0, 0) lies there") +
                         (work.left_handed ? "; its axes are left-handed" : ""));
  entry.figures = {{"voxels", static_cast<double>(head.voxels())},
                   {"spacing_i_m", work.spacing_m.x},
                   {"spacing_j_m", work.spacing_m.y},
                   {"spacing_k_m", work.spacing_m.z}};
}

}  // namespace gonio::tools::ct_mesh_clean
