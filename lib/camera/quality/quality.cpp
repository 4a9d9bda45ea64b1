// See quality.h.
#include "camera/quality/quality.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "manifest/sections/camera_quality.h"
#include "stats/intervals.h"

namespace gonio::camera {
namespace {

std::string at_distances(const std::vector<ProjectionMap>& maps) {
  std::string text;
  for (std::size_t k = 0; k < maps.size(); ++k)
    text += (k == 0 ? " at " : k + 1 == maps.size() ? " and " : ", ") + format("%.3g m", maps[k].distance_m);
  return text;
}

std::string verdict_of(const Quality& q) {
  std::string text = format("This calibration predicts within %.2g px at 95 %% over 95 %% of the image", q.within_px) +
                     at_distances(q.maps);
  if (!q.halves.refused.empty()) return text + "; whether its model holds is not tested: " + q.halves.refused + ".";
  const std::string figures =
      format(" (%.2g px, %.2g px expected, p = %.2g)", q.halves.differ_px, q.halves.expected_px, q.halves.p);
  return text + (q.halves.agree ? "; halves of the views agree" + figures + "."
                                : "; but halves of the views differ by more than their uncertainty" + figures + ".");
}

}  // namespace

std::vector<double> usual_distances(const CameraResult& camera) {
  std::vector<double> seen;
  for (std::size_t v = 0; v < camera.views.size(); ++v) {
    const Vec2 middle = camera.board(v).extent().middle_m;
    if (camera.uses(v))
      seen.push_back(norm(camera.calibration.views[v].camera_from_board * Vec3{middle.x, middle.y, 0}));
  }
  if (seen.empty()) return {};
  const double median = stats::median(seen);
  return {median, 2 * median};
}

std::optional<Quality> judge_quality(const CameraResult& camera, std::vector<double> distances_m) {
  if (camera.calibration.covariance.empty()) return std::nullopt;
  if (distances_m.empty()) distances_m = usual_distances(camera);
  Quality q;
  const ProjectionLaw law(camera);
  for (const double distance : distances_m) {
    q.maps.push_back(projection_map(law, camera, distance));
    q.within_px = std::max(q.within_px, q.maps.back().within_px);
  }
  q.halves = compare_halves(camera, distances_m);
  q.coverage = coverage_of(camera);
  q.next = next_views(camera, distances_m);
  q.verdict = verdict_of(q);
  return q;
}

std::string disagreement(const Halves& h) {
  return format(
             "calibrations from either half of the views differ by %.2g px over the image where %.2g px are expected "
             "(p = %.1g)",
             h.differ_px, h.expected_px, h.p) +
         ": something is not modelled; try --board-warp or --model auto, and ask explain";
}

manifest::CameraQuality section_of(const Quality& q) {
  manifest::CameraQuality section;
  section.predicts_within_px = q.within_px;
  for (const ProjectionMap& map : q.maps) section.distances_m.push_back(map.distance_m);
  section.coverage = q.coverage.share;
  for (const NextView& view : q.next) section.next.push_back(view.sentence);
  if (!q.halves.refused.empty()) return section;
  section.halves_differ_px = q.halves.differ_px;
  section.halves_expected_px = q.halves.expected_px;
  section.halves_agree = q.halves.agree;
  return section;
}

}  // namespace gonio::camera
