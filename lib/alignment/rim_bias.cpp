// See rim_bias.h.
#include "alignment/rim_bias.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "alignment/model_region.h"
#include "alignment/seen_points.h"
#include "base/parallel.h"

namespace gonio::alignment {
Question without_bias(const AlignmentInput& in, const Setting& setting, const std::vector<double>& radii_m) {
  Question question = in.question;
  parallel_for(0, in.rims.size(), [&](std::size_t k) {
    Sighting& sighting = question.sightings[k];
    const RimSubject& subject = sighting.subject;
    const std::size_t lens = setting.stations[subject.station].lens;
    const double radius = subject.lamp && *subject.lamp < radii_m.size() ? radii_m[*subject.lamp] : 0;
    Region region{
        in.models[lens].width_px(), in.models[lens].height_px(), model_region(in, setting, subject, radius), {}, 0};
    if (subject.lamp)  // beneath the objects nobody sees it
      for (std::size_t b = 0; b < setting.bodies.size(); ++b) {
        const std::vector<float> over = model_region(in, setting, {subject.station, b, {}});
        for (std::size_t i = 0; i < over.size(); ++i) region.share[i] = std::min(region.share[i], 1 - over[i]);
      }
    std::vector<RimPoint> made = rim_points(region, in.rims[k].smooth_px, 12);
    straighten(made, [&](Vec2 p) { return in.straight(lens, p); });
    const ModelRim rim(setting, subject);
    const SeenPoints known(made);
    for (RimPoint& point : sighting.points) {
      const auto near = known.nearest(point.pixel, point.outward, 2.5);
      if (!near) continue;
      const auto exact = rim.nearest(made[*near].pixel, made[*near].outward, 2);
      if (exact) point.pixel = point.pixel - point.outward * exact->distance_px;
    }
  });
  return question;
}

}  // namespace gonio::alignment
