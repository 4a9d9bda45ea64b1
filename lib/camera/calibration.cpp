// The course of a calibration: start, adjust, weigh the views, judge.
#include "camera/calibration.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/text.h"
#include "camera/bundle_adjustment.h"
#include "camera/carried_corners.h"
#include "stats/intervals.h"

namespace gonio::camera {
namespace {

constexpr std::size_t least_corners = 6;  // in a view: a pose and something to check it with
constexpr double first_loss_px = 2;       // before the noise is known
constexpr double least_loss_px = 0.02;
constexpr double loss_sigmas = 3;
constexpr double set_aside_sigmas = 6;
constexpr double suspicious = 2.5, hopeless = 6;  // noise of a view over the median of all
constexpr std::size_t few_views = 6;              // too few to call one of them the odd one out
constexpr int weighing_rounds = 4;
constexpr double largest_precision = 9;  // and its inverse: no view outweighs another of its camera by more than 81

bool spans_a_plane(const View& view, const Board& board) {  // corners on one line allow no pose
  std::set<int> columns, rows;
  for (const Corner& c : view.corners) {
    columns.insert(c.id % board.corner_columns);
    rows.insert(c.id / board.corner_columns);
  }
  return columns.size() >= 2 && rows.size() >= 2;
}

// Sigma of one coordinate from the median distance, for which |r|^2 = 2 ln 2 s^2 in two dimensions.
double robust_noise(const std::vector<Vec2>& residual) {
  std::vector<double> sizes;
  for (const Vec2 r : residual) sizes.push_back(norm(r));
  return stats::median(sizes) / std::sqrt(2 * std::log(2.0));
}

double rms(const std::vector<Vec2>& residual) {
  double sum = 0;
  for (const Vec2 r : residual) sum += dot(r, r);
  return residual.empty() ? 0 : std::sqrt(sum / static_cast<double>(residual.size()));
}

// Residuals in units of a corner of precision 1.
std::vector<Vec2> whitened(const std::vector<View>& views, const CalibrationSetup& setup, const Adjustment& state,
                           std::size_t i) {
  std::vector<Vec2> result = misses(views, setup, state, i);
  for (std::size_t k = 0; k < result.size(); ++k) result[k] = result[k] * std::sqrt(state.precision[i][k]);
  return result;
}

// Sigma of a corner of precision 1.
double usual_noise(const std::vector<View>& views, const CalibrationSetup& setup, const Adjustment& state) {
  std::vector<Vec2> all;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (state.view_weights[i] == 0) continue;
    for (const Vec2 r : whitened(views, setup, state, i)) all.push_back(r * std::sqrt(state.view_weights[i]));
  }
  return robust_noise(all);
}

// Corners count by their inverse variance: the noise measured in the picture, and what the views of the camera miss by
// beyond it (a bent board, an incomplete lens).
void set_precisions(const std::vector<View>& views, const CalibrationSetup& setup, Adjustment& state,
                    Calibration& result) {
  std::vector<std::vector<double>> variance(views.size());
  std::vector<double> usual_variance(state.lenses.size(), 0.0), logarithms;
  for (std::size_t c = 0; c < state.lenses.size(); ++c) {
    std::vector<double> known, excess, own;
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (views[i].camera == c && state.view_weights[i] > 0 && views[i].noise_px > 0)
        known.push_back(views[i].noise_px);
    }
    const double usual = known.empty() ? 0 : stats::median(known);
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (views[i].camera != c || state.view_weights[i] == 0) continue;
      const double noise = views[i].noise_px > 0 ? views[i].noise_px : usual;
      const Carriers carriers(views, i);
      for (std::size_t k = 0; k < views[i].corners.size(); ++k)
        variance[i].push_back(carriers.variance_px2(k).value_or(noise * noise));
      const double scatter = robust_noise(misses(views, setup, state, i));
      excess.push_back(scatter * scatter - stats::median(variance[i]));
    }
    const double common = std::max(0.0, stats::median(excess));
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (views[i].camera != c) continue;
      for (double& v : variance[i]) own.push_back(v = std::max(common + v, 1e-12));
    }
    if (own.empty()) continue;
    usual_variance[c] = stats::median(own);
    logarithms.push_back(std::log(usual_variance[c]));
  }
  const double reference = std::exp(stats::mean(logarithms));
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (variance[i].empty()) continue;
    result.views[i].sigma_px = std::sqrt(stats::median(variance[i]));
    for (std::size_t k = 0; k < variance[i].size(); ++k) {
      const double usual = usual_variance[views[i].camera];
      state.precision[i][k] =
          reference / usual * std::clamp(usual / variance[i][k], 1 / largest_precision, largest_precision);
    }
  }
}

