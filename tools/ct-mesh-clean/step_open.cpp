// Step: open the volume; where its voxels lie is read or asked for, never guessed.
#include "base/text.h"
#include "tools/ct-mesh-clean/work.h"

namespace gonio::tools::ct_mesh_clean {
void open(Work& work) {
  const std::string& path = work.path;
  work.file = io::open_volume(path, work.asked.file);
  const io::VolumeHead& head = work.file->head();
  for (const auto& file : head.files) work.call.note_input(file);
  work.grid = io::grid_of(head);
  work.volume = work.file.get();
  auto& entry = step(work, "open",
                     head.format + ", " + std::to_string(head.size[0]) + " x " + std::to_string(head.size[1]) + " x " +
                         std::to_string(head.size[2]) + " voxels of " + io::name_of(head.type) +
                         (head.origin_m ? "" : "; the file says no origin: voxel (0, 0, 0) lies there") +
                         (work.grid.left_handed() ? "; its axes are left-handed" : ""));
  entry.figures = {{"voxels", static_cast<double>(head.voxels())},
                   {"spacing_i_m", work.grid.spacing_m.x},
                   {"spacing_j_m", work.grid.spacing_m.y},
                   {"spacing_k_m", work.grid.spacing_m.z}};
}

}  // namespace gonio::tools::ct_mesh_clean
