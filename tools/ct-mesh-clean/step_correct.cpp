// Step: take off what the scanner added, where the user asks for it.
#include "base/text.h"
#include "tools/ct-mesh-clean/work.h"

namespace gonio::tools::ct_mesh_clean {

void correct(Work& work) {
  const Asked& a = work.asked;
  if (!a.cupping && !a.rings && a.denoise == volume::Denoise::none) return;
  const io::VolumeHead& head = work.volume->head();
  volume::CorrectWish wish;
  std::string how;
  std::map<std::string, double> figures;
  volume::CuppingField field;
  if (a.cupping) {
    field = volume::fit_cupping(*work.volume, work.look.mixture.materials[work.look.air].mean,
                                work.look.mixture.materials[object_material(work)].mean);
    wish.cupping = &field;
    how = "cupping divided out by a polynomial of degree " + std::to_string(field.degree);
    figures["cupping_before"] = field.before, figures["cupping_after"] = field.after;
  }
  const volume::RingWish rings{.centre_i = 0.5 * (static_cast<double>(head.size[0]) - 1),
                               .centre_j = 0.5 * (static_cast<double>(head.size[1]) - 1)};
  if (a.rings) {
    wish.rings = &rings;
    how += (how.empty() ? "" : "; ") + std::string("rings round the slices' middle taken off");
  }
  if (a.denoise != volume::Denoise::none) {
    wish.denoise = a.denoise, wish.noise = work.look.noise_air;
    how += (how.empty() ? "" : "; ") +
           std::string(a.denoise == volume::Denoise::anisotropic ? "anisotropic diffusion" : "non-local means");
  }
  io::VolumeSource* before = work.volume;
  work.derived.push_back(volume::corrected(*work.volume, wish));
  work.volume = work.derived.back().get();
  const volume::EdgeChange change =
      volume::edge_change(*before, *work.volume, work.look.mixture.materials[work.look.air].mean,
                          work.look.mixture.materials[object_material(work)].mean, work.look.noise_air);
  figures["edges"] = static_cast<double>(change.edges);
  figures["edge_width_before_voxels"] = change.width_before_voxels;
  figures["edge_width_after_voxels"] = change.width_after_voxels;
  figures["edge_shift_voxels"] = change.mean_shift_voxels;
  figures["edge_shift_rms_voxels"] = change.rms_shift_voxels;
  step(work, "correct", how).figures = std::move(figures);
  work.look = volume::look(*work.volume);
}

}  // namespace gonio::tools::ct_mesh_clean
