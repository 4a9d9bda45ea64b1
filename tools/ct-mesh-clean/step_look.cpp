// Step: what the volume is like before anybody cuts it.
#include "base/text.h"
#include "tools/ct-mesh-clean/work.h"

namespace gonio::tools::ct_mesh_clean {

void look(Work& work) {
  work.look = volume::look(*work.volume);
  const volume::Look& l = work.look;
  std::string how = std::to_string(l.mixture.materials.size()) + " materials";
  for (std::size_t m = 0; m < l.mixture.materials.size(); ++m)
    how += (m == 0 ? ": " : ", ") + format("%.4g", l.mixture.materials[m].mean);
  if (l.cut_by_field) how += "; the field of view cuts the object";
  auto& entry = step(work, "look", how);
  entry.figures = {{"smallest", l.histogram.smallest},
                   {"largest", l.histogram.largest},
                   {"otsu", l.otsu},
                   {"noise_air", l.noise_air},
                   {"noise_object", l.noise_object},
                   {"noise_correlation", l.noise_correlation},
                   {"cupping", l.cupping},
                   {"ring", l.ring},
                   {"streak", l.streak},
                   {"cut_voxels", static_cast<double>(l.cut_voxels)}};
  for (std::size_t m = 0; m < l.mixture.materials.size(); ++m) {
    const std::string name = "material_" + std::to_string(m + 1);
    entry.figures[name + "_mean"] = l.mixture.materials[m].mean;
    entry.figures[name + "_sd"] = l.mixture.materials[m].sd;
    entry.figures[name + "_share"] = l.mixture.materials[m].share;
  }
  if (l.edge_width_voxels) entry.figures["edge_width_voxels"] = *l.edge_width_voxels;
}

}  // namespace gonio::tools::ct_mesh_clean
