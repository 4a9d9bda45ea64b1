// Step: the threshold.
#include "base/error.h"
#include "base/text.h"
#include "tools/ct-mesh-clean/work.h"

namespace gonio::tools::ct_mesh_clean {
namespace {

// Between the air and the material above it that holds the most voxels.
volume::Threshold between_materials(const volume::Mixture& mixture, const std::string& place) {
  if (mixture.materials.size() < 2) throw Error(Exit::data, place, "holds one material only", "give --threshold VALUE");
  std::size_t largest = 1;
  for (std::size_t m = 2; m < mixture.materials.size(); ++m)
    if (mixture.materials[m].share > mixture.materials[largest].share) largest = m;
  return volume::half_way(mixture, 0, largest);
}

}  // namespace

void cut(Work& work) {
  const Asked& a = work.asked;
  const std::string& place = work.call.text("VOLUME");
  switch (a.threshold_by) {
    case ThresholdBy::value: work.threshold = {.value = a.threshold, .how = "as asked"}; break;
    case ThresholdBy::otsu: work.threshold = volume::otsu(work.look.histogram); break;
    case ThresholdBy::reference:
      work.threshold = volume::by_reference(*work.volume, between_materials(work.look.mixture, place), a.inside,
                                            *a.marker_radius_m / work.voxel_m(), work.look.noise_air);
      break;
    default: work.threshold = between_materials(work.look.mixture, place);
  }
  const volume::Histogram& h = work.look.histogram;
  if (work.threshold.value >= h.largest || work.threshold.value < h.smallest)
    throw Error(Exit::data, place,
                format("a threshold of %.6g leaves %s: its values reach from %.6g to %.6g", work.threshold.value,
                       work.threshold.value >= h.largest ? "nothing inside" : "nothing outside", h.smallest, h.largest),
                "give a --threshold between them");
  step(work, "threshold", work.threshold.how).figures = {{"value", work.threshold.value},
                                                         {"sigma", work.threshold.sigma}};
}

}  // namespace gonio::tools::ct_mesh_clean