// Weights from how much worse a view fits than the median one of its camera, single bad corners apart; true where they
// changed.
bool weigh_views(const std::vector<View>& views, const CalibrationSetup& setup, Adjustment& state,
                 Calibration& result) {
  bool changed = false;
  for (std::size_t c = 0; c < state.lenses.size(); ++c) {
    std::vector<double> scatter(views.size()), used;
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (views[i].camera != c || state.view_weights[i] == 0) continue;
      scatter[i] = robust_noise(whitened(views, setup, state, i));
      used.push_back(scatter[i]);
    }
    if (used.size() < few_views) continue;
    const double usual = stats::median(used);
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (scatter[i] == 0) continue;
      const double ratio = scatter[i] / usual;
      const double weight = ratio > hopeless ? 0 : ratio > suspicious ? 1 / (ratio * ratio) : 1;
      changed |= std::abs(weight - state.view_weights[i]) > 0.05;
      state.view_weights[i] = weight;
      result.views[i].note =
          weight == 1 ? ""
                      : format("its corners scatter by %.2f px, the median view's by %.2f px", scatter[i], usual) +
                            (weight == 0 ? "; dropped" : "; weighted down");
    }
  }
  return changed;
}

void summarise_view(const std::vector<View>& views, const CalibrationSetup& setup, const Adjustment& state,
                    std::size_t i, double limit, Calibration& result) {
  const View& view = views[i];
  CalibratedView& own = result.views[i];
  own.placement = state.placement_of[i];
  own.camera_from_board = state.pose(view, i);
  own.weight = state.view_weights[i];
  if (view.corners.size() < least_corners) return;
  own.residuals = residuals(view, setup, state, i);
  const std::vector<Vec2> counted = whitened(views, setup, state, i);
  std::vector<Vec2> kept;
  for (std::size_t k = 0; k < own.residuals.size(); ++k) {
    const Vec2 r = own.residuals[k];
    const double size = std::sqrt(own.weight > 0 ? own.weight : 1) * norm(counted[k]);
    own.corner_weights.push_back(size > state.loss_px ? state.loss_px / size : 1);
    if (own.weight == 0 || size <= limit) kept.push_back(r);
  }
  own.rms_px = rms(kept);
  if (own.weight == 0) return;
  CalibratedCamera& camera = result.cameras[view.camera];
  camera.set_aside += static_cast<int>(own.residuals.size() - kept.size());
  camera.corners += static_cast<int>(kept.size());
  for (const Vec2 r : kept) camera.rms_px += dot(r, r);  // a sum until all views are in
}

void summarise(const std::vector<View>& views, const CalibrationSetup& setup, const Adjustment& state,
               Calibration& result) {
  result.converged = state.converged;
  const double limit = set_aside_sigmas * std::max(usual_noise(views, setup, state), 1e-6);
  for (std::size_t c = 0; c < result.cameras.size(); ++c) {
    result.cameras[c].lens = state.lenses[c];
    if (state.tied[c]) result.cameras[c].rig_from_camera = inverse(state.camera_from_rig[c]);
    result.cameras[c].tied = state.tied[c];
  }
  for (std::size_t b = 0; b < result.boards.size(); ++b) result.boards[b].warp = state.warps[b];
  for (std::size_t p = 0; p < result.placements.size(); ++p) {
    result.placements[p].rig_from_board = state.placements[p];
  }
  for (std::size_t i = 0; i < views.size(); ++i) summarise_view(views, setup, state, i, limit, result);
  double sum = 0;
  int corners = 0;
  for (CalibratedCamera& camera : result.cameras) {
    sum += camera.rms_px;
    corners += camera.corners;
    camera.rms_px = camera.corners > 0 ? std::sqrt(camera.rms_px / camera.corners) : 0;
  }
  result.rms_px = corners > 0 ? std::sqrt(sum / corners) : 0;
}

