// See picture_step.h.
#include "alignment/picture_step.h"

#include <algorithm>
#include <cmath>

#include "alignment/align_bodies.h"
#include "alignment/alignment_entry.h"
#include "alignment/symmetry.h"
#include "base/text.h"
#include "manifest/document.h"
#include "manifest/sections/object.h"
#include "stats/distributions.h"

namespace gonio::alignment {
namespace {

constexpr double chi2_share = 0.99;
constexpr std::size_t most_rivals = 6;  // that pictures are asked about
constexpr double as_well = 9;           // of cost: what fits no worse than that fits as well

// How far the points of rims move, and what the rims' covariance states of them, both rms.
void measure_move(const Question& q, const Fitted& rims, PictureAnswer& answer) {
  const std::vector<double> change = change_between(rims.setting, answer.fitted.setting, q.freedoms);
  const auto count = static_cast<Eigen::Index>(change.size());
  const Eigen::Map<const Eigen::VectorXd> d(change.data(), count);
  const GroundAxes axes = ground_axes(rims.setting);
  std::vector<double> row(change.size());
  double moves = 0, variances = 0, points = 0;
  for (std::size_t k = 0; k < q.sightings.size() && k < rims.sightings.size(); ++k) {
    const Sighting& s = q.sightings[k];
    const ModelRim rim(rims.setting, s.subject);
    if (!rim.exists()) continue;
    for (const RimPlace& place : rim.places(std::max(2.0, rim.length_px() / 400))) {
      if (s.unseen && s.unseen(place.pixel)) continue;
      slopes_of(rims.setting, q.freedoms, axes, s.subject.station, s.subject.body, s.subject.lamp, place.mesh_point,
                place.outward, row.data());
      const Eigen::Map<const Eigen::VectorXd> j(row.data(), count);
      const double move = j.dot(d);
      moves += move * move, variances += j.dot(rims.covariance * j), points += 1;
    }
  }
  if (points > 0) answer.move_px = std::sqrt(moves / points), answer.sigma_px = std::sqrt(variances / points);
}

double rms(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v * v;
  return values.empty() ? 0 : std::sqrt(sum / static_cast<double>(values.size()));
}

void decide(const PictureWish& wish, PictureAnswer& a) {
  if (a.relative_error > wish.most_relative_error)
    a.why = format("the scene's surfaces and lamps leave %.0f %% of what the pictures show (limit %.0f %%)",
                   100 * a.relative_error, 100 * wish.most_relative_error);
  else if (a.chi2 > a.chi2_limit)
    a.why = format(
        "they would move rims by %.3f px (rms), of which the rims state %.3f px: chi-square %.1f of %zu "
        "numbers, limit %.1f",
        a.move_px, a.sigma_px, a.chi2, a.numbers, a.chi2_limit);
  a.taken = a.why.empty();
}

PictureAnswer answer_of(const PictureModel& model, const AlignmentInput& in, const PictureWish& wish,
                        const Fitted& rims, const PictureFit& fit) {
  PictureAnswer a;
  a.fitted = rims;
  a.fitted.setting = fit.setting, a.fitted.covariance = fit.covariance;
  const auto& freedoms = in.question.freedoms;
  measure_rims(a.fitted, unbiased(in, fit.setting));
  a.photographs = model.images().size(), a.pixels = model.rows().size();
  a.independent = 3 * static_cast<double>(a.pixels) / fit.noise.inflation;
  a.correlation_px = fit.noise.correlation_px;
  a.relative_before = rms(fit.relative_before), a.relative_error = rms(fit.relative_after);
  for (std::size_t g = 0; g < a.photographs; ++g)
    a.each.push_back({model.images()[g], fit.relative_before[g], fit.relative_after[g]});
  const std::vector<double> change = change_between(rims.setting, fit.setting, freedoms);
  const Eigen::Map<const Eigen::VectorXd> d(change.data(), static_cast<Eigen::Index>(change.size()));
  a.numbers = fit.numbers, a.chi2 = d.dot(fit.rims * d);
  a.chi2_limit = stats::chi2_quantile(chi2_share, static_cast<double>(a.numbers));
  measure_move(in.question, rims, a);
  decide(wish, a);
  return a;
}

// Turns about an axis that is the pictures' to say: those of a scan that they like better than their neighbours, the
// best first.
std::vector<Setting> turns_liked(const PictureModel& model, const Fitted& rims, Vec3 axis) {
  constexpr std::size_t steps = 120, most = 2;
  const Vec3 middle = principal_axes(*rims.setting.bodies[0].shape).middle_m;
  std::vector<Setting> turned;
  for (std::size_t k = 0; k < steps; ++k)
    turned.push_back(turned_about(rims.setting, 0, middle, axis, 2 * pi * static_cast<double>(k) / steps));
  std::vector<double> left(steps);
  for (std::size_t k = 0; k < steps; ++k) left[k] = share_left(model, turned[k]);
  std::vector<std::size_t> liked;
  for (std::size_t k = 1; k < steps; ++k)  // 0 is where the rims ended
    if (left[k] < left[(k + steps - 1) % steps] && left[k] <= left[(k + 1) % steps]) liked.push_back(k);
  std::ranges::sort(liked, {}, [&](std::size_t k) { return left[k]; });
  liked.resize(std::min(liked.size(), most));
  std::vector<Setting> settings;
  for (const std::size_t k : liked) settings.push_back(turned[k]);
  return settings;
}

// Several ways may lead to one end.
bool same_pose(const Setting& one, const Setting& other) {
  constexpr double near_rad = 0.02;
  const auto &a = one.bodies[0].world_from_object, &b = other.bodies[0].world_from_object;
  return norm(rotation_vector_of(normalized(conjugate(a.rotation) * b.rotation))) < near_rad;
}

// Of a body that looks alike by any angle about an axis rims state nothing of that turn, whatever its facets hold.
void free_turns(Fitted& rims, const std::vector<Freedom>& freedoms, const std::vector<Vec3>& axes) {
  constexpr double sigma_rad = 0.5;
  Eigen::Index at = 0;
  for (const Freedom& f : freedoms) {
    if (f.block == Block::body_turn && f.which == 0)
      for (const Vec3 axis : axes) {
        const Vec3 a = rims.setting.bodies[0].world_from_object.rotate(axis) * sigma_rad;
        const Eigen::Vector3d v(a.x, a.y, a.z);
        rims.covariance.block<3, 3>(at, at) += v * v.transpose();
      }
    at += static_cast<Eigen::Index>(f.size());
  }
}

// Poses that rims cannot tell from the best one, as pictures tell them. The best of all is returned, with the rims' fit
// that it began at; rivals that pictures contradict are gone from `body`.
struct Best {
  Fitted rims;
  PictureFit fit;
};
Best best_of(const PictureModel& model, const AlignmentInput& in, Fitted rims, Aligned& body) {
  const std::vector<Vec3> any_turn = body.any_turn;
  free_turns(rims, in.question.freedoms, any_turn);
  std::vector<Rival> asked = std::move(body.rivals);
  if (!any_turn.empty()) asked.clear();  // some turns of many
  for (const Vec3 axis : any_turn) {
    for (Setting& setting : turns_liked(model, rims, axis)) asked.push_back({std::move(setting)});
  }
  // About one axis all turns were looked at; a ball has more than those about each of three.
  const bool all_asked = asked.size() <= most_rivals && any_turn.size() <= 1;
  asked.resize(std::min(asked.size(), most_rivals));
  struct Start {
    Fitted rims;
    double worse = 0, left = 0;
  };
  std::vector<Start> starts{{rims, 0, share_left(model, rims.setting)}};
  for (const Rival& rival : asked) {
    Fitted there = fit_rims(rival.setting, unbiased(in, rival.setting),
                            {{.reach_px = 5, .width_px = 0, .most_steps = 15, .small_fall = 1e-7}});
    free_turns(there, in.question.freedoms, any_turn);
    const double left = share_left(model, there.setting);
    starts.push_back({std::move(there), rival.worse, left});
  }
  // Noise is what is left where the pictures fit best: a wrong pose would take its errors for it.
  std::ranges::stable_sort(starts, {}, &Start::left);
  Best best{starts[0].rims, fit_pictures(model, starts[0].rims, in.question.freedoms)};
  const PictureNoise noise = best.fit.noise;
  best.fit.cost += starts[0].worse;
  std::vector<std::pair<Rival, double>> kept{
      {{best.fit.setting, starts[0].worse, best.rims.rms_px, best.rims.explained}, best.fit.cost}};
  for (std::size_t k = 1; k < starts.size(); ++k) {
    const Start& start = starts[k];
    PictureFit fit = fit_pictures(model, start.rims, in.question.freedoms, &noise);
    fit.cost += start.worse;
    kept.push_back({{fit.setting, start.worse, start.rims.rms_px, start.rims.explained}, fit.cost});
    if (fit.cost < best.fit.cost) best = {start.rims, std::move(fit)};
  }
  body.rivals.clear();
  for (auto& [rival, cost] : kept)
    if (cost < best.fit.cost + as_well && !same_pose(rival.setting, best.fit.setting))
      rival.worse = cost - best.fit.cost, body.rivals.push_back(rival);
  if (body.rivals.empty() && all_asked) body.symmetries.clear(), body.any_turn.clear();
  return best;
}

}  // namespace

std::string words_of(const PictureAnswer& a) {
  const std::string seen =
      format("%zu pixels of %zu photographs, worth %.0f independent values, ", a.pixels, a.photographs, a.independent);
  if (!a.taken) return seen + "contradict the rims, whose answer is kept: " + a.why;
  return seen + format(
                    "agree with the rims: these move by %.3f px (rms) of %.3f px, chi-square %.1f of %zu numbers "
                    "(limit %.1f); %.2g %% of what is seen is left",
                    a.move_px, a.sigma_px, a.chi2, a.numbers, a.chi2_limit, 100 * a.relative_error);
}

void refine_by_pictures(const manifest::Document& document, const AlignmentInput& in, const AlignWish& wish,
                        const PictureWish& asked, std::vector<Aligned>& all) {
  const auto stands = std::find_if(all.begin(), all.end(), [](const Aligned& a) { return a.stands(); });
  if (stands == all.end()) return;
  check_pictures(document, in);
  manifest::Document moved = document;
  for (std::size_t b = 0; b < all.size(); ++b)
    if (all[b].stands()) move_document(moved, in, b, all[b]);
  const Fitted rims = stands->fitted;
  const PictureModel model(moved, in, rims.setting, asked.pixels);
  if (model.rows().size() < 50)
    throw Error(
        Exit::data, manifest::place(document, "/images"),
        format("show %zu pixels of the objects and the ground beside rims and shadows' edges", model.rows().size()),
        "leave out --picture, or give larger photographs");
  Aligned judged = *stands;
  Best best =
      all.size() == 1 ? best_of(model, in, rims, judged) : Best{rims, fit_pictures(model, rims, in.question.freedoms)};
  auto answer = std::make_shared<const PictureAnswer>(answer_of(model, in, asked, best.rims, best.fit));
  for (std::size_t b = 0; b < all.size(); ++b) {
    if (!all[b].stands()) continue;
    if (answer->taken && all.size() == 1) all[b] = judged;
    all[b].pictures = answer;
    if (!answer->taken) continue;
    all[b].fitted = answer->fitted;
    judge_open(in.question, b, wish, all[b]);
  }
}

}  // namespace gonio::alignment
