// Step: the threshold.
#include "base/error.h"
#include "base/text.h"
#include "tools/ct-mesh-clean/work.h"

namespace gonio::tools::ct_mesh_clean {
namespace {

void needs_object(const volume::Look& look, const std::string& place) {
  if (look.object == look.air) throw Error(Exit::data, place, "holds one material only", "give --threshold VALUE");
}

// The markers' diameter is known. Where they are of another material than the object, the share of the step from air to
// material at which the markers have it is the object's as well.
volume::Threshold by_reference(Work& work) {
  find_markers(work);
  std::vector<volume::ReferenceSphere> spheres;
  for (const volume::Marker& m : work.markers.found)
    spheres.push_back({m.centre, *work.asked.marker_radius_m / work.voxel_m(), 0});
  volume::Threshold threshold = volume::reference_length(*work.volume, spheres, work.grid.spacing_m / work.voxel_m());
  double inside = 0;
  for (const volume::Marker& m : work.markers.found)
    inside += m.mean_value / static_cast<double>(work.markers.found.size());
  const double air = work.look.mixture.materials[work.look.air].mean,
               step = work.look.mixture.materials[object_material(work)].mean - air;
  const double share = (threshold.value - air) / (inside - air);
  threshold.sigma *= step / (inside - air), threshold.value = air + share * step;
  threshold.how += format(", at %.1f %% of the step from air to marker", 100 * share);
  return threshold;
}

}  // namespace

void cut(Work& work) {
  const Asked& a = work.asked;
  const std::string& place = work.path;
  switch (a.threshold_by) {
    case ThresholdBy::value: work.threshold = {.value = a.threshold, .how = "as asked"}; break;
    case ThresholdBy::otsu: work.threshold = volume::otsu(work.look.histogram); break;
    case ThresholdBy::reference:
      needs_object(work.look, place);
      work.threshold = by_reference(work);
      break;
    default:
      needs_object(work.look, place);
      work.threshold = volume::half_way(*work.volume, work.look.mixture, work.look.air, object_material(work));
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
