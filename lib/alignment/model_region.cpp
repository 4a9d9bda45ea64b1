// See model_region.h.
#include "alignment/model_region.h"

#include <cmath>

#include "alignment/coverage.h"

namespace gonio::alignment {
namespace {

constexpr int places = 32;  // of a lamp that is no point

std::vector<float> of_point(const AlignmentInput& in, const Setting& setting, const RimSubject& subject) {
  const std::size_t lens = setting.stations[subject.station].lens;
  const ModelRim rim(setting, subject);
  std::vector<Side> sides;
  for (const RimPiece& p : rim.pieces()) sides.push_back({in.bent(lens, p.from), in.bent(lens, p.to)});
  return coverage_of(sides, in.models[lens].width_px(), in.models[lens].height_px());
}

}  // namespace

std::vector<float> model_region(const AlignmentInput& in, const Setting& setting, const RimSubject& subject,
                                double radius_m) {
  if (!subject.lamp || !(radius_m > 0)) return of_point(in, setting, subject);
  // The lamp as a disc across its way to the body, by places that stand for equal areas (Vogel, A better way to
  // construct the sunflower head, 1979).
  const Vec3 lamp = setting.lamps_m[*subject.lamp];
  const Basis across(normalized(lamp - setting.bodies[subject.body].centre_m()));
  Setting here = setting;
  std::vector<float> sum;
  for (int k = 0; k < places; ++k) {
    const double r = radius_m * std::sqrt((k + 0.5) / places), turn = k * pi * (3 - std::sqrt(5.0));
    here.lamps_m[*subject.lamp] = lamp + across.t * (r * std::cos(turn)) + across.b * (r * std::sin(turn));
    const std::vector<float> one = of_point(in, here, subject);
    sum.resize(one.size(), 0);
    for (std::size_t i = 0; i < one.size(); ++i) sum[i] += one[i] / places;
  }
  return sum;
}

}  // namespace gonio::alignment
