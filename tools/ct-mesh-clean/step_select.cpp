// Step: what is connected, and what of it stays.
#include <algorithm>
#include <limits>

#include "base/error.h"
#include "base/progress.h"
#include "base/text.h"
#include "tools/ct-mesh-clean/work.h"

namespace gonio::tools::ct_mesh_clean {

namespace {

// Half-way between the object's material and the next lighter one that is not air.
double core_of_materials(const Work& work) {
  const auto& materials = work.look.mixture.materials;
  const std::size_t object = object_material(work);
  if (object < work.look.air + 2)
    throw Error(Exit::data, work.path, "shows no material between air and the object", "give --core VALUE");
  return 0.5 * (materials[object - 1].mean + materials[object].mean);
}

// All components, or those of the object's material and of what is lighter each by themselves.
void find_components(Work& work) {
  if (!work.asked.split) {
    work.components = volume::components(*work.volume, work.threshold.value, work.asked.inside);
    return;
  }
  volume::SplitWish& wish = *work.asked.split;
  if (work.asked.core_by_materials) wish.core = core_of_materials(work);
  if (!(wish.core > work.threshold.value && wish.core < work.look.histogram.largest))
    throw Error(Exit::data, work.path,
                format("a core of %.6g is not between the threshold of %.6g and the largest value of %.6g", wish.core,
                       work.threshold.value, work.look.histogram.largest),
                "give a --core between them");
  work.components = volume::split_components(*work.volume, work.threshold.value, work.asked.inside, wish);
}

}  // namespace

void select(Work& work) {
  find_components(work);
  work.kept = volume::chosen(work.components, work.asked.keep);
  const std::size_t all = work.components.list.size();
  const auto stays = static_cast<std::size_t>(std::ranges::count(work.kept.keep, true));
  if (stays == 0)
    throw Error(Exit::data, work.path,
                all == 0 ? "nothing is above the threshold"
                         : "none of its " + std::to_string(all) + " components stays: the largest is " +
                               work.kept.reason.front(),
                all == 0 ? "give a lower --threshold" : "loosen --largest, --at-least, --brighter, --darker or --box");
  auto& entry = step(work, "components", std::to_string(stays) + " of " + std::to_string(all) + " stay");
  std::size_t cut = 0;
  for (std::size_t c = 0; c < all; ++c) cut += work.kept.keep[c] && work.components.list[c].touches_border;
  work.cut_by_border = cut > 0;
  if (work.cut_by_border) {
    entry.how += "; the volume's border cuts " + std::to_string(cut) + " of them";
    log(LogLevel::warning, work.path + ": its border cuts " + std::to_string(cut) + " of the " + std::to_string(stays) +
                               " components that stay; the mesh has flat caps there; scan the "
                               "whole object, or leave them out with --drop-cut");
  }
  std::uint64_t voxels = 0, dropped = 0;
  for (std::size_t c = 0; c < all; ++c) (work.kept.keep[c] ? voxels : dropped) += work.components.list[c].voxels;
  entry.figures = {{"components", static_cast<double>(all)},
                   {"kept", static_cast<double>(stays)},
                   {"cut_by_border", static_cast<double>(cut)},
                   {"kept_voxels", static_cast<double>(voxels)},
                   {"dropped_voxels", static_cast<double>(dropped)}};
  if (work.asked.split) {
    entry.figures["core"] = work.asked.split->core;
    entry.figures["light"] =
        static_cast<double>(std::ranges::count_if(work.components.list, [](const auto& c) { return c.light; }));
  }
  const float air =
      static_cast<float>(std::min(work.look.mixture.materials.empty() ? work.look.histogram.smallest
                                                                      : work.look.mixture.materials[work.look.air].mean,
                                  work.threshold.value));
  if (stays < all) {
    work.derived.push_back(volume::only(*work.volume, work.components, work.kept, air));
    work.volume = work.derived.back().get();
  }
  work.euler = volume::euler_number(*work.volume, work.threshold.value, work.asked.inside);
  entry.figures["euler"] = static_cast<double>(work.euler);
}

}  // namespace gonio::tools::ct_mesh_clean