// Noise of a camera's coordinates: that of unit weight over the root of its views' usual precision.
void store_noise(const std::vector<View>& views, const Adjustment& state, Calibration& result) {
  for (std::size_t c = 0; c < result.cameras.size(); ++c) {
    std::vector<double> precision;
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (views[i].camera != c || state.view_weights[i] == 0) continue;
      precision.insert(precision.end(), state.precision[i].begin(), state.precision[i].end());
    }
    if (!precision.empty()) result.cameras[c].noise_px = result.noise_px / std::sqrt(stats::median(precision));
  }
}

// Views that can be used, and the places of boards that they share.
void lay_out(const std::vector<View>& views, const CalibrationSetup& setup, Adjustment& state, Calibration& result) {
  result.views.resize(views.size());
  result.cameras.resize(setup.cameras.size());
  result.boards.resize(setup.boards.size());
  state.view_weights.resize(views.size());
  for (const View& view : views) state.precision.emplace_back(view.corners.size(), 1.0);
  state.placement_of.resize(views.size());
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> known;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const auto [place, fresh] = known.emplace(std::pair{views[i].shot, views[i].board}, result.placements.size());
    if (fresh) result.placements.push_back({views[i].shot, views[i].board, {}, {}, {}});
    state.placement_of[i] = place->second;
    const Board& board = setup.boards[views[i].board].board;
    const bool enough = views[i].corners.size() >= least_corners && spans_a_plane(views[i], board);
    state.view_weights[i] = enough ? 1 : 0;
    if (!enough) result.views[i].note = "too few corners (" + std::to_string(views[i].corners.size()) + ")";
  }
  state.placements.resize(result.placements.size(), PlacedBoard{{}, {0, 0, 1}});
}

}  // namespace

std::optional<double> Calibration::sigma(const std::string& name, std::size_t of) const {
  const auto found =
      std::ranges::find_if(shared, [&](const SharedParameter& p) { return p.name == name && p.of == of; });
  if (found == shared.end() || covariance.empty()) return std::nullopt;
  const auto i = static_cast<std::size_t>(found - shared.begin());
  return std::sqrt(covariance[i * shared.size() + i]);
}

std::vector<std::size_t> Calibration::lens_parameters(std::size_t camera) const {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < shared.size(); ++i) {
    if (shared[i].kind == SharedParameter::Kind::lens && shared[i].of == camera) places.push_back(i);
  }
  return places;
}

Calibration calibrate(const std::vector<View>& views, const CalibrationSetup& setup) {
  Calibration result;
  Adjustment state;
  lay_out(views, setup, state, result);
  for (std::size_t c = 0; c < setup.cameras.size(); ++c) {
    bool seen = false;
    for (std::size_t i = 0; i < views.size(); ++i) seen |= views[i].camera == c && state.view_weights[i] > 0;
    if (!seen) result.complaints.push_back("no view of " + setup.cameras[c].name + " shows enough corners of a board");
  }
  if (!result.complaints.empty()) return result;
  state.loss_px = first_loss_px;
  start(views, setup, state);
  adjust(views, setup, state);
  for (int round = 0; round < weighing_rounds; ++round) {
    set_precisions(views, setup, state, result);
    const bool changed = weigh_views(views, setup, state, result);
    state.loss_px = std::max(least_loss_px, loss_sigmas * usual_noise(views, setup, state));
    adjust(views, setup, state);
    if (!changed && round > 0) break;
  }
  summarise(views, setup, state, result);
  estimate_covariance(views, setup, state, result);
  store_noise(views, state, result);
  judge(views, setup, state, result);
  return result;
}

}  // namespace gonio::camera
