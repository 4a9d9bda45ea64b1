// See tracks_outcome.h.
#include "explain/nrsfm/tracks_outcome.h"

#include <algorithm>
#include <cmath>

#include "explain/wording.h"
#include "nrsfm/manifest_sequences.h"
#include "report/number_text.h"
#include "report/plot.h"

namespace gonio::explain {
namespace {

using gonio::nrsfm::Sequence;

bool is_named(const TracksView& v, const Explanation& e, const char* id) {
  return std::any_of(e.named.begin(), e.named.end(),
                     [&](std::size_t c) { return v.problem.candidates()[c].id() == id; });
}

// Largest distance of a point along the line of sight from the shape's origin.
double depth_of(const TracksView& v, const Explanation& e) {
  const std::vector<tracks::DeformingModel::Frame> frames = v.model.frames(e.values);
  double depth = 0;
  for (std::size_t p = 0; p < v.seen.size(); ++p)
    for (const Eigen::Index f : v.seen[p])
      depth = std::max(depth, std::abs(v.model.in_camera(e.values, frames[static_cast<std::size_t>(f)], p).z()));
  return depth;
}

std::string perspective_remark(const TracksView& v, const Explanation& e) {
  const double kappa = e.values[v.layout.perspective], sigma = e.sigma[v.layout.perspective];
  const std::string unit = track_unit(v.input.solved.sequence);
  const double focal = 1 / std::abs(kappa);
  std::string text = "The focal length is " + estimate_in_words(focal, focal * focal * sigma, unit);
  if (const auto& pinhole = v.input.solved.sequence.pinhole)
    text += " (the sequence states " + printed(pinhole->fx_px, 4) + ")";
  text += ", and depths reach " + share_in_words(std::abs(kappa) * depth_of(v, e)) + " of the distance.";
  if (kappa < 0) text += " The solver's depths are reversed: nearer is farther, which its camera cannot tell.";
  return text;
}

std::string scale_remark(const TracksView& v, const Explanation& e) {
  double squares = 0, first = 0;
  for (std::size_t p = v.layout.scale; p < v.layout.weight; ++p)
    squares += e.values[p] * e.values[p], first -= e.values[p];
  squares += first * first;
  return "Scales differ from frame to frame by " +
         share_in_words(std::sqrt(squares / static_cast<double>(v.layout.weight - v.layout.scale + 1))) + " (rms).";
}

// The largest first.
std::string outlier_remark(const TracksView& v) {
  const tracks::Outlying& o = v.outlying;
  std::string text = std::to_string(o.found) + " of " + std::to_string(o.observations) + " observations (" +
                     share_in_words(static_cast<double>(o.found) / static_cast<double>(o.observations)) +
                     ") do not follow, by " + quantity(o.rms_offset, track_unit(v.input.solved.sequence), 3) +
                     " (rms): ";
  std::vector<const tracks::Run*> runs;
  for (const tracks::Run& run : o.runs) runs.push_back(&run);
  std::stable_sort(runs.begin(), runs.end(), [](const tracks::Run* a, const tracks::Run* b) {
    return a->offset.norm() / a->sigma > b->offset.norm() / b->sigma;
  });
  constexpr std::size_t most = 5;
  for (std::size_t k = 0; k < std::min(most, runs.size()); ++k) {
    text += (k == 0 ? "point " : ", point ") + std::to_string(runs[k]->point) + " in frame" +
            (runs[k]->first == runs[k]->last ? " " : "s ") + std::to_string(runs[k]->first);
    if (runs[k]->first != runs[k]->last) text += " to " + std::to_string(runs[k]->last);
  }
  if (runs.size() > most) text += " and " + std::to_string(runs.size() - most) + " more";
  return text + " (counted from 0). Where nothing lies outside, one sequence in a hundred would have any.";
}

constexpr double beyond_noise = 1.5;  // root mean square of what is left, over the noise: something is

// Mean square distance beyond noise.
double excess(const TracksView& v, double score) {
  return score * score - 2 * v.outlying.noise * v.outlying.noise;
}

bool lacks_shapes(const TracksView& v, const Explanation& e) {
  return v.outlying.components > 0 && e.fitted_after > beyond_noise * std::sqrt(2.0) * v.outlying.noise;
}

std::string shapes_remark(const TracksView& v, const Explanation& e) {
  const std::size_t more = (v.outlying.components + 2) / 3;
  return "What is left, " + quantity(e.fitted_after, track_unit(v.input.solved.sequence), 3) + " where noise makes " +
         quantity(std::sqrt(2.0) * v.outlying.noise, track_unit(v.input.solved.sequence), 2) +
         ", many points have in many frames, and no camera makes it: the object deforms in more ways than the model. "
         "Solve "
         "with a rank of " +
         std::to_string(static_cast<std::size_t>(v.model.start().terms()) + more) + ".";
}

std::string part_remark(const TracksView& v) {
  const tracks::SolvedModel& m = v.model.start();
  const Sequence& s = v.input.solved.sequence;
  return "Held against " + v.input.reconstruction + ", " + std::to_string(m.terms()) +
         (m.terms() == 1 ? " shape, on " : " shapes, on ") + std::to_string(m.frame_count()) + " of " +
         std::to_string(s.frames()) + " frames and " + std::to_string(m.point_count()) + " of " +
         std::to_string(s.points()) + " points.";
}

// The sequence's camera: what it states, else a pinhole of the focal length that was found.
std::string enter_camera(const TracksView& v, double focal, manifest::Document& document) {
  const Sequence& s = v.input.solved.sequence;
  std::string name = v.input.sequence + "-camera";
  for (int k = 2; document.cameras.contains(name); ++k) name = v.input.sequence + "-camera-" + std::to_string(k);
  const gonio::nrsfm::Pinhole pinhole =
      s.pinhole.value_or(gonio::nrsfm::Pinhole{focal, focal, v.model.start().centre.x(), v.model.start().centre.y()});
  manifest::Camera& camera = document.cameras[name];
  camera.fx_px = manifest::Parameter(pinhole.fx_px), camera.fy_px = manifest::Parameter(pinhole.fy_px);
  camera.cx_px = manifest::Parameter(pinhole.cx_px), camera.cy_px = manifest::Parameter(pinhole.cy_px);
  camera.width_px = std::max(1, static_cast<int>(std::lround(2 * pinhole.cx_px + 1)));
  camera.height_px = std::max(1, static_cast<int>(std::lround(2 * pinhole.cy_px + 1)));
  return name;
}

void upgrade_perspective(const TracksView& v, const Explanation& e, manifest::Document& document) {
  const double kappa = e.values[v.layout.perspective];
  manifest::TrackSequence& entry = document.sequences.at(v.input.sequence);
  entry.projection = "perspective";
  if (entry.camera.empty()) entry.camera = enter_camera(v, 1 / std::abs(kappa), document);
  manifest::MechanismUse& use = document.mechanisms["tracks.perspective"];
  if (std::find(use.on.begin(), use.on.end(), entry.camera) != use.on.end()) return;
  use.on.push_back(entry.camera);
  use.parameters["inverse_focal_per_px"].value.push_back(kappa);
  use.sigma["inverse_focal_per_px"].push_back(e.sigma[v.layout.perspective]);
}

void upgrade_scale(const TracksView& v, manifest::Document& document) {
  document.sequences.at(v.input.sequence).projection = "perspective";
  manifest::MechanismUse& use = document.mechanisms["tracks.scale"];
  if (std::find(use.on.begin(), use.on.end(), v.input.sequence) == use.on.end()) use.on.push_back(v.input.sequence);
}

void upgrade_outliers(const TracksView& v, manifest::Document& document) {
  manifest::MechanismUse& use = document.mechanisms["tracks.outliers"];
  for (const tracks::Run& run : v.outlying.runs) {
    use.on.push_back(gonio::nrsfm::hidden_name(v.input.sequence, run.point, run.first, run.last));
    const char* names[] = {"slip_u_px", "slip_v_px"};
    for (Eigen::Index i = 0; i < 2; ++i) {
      use.parameters[names[i]].value.push_back(run.offset(i));
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

std::string track_unit(const Sequence& sequence) {
  return sequence.projection == gonio::nrsfm::Projection::perspective ? "px" : "track units";
}

std::string tracks_remarks(const TracksView& v, const Explanation& e) {
  std::string text;
  if (is_named(v, e, "tracks.perspective")) text += perspective_remark(v, e) + " ";
  if (is_named(v, e, "tracks.scale")) text += scale_remark(v, e) + " ";
  if (!v.outlying.runs.empty()) text += outlier_remark(v) + " ";
  if (lacks_shapes(v, e)) text += shapes_remark(v, e) + " ";
  return text + part_remark(v);
}

void upgrade_tracks(const TracksView& v, const Explanation& e, manifest::Document& document) {
  if (is_named(v, e, "tracks.perspective")) upgrade_perspective(v, e, document);
  if (is_named(v, e, "tracks.scale")) upgrade_scale(v, document);
  if (!v.outlying.runs.empty()) upgrade_outliers(v, document);
}

// More shapes are no mechanism: where they would repair more than what is named, that is not the reason.
void conclude_shapes(const TracksView& v, Explanation& e) {
  if (!lacks_shapes(v, e)) return;
  e.significant = e.important = true;
  if (!e.named.empty() && excess(v, e.fitted_after) < 0.5 * excess(v, e.fitted_before)) return;
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

void conclude_outliers(const TracksView& v, std::size_t candidate, Explanation& e) {
  const tracks::Outlying& o = v.outlying;
  const Candidate& c = v.problem.candidates()[candidate];
  Hypothesis h;
  h.name = c.id();
  h.candidates = {candidate};
  h.held_out = o.held_out_without;
  h.effect = o.held_out_with > 0 ? 1 - o.held_out_without / o.held_out_with : 0;
  h.wald_p = o.p;
  for (std::size_t k = 0; k < c.parameters.size(); ++k) {
    const tracks::Run& run = o.runs[k / 2];
    const double value = run.offset(static_cast<Eigen::Index>(k % 2)), reach = 1.96 * run.sigma;
    h.parameters.push_back({c.parameters[k], value, run.sigma, value - reach, value + reach, false});
  }
  const bool matters = h.effect >= e.matters;
  if (!matters) h.refused = "smaller than what matters";
  e.scoreboard.push_back(h);
  e.global_p = std::min(e.global_p, o.p);
  e.significant = true;
  if (!matters) {
    e.minor.push_back(e.scoreboard.size() - 1);
    return;
  }
  e.important = true;
  e.estimates.insert(e.estimates.end(), h.parameters.begin(), h.parameters.end());
  if (e.verdict == Verdict::unknown) return;  // what else is there hides how far the rest can be trusted
  if (e.verdict == Verdict::null) {
    e.verdict = Verdict::named;
    e.conditions.clear();
    e.stage = c.mechanism->stage;
    e.held_out_before = o.held_out_with;
    e.held_out_after = o.held_out_without;
  }
  e.named.push_back(candidate);
}

Illustration illustrate_tracks(const TracksView& v, const Explanation& e) {
  Illustration result;
  if (e.conditions.empty() || !e.significant) return result;
  for (const Condition& c : v.problem.observations().conditions)
    if (c.name == e.conditions[0].name) result.pictures.push_back(residuals_over(v, e, c));
  return result;
}

}  // namespace gonio::explain
