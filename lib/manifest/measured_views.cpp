// See measured_views.h.
#include "manifest/measured_views.h"

#include <algorithm>

#include "manifest/document.h"
#include "manifest/sections/image.h"
#include "manifest/sections/plan.h"

namespace gonio::manifest {
namespace {

struct TakenBy {
  const Run* run = nullptr;
  const Plan* plan = nullptr;
};

TakenBy taken_by(const Document& d, const ImageEntry& image) {
  for (std::size_t r = d.runs.size(); r-- > 0;) {
    const auto plan = std::ranges::find(d.plans, d.runs[r].plan, &Plan::id);
    if (plan != d.plans.end() && std::ranges::find(plan->steps, image.group, &PlanStep::image) != plan->steps.end())
      return {&d.runs[r], &*plan};
  }
  return {};
}

}  // namespace

void remember_view(Document& document, const ImageEntry& image, const std::string& by) {
  const Plan* found = taken_by(document, image).plan;
  if (found == nullptr || !image.world_from_camera || drift_of(document, image) != nullptr) return;
  auto& measured = std::ranges::find(document.plans, found->id, &Plan::id)->measured;
  std::erase_if(measured, [&image](const MeasuredView& view) { return view.image == image.group; });
  MeasuredView& view = measured.emplace_back();
  view.image = image.group;
  view.by = by;
  view.world_from_camera = image.world_from_camera;
  if (image.camera_from_board) view.board = image.board, view.camera_from_board = image.camera_from_board;
}

bool is_remembered(const Document& document, const ImageEntry& image, const std::string& by) {
  const Plan* plan = taken_by(document, image).plan;
  return plan != nullptr && std::ranges::any_of(plan->measured, [&](const MeasuredView& view) {
           return view.image == image.group && view.by == by;
         });
}

const DriftedFrames* drift_of(const Document& document, const ImageEntry& image) {
  const Run* run = taken_by(document, image).run;
  if (run == nullptr) return nullptr;
  const auto found = std::ranges::find_if(run->drifted, [&image](const DriftedFrames& frames) {
    return std::ranges::find(frames.images, image.id) != frames.images.end();
  });
  return found == run->drifted.end() ? nullptr : &*found;
}

}  // namespace gonio::manifest
