// See tracks_outcome.h.
#include "explain/nrsfm/tracks_outcome.h"

#include <algorithm>
#include <cmath>

#include "inference/apart.h"
#include "inference/wording.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/sequence.h"
#include "mechanism/mechanism.h"
#include "report/number_text.h"
#include "report/plot.h"
#include "stats/distributions.h"

namespace gonio::mechanism {
const Mechanism& tracks_outliers();
const Mechanism& tracks_perspective();
const Mechanism& tracks_scale();
}  // namespace gonio::mechanism

namespace gonio::explain {
namespace {

using gonio::nrsfm::beyond_noise;
using gonio::nrsfm::Followed;
using gonio::nrsfm::NearCamera;
using gonio::nrsfm::Outliers;
using gonio::nrsfm::Run;

bool is_named(const TracksView& v, const Explanation& e, const std::string& id) {
  return std::any_of(e.named.begin(), e.named.end(),
                     [&](std::size_t c) { return v.problem.candidates()[c].id() == id; });
}

// Largest distance of a point along the line of sight from the shape's origin.
double depth_of(const TracksView& v, const Explanation& e) {
  double depth = 0;
  for (std::size_t p = 0; p < v.followed.points.size(); ++p)
    for (const Followed::Place& place : v.followed.places(e.values, p))
      depth = std::max(depth, std::abs(place.camera[2]));
  return depth;
}

double gain_of(const NearCamera::Step& step) {
  return 1 - std::exp(-step.log_gain);
}

std::string perspective_remark(const TracksView& v, const Explanation& e) {
  const double kappa = e.values[v.followed.layout.perspective], sigma = e.sigma[v.followed.layout.perspective];
  const std::string unit = track_unit(v.followed);
  const double focal = 1 / std::abs(kappa);
  std::string text = "The focal length is " + estimate_in_words(focal, focal * focal * sigma, unit);
  if (v.followed.pinhole) text += " (the sequence states " + printed((*v.followed.pinhole)[0], 4) + ")";
  const NearCamera* near = v.followed.asked_nearby();
  const double depth = near == nullptr ? depth_of(v, e) : near->steps.back().depth;
  text += ", and depths reach " + share_in_words(std::abs(kappa) * depth) + " of the distance.";
  if (kappa < 0) text += " The solver's depths are reversed: nearer is farther, which its camera cannot tell.";
  if (near == nullptr) return text;
  const NearCamera::Step &first = near->steps.front(), &last = near->steps.back();
  return text + " On top of " + std::to_string(first.shapes) + " and of " + std::to_string(last.shapes) +
         " shapes this one number lowers the error of unseen observations by " + share_in_words(gain_of(first)) +
         " and " + share_in_words(gain_of(last)) + ", the next shape by itself by " +
         share_in_words(1 - std::exp(-near->of_a_shape)) + ".";
}

std::string scale_remark(const TracksView& v, const Explanation& e) {
  double squares = 0, first = 0;
  for (std::size_t p = v.followed.layout.scale; p < v.followed.layout.weight; ++p)
    squares += e.values[p] * e.values[p], first -= e.values[p];
  squares += first * first;
  return "Scales differ from frame to frame by " +
         share_in_words(
             std::sqrt(squares / static_cast<double>(v.followed.layout.weight - v.followed.layout.scale + 1))) +
         " (rms).";
}

// The largest first.
std::string outlier_remark(const TracksView& v, bool lacking) {
  const Outliers& o = v.followed.outliers;
  std::string text = std::to_string(o.found) + " of " + std::to_string(o.observations) + " observations (" +
                     share_in_words(static_cast<double>(o.found) / static_cast<double>(o.observations)) +
                     ") do not follow, by " + quantity(o.rms_offset, track_unit(v.followed), 3) + " (rms): ";
  std::vector<const Run*> runs;
  for (const Run& run : o.runs) runs.push_back(&run);
  std::stable_sort(runs.begin(), runs.end(), [](const Run* a, const Run* b) {
    return std::hypot(a->offset[0], a->offset[1]) / a->sigma > std::hypot(b->offset[0], b->offset[1]) / b->sigma;
  });
  constexpr std::size_t most = 5;
  for (std::size_t k = 0; k < std::min(most, runs.size()); ++k) {
    text += (k == 0 ? "point " : ", point ") + std::to_string(runs[k]->point) + " in frame" +
            (runs[k]->first == runs[k]->last ? " " : "s ") + std::to_string(runs[k]->first);
    if (runs[k]->first != runs[k]->last) text += " to " + std::to_string(runs[k]->last);
  }
  if (runs.size() > most) text += " and " + std::to_string(runs.size() - most) + " more";
  text += " (counted from 0).";
  if (lacking) return text + " Deformation that the model lacks may look the same: they are not hidden.";
  return text + " Where nothing lies outside, one sequence in a hundred would have any.";
}

// Mean square distance beyond noise.
double excess(const TracksView& v, double score) {
  return score * score - 2 * v.followed.outliers.noise * v.followed.outliers.noise;
}

bool lacks_shapes(const TracksView& v, const Explanation& e) {
  return e.fitted_after > beyond_noise * std::sqrt(2.0) * v.followed.outliers.noise;
}

std::string shapes_remark(const TracksView& v, const Explanation& e) {
  const std::size_t more = std::max<std::size_t>(1, (v.followed.outliers.components + 2) / 3);
  return "What is left, " + quantity(e.fitted_after, track_unit(v.followed), 3) + " where noise makes " +
         quantity(std::sqrt(2.0) * v.followed.outliers.noise, track_unit(v.followed), 2) +
         ", no camera makes: the object deforms in more ways than the model. Solve with a rank of " +
         std::to_string(v.followed.terms + more) + ".";
}

constexpr double hidden_share = 0.5;  // of the distance: perspective that shows from here on is as good as hidden

// How near the camera would have to be, where perspective is not named.
std::string hidden_remark(const NearCamera& near) {
  double from = 0;
  for (const NearCamera::Step& step : near.steps) from = std::max(from, step.visible_from);
  if (from > hidden_share)
    return "Whether the camera is near cannot be told: with so many shapes, depths over the distance would not show "
           "below " +
           share_in_words(hidden_share) + ".";
  return "No perspective is found that both numbers of shapes agree on; from this solution it would show from depths "
         "of " +
         share_in_words(from) + " of the distance on.";
}

std::string part_remark(const TracksView& v) {
  const Followed& f = v.followed;
  return "Held against " + f.reconstruction + ", " + std::to_string(f.terms) +
         (f.terms == 1 ? " shape, on " : " shapes, on ") + std::to_string(f.frames.size()) + " of " +
         std::to_string(f.all_frames) + " frames and " + std::to_string(f.points.size()) + " of " +
         std::to_string(f.all_points) + " points.";
}

// The sequence's camera: what it states, else a pinhole of the focal length that was found.
std::string enter_camera(const TracksView& v, double focal, manifest::Document& document) {
  std::string name = v.followed.sequence + "-camera";
  for (int k = 2; document.cameras.contains(name); ++k) name = v.followed.sequence + "-camera-" + std::to_string(k);
  const std::array<double, 4> k =
      v.followed.pinhole.value_or(std::array{focal, focal, v.followed.centre[0], v.followed.centre[1]});
  manifest::Camera& camera = document.cameras[name];
  camera.fx_px = manifest::Parameter(k[0]), camera.fy_px = manifest::Parameter(k[1]);
  camera.cx_px = manifest::Parameter(k[2]), camera.cy_px = manifest::Parameter(k[3]);
  camera.width_px = std::max(1, static_cast<int>(std::lround(2 * k[2] + 1)));
  camera.height_px = std::max(1, static_cast<int>(std::lround(2 * k[3] + 1)));
  return name;
}

void upgrade_perspective(const TracksView& v, const Explanation& e, manifest::Document& document) {
  const double kappa = e.values[v.followed.layout.perspective];
  manifest::TrackSequence& entry = document.sequences.at(v.followed.sequence);
  entry.projection = "perspective";
  if (entry.camera.empty()) entry.camera = enter_camera(v, 1 / std::abs(kappa), document);
  manifest::MechanismUse& use = document.mechanisms[mechanism::tracks_perspective().id];
  if (std::find(use.on.begin(), use.on.end(), entry.camera) != use.on.end()) return;
  use.on.push_back(entry.camera);
  use.parameters["inverse_focal_per_px"].value.push_back(kappa);
  use.sigma["inverse_focal_per_px"].push_back(e.sigma[v.followed.layout.perspective]);
}

void upgrade_scale(const TracksView& v, manifest::Document& document) {
  document.sequences.at(v.followed.sequence).projection = "perspective";
  manifest::MechanismUse& use = document.mechanisms[mechanism::tracks_scale().id];
  if (std::find(use.on.begin(), use.on.end(), v.followed.sequence) == use.on.end())
    use.on.push_back(v.followed.sequence);
}

void upgrade_outliers(const TracksView& v, manifest::Document& document) {
  manifest::MechanismUse& use = document.mechanisms[mechanism::tracks_outliers().id];
  for (const Run& run : v.followed.outliers.runs) {
    use.on.push_back(gonio::nrsfm::hidden_name(v.followed.sequence, run.point, run.first, run.last));
    const char* names[] = {"slip_u_px", "slip_v_px"};
    for (std::size_t i = 0; i < 2; ++i) {
      use.parameters[names[i]].value.push_back(run.offset[i]);
      use.sigma[names[i]].push_back(run.sigma);
    }
  }
}

constexpr std::size_t most_dots = 1500;

Picture residuals_over(const TracksView& v, const Explanation& e, const Condition& c) {
  const auto dots = [&](const std::vector<double>& residual, const std::string& name) {
    report::Series series;
    series.name = name;
    series.kind = report::Series::Kind::points;
    const std::size_t observations = residual.size() / 2, step = 1 + observations / most_dots;
    for (std::size_t i = 0; i < observations; i += step) {
      const double x = c.direction[2 * i], y = c.direction[2 * i + 1], length = x * x + y * y;
      if (!(length > 0)) continue;
      series.x.push_back(c.values[2 * i]);
      series.y.push_back((residual[2 * i] * x + residual[2 * i + 1] * y) / std::sqrt(length));
    }
    return series;
  };
  report::Plot plot;
  plot.x_label = c.name + (c.unit.empty() ? "" : " [" + c.unit + "]");
  plot.y_label = "residual outwards [" + v.problem.unit() + "]";
  plot.series.push_back(dots(e.residual_before, "base model"));
  if (!e.named.empty()) plot.series.push_back(dots(e.residual_after, "with the named physics"));
  return {"Residuals of single observations over " + c.name, "", report::svg(plot)};
}

}  // namespace

std::string track_unit(const Followed& followed) {
  return followed.perspective ? "px" : "track units";
}

std::string tracks_remarks(const TracksView& v, const Explanation& e) {
  std::string text;
  if (is_named(v, e, mechanism::tracks_perspective().id)) text += perspective_remark(v, e) + " ";
  if (is_named(v, e, mechanism::tracks_scale().id)) text += scale_remark(v, e) + " ";
  if (!v.followed.outliers.runs.empty()) text += outlier_remark(v, lacks_shapes(v, e)) + " ";
  if (lacks_shapes(v, e)) text += shapes_remark(v, e) + " ";
  if (const NearCamera* near = v.followed.asked_nearby();
      near != nullptr && !is_named(v, e, mechanism::tracks_perspective().id))
    text += hidden_remark(*near) + " ";
  return text + part_remark(v);
}

void upgrade_tracks(const TracksView& v, const Explanation& e, manifest::Document& document) {
  if (is_named(v, e, mechanism::tracks_perspective().id)) upgrade_perspective(v, e, document);
  if (is_named(v, e, mechanism::tracks_scale().id)) upgrade_scale(v, document);
  if (!v.followed.outliers.runs.empty() && !lacks_shapes(v, e)) upgrade_outliers(v, document);
}

namespace {

void name_nothing(Explanation& e) {
  for (Hypothesis& h : e.scoreboard)
    if (h.refused.empty() && h.kind == Hypothesis::Kind::mechanisms)
      h.refused = "leaves more than it repairs: the object deforms in more ways than the model";
  e.verdict = Verdict::unknown;
  e.named.clear();
  e.estimates.clear();
  e.not_told_apart.clear();
  e.instead.clear();
  e.values = e.base_values;
  e.residual_after = e.residual_before;
  e.fitted_after = e.fitted_before;
  e.held_out_after = e.held_out_before;
}

Hypothesis nested_hypothesis(const TracksView& v, const NearCamera& near, std::size_t candidate, const Explanation& e) {
  const NearCamera::Step& first = near.steps.front();
  const Candidate& c = v.problem.candidates()[candidate];
  Hypothesis h;
  h.name = c.id();
  h.candidates = {candidate};
  h.held_out = first.held_out_with;
  h.effect = gain_of(first);
  h.gain = first.log_gain;
  h.gain_sigma = first.t_of_points > 0 ? first.log_gain / first.t_of_points : 0;
  h.wald_p = 0;
  for (const NearCamera::Step& step : near.steps)
    h.wald_p = std::max(h.wald_p, stats::student_upper(step.t_of_stretches, double(NearCamera::stretches) - 1));
  const double value = near.steps.back().kappa;
  h.parameters.push_back({c.parameters[0], value, near.sigma, near.lower, near.upper, false});
  if (!near.stands) h.refused = "is not what both numbers of shapes agree on";
  if (near.stands && h.effect < e.smallest_effect) h.refused = "smaller than what matters";
  return h;
}

// The engine has located its own fits, which did not hold what is named now: groups are scored anew, and no curve is
// drawn of what is left.
void relocate(const Observations& o, Explanation& e) {
  for (LocatedCondition& c : e.conditions) c.curve.after.clear();
  for (LocatedGroup& located : e.groups) {
    const auto g = static_cast<std::size_t>(std::find(o.group.begin(), o.group.end(), located.name) - o.group.begin());
    double before = 0, after = 0, norm = 0;
    for (std::size_t i = o.first[g]; i < o.first[g + 1]; ++i) {
      before += e.residual_before[i] * e.residual_before[i];
      after += e.residual_after[i] * e.residual_after[i];
      norm += o.norm[i];
    }
    if (norm > 0) located.before = std::sqrt(before / norm), located.after = std::sqrt(after / norm);
  }
}

void name_perspective(const TracksView& v, const NearCamera& near, std::size_t candidate, const Hypothesis& h,
                      Explanation& e) {
  const NearCamera::Step& first = near.steps.front();
  const Estimate& kappa = h.parameters[0];
  e.verdict = Verdict::named;
  e.named = {candidate};
  e.estimates = h.parameters;
  e.values[kappa.parameter] = kappa.value;
  e.sigma[kappa.parameter] = kappa.sigma;
  e.residual_before = near.residual_without;
  e.residual_after = near.residual_with;
  e.held_out_before = first.held_out_without;
  e.held_out_after = first.held_out_with;
  e.fitted_before = first.fitted_without;
  e.fitted_after = first.fitted_with;
  e.outside.reset();
  relocate(v.problem.observations(), e);
}

// The smallest amplitude that these shapes let through.
void limit_perspective(const NearCamera& near, std::size_t candidate, Explanation& e) {
  double from = 0, depth = 0;
  for (const NearCamera::Step& step : near.steps)
    if (step.visible_from > from) from = step.visible_from, depth = step.depth;
  std::erase_if(e.isolability, [&](const Isolability& i) { return i.candidate == candidate; });
  Isolability limit;
  limit.candidate = candidate;
  limit.surviving_share = near.steps.back().surviving_share;
  if (depth > 0) limit.detection_limit = limit.limit_with_others = {from / depth};
  limit.visible = from <= hidden_share;
  e.isolability.push_back(limit);
}

}  // namespace

// More shapes are no mechanism: where they would repair more than what is named, that is not the reason.
void conclude_shapes(const TracksView& v, std::optional<std::size_t> candidate, Explanation& e) {
  if (!lacks_shapes(v, e)) return;
  e.significant = e.important = true;
  const bool repaired = !e.named.empty() && excess(v, e.fitted_after) < 0.5 * excess(v, e.fitted_before);
  if (repaired && !is_named(v, e, mechanism::tracks_perspective().id)) return;
  if (candidate) v.followed.near_camera();
  const NearCamera* near = candidate ? v.followed.asked_nearby() : nullptr;
  if (repaired && near != nullptr && near->stands) return;
  name_nothing(e);
  if (near == nullptr) return;
  limit_perspective(*near, *candidate, e);
  const Hypothesis h = nested_hypothesis(v, *near, *candidate, e);
  std::erase_if(e.scoreboard, [&](const Hypothesis& other) { return other.candidates == h.candidates; });
  e.minor.clear();
  e.scoreboard.push_back(h);
  if (h.refused.empty()) name_perspective(v, *near, *candidate, h, e);
}

void conclude_outliers(const TracksView& v, std::size_t candidate, Explanation& e) {
  const Outliers& o = v.followed.outliers;
  const Candidate& c = v.problem.candidates()[candidate];
  inference::Apart apart{.candidate = candidate, .estimates = {}, .p = o.p};
  apart.with = o.held_out_with, apart.without = o.held_out_without;
  apart.effect = o.held_out_with > 0 ? 1 - o.held_out_without / o.held_out_with : 0;
  for (std::size_t k = 0; k < c.parameters.size(); ++k) {
    const Run& run = o.runs[k / 2];
    const double value = run.offset[k % 2], reach = 1.96 * run.sigma;
    apart.estimates.push_back({c.parameters[k], value, run.sigma, value - reach, value + reach, false});
  }
  if (lacks_shapes(v, e)) apart.refused = "deformation that the model lacks may look the same";
  inference::join(v.problem, apart, e);
}

Illustration illustrate_tracks(const TracksView& v, const Explanation& e) {
  Illustration result;
  if (e.conditions.empty() || !e.significant) return result;
  for (const Condition& c : v.problem.observations().conditions)
    if (c.name == e.conditions[0].name) result.pictures.push_back(residuals_over(v, e, c));
  return result;
}

}  // namespace gonio::explain
