// See align_bodies.h.
#include "alignment/align_bodies.h"

#include <algorithm>
#include <functional>

#include "alignment/lamp_size.h"
#include "alignment/rim_bias.h"
#include "alignment/rim_waves.h"
#include "base/text.h"

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
// `restrict` leaves of a question what is asked here.
void refine(const AlignmentInput& in, const std::function<void(Question&)>& restrict, Fitted& fitted, FitPath* path) {
  for (int round = 0; round < 2; ++round) {
    Question q = unbiased(in, fitted.setting);
    restrict(q);
    fitted = fit_rims(fitted.setting, q, {{.reach_px = 5, .width_px = 0, .most_steps = 15, .small_fall = 1e-7}}, path);
  }
}

// Poses of bodies whose rims leave waves that masks do not make are lost, whatever their intervals say.
void judge_waves(const Question& question, std::size_t body, double most_sigma_px, Aligned& a) {
  if (!a.stands()) return;
  const RimWaves waves = rim_waves(question, a.fitted, body, most_sigma_px);
  if (!waves.beyond()) return;
  a.verdict = Verdict::lost;
  a.why = format(
      "the rims' offsets have long waves, %.2f px over pieces of 32 px (masks make %.2f px): shape, size, "
      "focal length, lamps or ground are not as stated",
      waves.rms_px, waves.limit_px);
}

// The way of all together goes on where each one's ended.
void go_on(Aligned& a, const FitPath& path) {
  auto& rms = a.tried.back().rms_px;
  rms.insert(rms.end(), path.rms_px.begin(), path.rms_px.end());
}

// Which of all freedoms' numbers belong to freedoms that `keep`.
std::vector<Eigen::Index> numbers_kept(const std::vector<Freedom>& all,
                                       const std::function<bool(const Freedom&)>& keep) {
  std::vector<Eigen::Index> kept;
  Eigen::Index at = 0;
  for (const Freedom& f : all)
    for (std::size_t i = 0; i < f.size(); ++i, ++at)
      if (keep(f)) kept.push_back(at);
  return kept;
}

// One fit of all that were found. What was lost says nothing of lamps, cameras and ground, and stays where its own fit
// ended. Sightings and numbers of the result are those of the input.
Fitted fit_together(const AlignmentInput& in, const std::vector<Aligned>& all, Setting setting, FitPath* path) {
  const auto lost_body = [&](std::size_t b) { return !all[b].stands(); };
  const auto restrict = [&](Question& q) {
    std::erase_if(q.sightings, [&](const Sighting& s) { return lost_body(s.subject.body); });
    std::erase_if(q.contacts, [&](const Contact& c) { return lost_body(c.body); });
    std::erase_if(q.freedoms, [&](const Freedom& f) { return own_block(f.block) && lost_body(f.which); });
  };
  Question q = in.question;
  restrict(q);
  Fitted together;
  together.setting = setting;
  if (!q.sightings.empty()) {
    together = fit_rims(setting, q, stages_from(8), path);
    refine(in, restrict, together, path);
  }
  std::vector<SightingFit> own = std::move(together.sightings);
  std::vector<std::size_t> next(all.size(), 0);
  std::size_t found = 0;
  for (const Sighting& s : in.question.sightings) {
    const std::size_t b = s.subject.body;
    together.sightings.push_back(lost_body(b) ? all[b].fitted.sightings[next[b]++] : own[found++]);
  }
  for (std::size_t b = 0; b < all.size(); ++b)
    if (lost_body(b)) together.setting.bodies[b] = all[b].fitted.setting.bodies[b];
  const auto kept =
      numbers_kept(in.question.freedoms, [&](const Freedom& f) { return !own_block(f.block) || !lost_body(f.which); });
  const auto n = static_cast<Eigen::Index>(numbers_of(in.question.freedoms));
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n);
  if (together.covariance.size() > 0) covariance(kept, kept) = together.covariance;
  together.covariance = std::move(covariance);
  return together;
}

}  // namespace

Question unbiased(const AlignmentInput& in, const Setting& setting) {
  return without_bias(in, setting, told_radii(lamp_sizes(in, setting)));
}

std::vector<Aligned> align_bodies(const AlignmentInput& in, const AlignWish& wish) {
  std::vector<Aligned> all;
  if (in.bodies.size() == 1) {
    all.push_back(align(in.stated, in.question, 0, wish));
    if (all[0].stands()) {
      FitPath path;
      refine(
          in, [](Question&) {}, all[0].fitted, wish.record ? &path : nullptr);
      go_on(all[0], path);
      judge_waves(in.question, 0, wish.most_sigma_px, all[0]);
    }
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
    if (all.back().stands()) setting = all.back().fitted.setting;
  }
  FitPath path;
  const Fitted together = fit_together(in, all, setting, wish.record ? &path : nullptr);
  for (std::size_t b = 0; b < all.size(); ++b) {
    Aligned& a = all[b];
    if (a.stands()) {
      go_on(a, path);
      a.fitted = together;
      judge_open(in.question, b, wish, a);
      judge_waves(in.question, b, wish.most_sigma_px, a);
      continue;
    }
    // Its own figures, beside what all share.
    a.fitted.setting = together.setting, a.fitted.sightings = together.sightings;
    a.fitted.covariance = together.covariance;
  }
  return all;
}

}  // namespace gonio::alignment
