// See align_bodies.h.
#include "alignment/align_bodies.h"

#include <algorithm>

#include "alignment/lamp_size.h"
#include "alignment/rim_bias.h"

namespace gonio::alignment {
namespace {

// One body's sightings and freedoms: the others neither move nor say anything.
Question of_body(const Question& question, std::size_t body) {
  Question q = question;
  std::erase_if(q.sightings, [&](const Sighting& s) { return s.subject.body != body; });
  std::erase_if(q.contacts, [&](const Contact& c) { return c.body != body; });
  return q;
}

bool own_block(Block block) {
  return block == Block::body_turn || block == Block::body_shift || block == Block::body_scale;
}

std::vector<double> told_radii(const std::vector<LampSize>& sizes) {
  std::vector<double> radii;
  for (const LampSize& size : sizes) radii.push_back(size.told() ? size.radius_m : 0);
  return radii;
}

// Once more without what pixels, smoothing and the lamps' sizes do to rims, which is known where these nearly are.
void refine(const AlignmentInput& in, const std::vector<Freedom>& freedoms, Fitted& fitted) {
  for (int round = 0; round < 2; ++round) {
    Question q = without_bias(in, fitted.setting, told_radii(lamp_sizes(in, fitted.setting)));
    q.freedoms = freedoms;
    fitted = fit_rims(fitted.setting, q, {{.reach_px = 5, .width_px = 0, .most_steps = 15, .small_fall = 1e-7}});
  }
}

}  // namespace

std::vector<Aligned> align_bodies(const AlignmentInput& in, const AlignWish& wish) {
  std::vector<Aligned> all;
  if (in.bodies.size() == 1) {
    all.push_back(align(in.stated, in.question, 0, wish));
    if (all[0].verdict == Verdict::found || all[0].verdict == Verdict::ambiguous)
      refine(in, in.question.freedoms, all[0].fitted);
    return all;
  }
  Setting setting = in.stated;
  for (std::size_t b = 0; b < in.bodies.size(); ++b) {
    Question q = of_body(in.question, b);
    std::erase_if(q.freedoms, [&](const Freedom& f) { return own_block(f.block) && f.which != b; });
    std::erase_if(q.freedoms, [&](const Freedom& f) {
      return f.block == Block::lamp_shift && std::none_of(q.sightings.begin(), q.sightings.end(),
                                                          [&](const Sighting& s) { return s.subject.lamp == f.which; });
    });
    all.push_back(align(setting, q, b, wish));
    if (all.back().verdict != Verdict::lost && all.back().verdict != Verdict::mirrored)
      setting = all.back().fitted.setting;
  }
  Fitted together = fit_rims(setting, in.question, stages_from(8));
  refine(in, in.question.freedoms, together);
  for (Aligned& a : all) a.fitted = together;
  return all;
}

}  // namespace gonio::alignment
