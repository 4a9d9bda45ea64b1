// Folds by shots, residuals of held-out views, and the choice.
#include "camera/model_choice.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "base/text.h"
#include "linear/solve.h"
#include "stats/intervals.h"

namespace gonio::camera {
namespace {

constexpr std::size_t most_folds = 5, least_views = 6;
constexpr double outlier_sigmas = 6;  // a corner counts no more than this
constexpr std::size_t least_corners = 6;
constexpr double replaceable = 0.999, supporting = 0.99;  // multiple correlations

// The lenses fitted without the held-out shots, held for these; every held-out view keeps a pose of its own.
CalibrationSetup held(const CalibrationSetup& setup, const Calibration& fit) {
  CalibrationSetup result = setup;
  for (std::size_t c = 0; c < setup.cameras.size(); ++c) {
    result.cameras[c].fixed = {"intrinsics"};
    result.cameras[c].start = fit.cameras[c].lens;
  }
  for (std::size_t b = 0; b < setup.boards.size(); ++b) {
    result.boards[b].free_warp = false;
    result.boards[b].warp = fit.boards[b].warp;
  }
  return result;
}

struct Fold {
  std::vector<std::vector<Vec2>> residuals;  // per held-out view
  std::vector<std::size_t> shots;
  bool failed = false;
};

Fold judged(const std::vector<View>& views, const CalibrationSetup& setup,
            const std::map<std::size_t, std::size_t>& fold_of, std::size_t fold) {
  Fold result;
  std::vector<View> seen;
  std::vector<std::vector<View>> apart(setup.cameras.size());
  for (const View& view : views) {
    if (fold_of.at(view.shot) != fold) {
      seen.push_back(view);
    } else if (view.corners.size() >= least_corners) {
      apart[view.camera].push_back(view);
      apart[view.camera].back().shot = apart[view.camera].size();
      result.shots.push_back(view.shot);
    }
  }
  const Calibration fit = calibrate(seen, setup);
  result.failed = !fit.converged;
  if (result.failed) return result;
  const CalibrationSetup known = held(setup, fit);
  std::vector<Calibration> posed(setup.cameras.size());
  for (std::size_t c = 0; c < setup.cameras.size(); ++c) {
    for (View& view : apart[c]) view.camera = 0;
    if (!apart[c].empty()) posed[c] = calibrate(apart[c], {{known.cameras[c]}, known.boards});
  }
  std::vector<std::size_t> at(setup.cameras.size());
  for (const View& view : views) {
    if (fold_of.at(view.shot) != fold || view.corners.size() < least_corners) continue;
    result.residuals.push_back(posed[view.camera].views[at[view.camera]++].residuals);
  }
  return result;
}

// Mean squared distance per shot, corners beyond the cap counting as the cap.
std::map<std::size_t, double> scores_of(const std::vector<Fold>& folds, double cap) {
  std::map<std::size_t, std::pair<double, double>> sums;
  for (const Fold& fold : folds) {
    for (std::size_t v = 0; v < fold.residuals.size(); ++v) {
      auto& [sum, count] = sums[fold.shots[v]];
      for (const Vec2 r : fold.residuals[v]) sum += std::min(dot(r, r), cap * cap);
      count += static_cast<double>(fold.residuals[v].size());
    }
  }
  std::map<std::size_t, double> scores;
  for (const auto& [shot, sum] : sums) scores[shot] = sum.first / std::max(1.0, sum.second);
  return scores;
}

double mean(const std::map<std::size_t, double>& scores) {
  double sum = 0;
  for (const auto& [shot, score] : scores) sum += score;
  return scores.empty() ? HUGE_VAL : sum / static_cast<double>(scores.size());
}

double typical_px(const std::vector<Fold>& folds) {
  std::vector<double> sizes;
  for (const Fold& fold : folds) {
    for (const auto& view : fold.residuals) {
      for (const Vec2 r : view) sizes.push_back(norm(r));
    }
  }
  if (sizes.empty()) return HUGE_VAL;
  return stats::median(sizes) / std::sqrt(2 * std::log(2.0));
}

double value_of(const Calibration& fit, const SharedParameter& parameter) {
  if (parameter.name == "sag_x_m") return fit.boards[parameter.of].warp.sag_x_m;
  if (parameter.name == "sag_y_m") return fit.boards[parameter.of].warp.sag_y_m;
  const auto place = std::ranges::find(distortion_names, parameter.name);
  if (place == distortion_names.end()) return HUGE_VAL;  // focal lengths, principal points and poses are always there
  return fit.cameras[parameter.of].lens.distortion[static_cast<std::size_t>(place - distortion_names.begin())];
}

// Terms of one polynomial correlate by nature, and are no less harmless for it: 1 numerator, 2 denominator, 0 none.
int polynomial_of(const Calibration& fit, const SharedParameter& parameter) {
  const std::string& name = parameter.name;
  if (name == "k1" || name == "k2" || name == "k3") return 1;
  if (name != "k4" && name != "k5" && name != "k6") return 0;
  return fit.cameras[parameter.of].lens.distortion[LensTerm::fisheye] != 0 ? 1 : 2;
}

// R^2 = 1 - 1 / (C_ii (C^-1)_ii): the share of what the views say of parameter i that others can take over; C without
// the rest of i's own polynomial.
double replaced_share(const Calibration& fit, const Eigen::MatrixXd& correlation, Eigen::Index i) {
  const auto of = [&](Eigen::Index k) { return fit.shared[static_cast<std::size_t>(k)]; };
  const int own = polynomial_of(fit, of(i));
  std::vector<Eigen::Index> kept{i};
  for (Eigen::Index k = 0; k < correlation.rows(); ++k) {
    const bool same = own > 0 && polynomial_of(fit, of(k)) == own && of(k).of == of(i).of;
    if (k != i && !same) kept.push_back(k);
  }
  const Eigen::MatrixXd inverse = linear::inverse(correlation(kept, kept));
  return 1 - 1 / inverse(0, 0);
}

// Names of terms that others can stand in for, where no term among those that hold each other up exceeds its own sigma.
std::string undetermined(const Calibration& fit) {
  const auto k = static_cast<Eigen::Index>(fit.shared.size());
  const Eigen::Map<const Eigen::MatrixXd> covariance(fit.covariance.data(), k, k);
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlation = scale.asDiagonal() * covariance * scale.asDiagonal();
  std::string names;
  for (Eigen::Index i = 0; i < k; ++i) {
    const SharedParameter& parameter = fit.shared[static_cast<std::size_t>(i)];
    const double value = std::abs(value_of(fit, parameter));
    if (std::isinf(value)) continue;
    const double share = replaced_share(fit, correlation, i);
    if (share < supporting * supporting) continue;
    if (value * scale(i) > 1) return {};
    if (share > replaceable * replaceable) names += (names.empty() ? "" : ", ") + parameter.name;
  }
  return names;
}

// Why the model may not be chosen, from its fit to all views; empty where it may.
std::string unfitness(const Calibration& fit) {
  if (!fit.converged) return "its fit to all views does not converge";
  if (fit.covariance.empty()) return "the views do not determine it";
  const std::string names = undetermined(fit);
  return names.empty() ? "" : "the views do not determine " + names;
}

std::string called(const ModelScore& score) {
  return score.model + (score.warp ? " with board warp" : "");
}

std::string sentence(const ModelChoice& choice, std::size_t i) {
  const ModelScore &own = choice.scores[i], &best = choice.scores[choice.best];
  const std::string head = called(own) + ": ";
  if (own.failed) return head + "could not be fitted to every part of the views";
  const std::string reach = head + format("%.3f px on held-out views", own.held_out_px);
  if (!own.unfit.empty()) return reach + "; cannot be chosen: " + own.unfit;
  if (i == choice.chosen && i == choice.best) return reach + "; chosen, because it predicts best";
  if (i == choice.chosen)
    return reach + "; chosen, as the simplest within one standard error of the best (" + called(best) + ")";
  const double errors = own.gap_sigma > 0 ? own.gap / own.gap_sigma : HUGE_VAL;
  if (errors > 1) return reach + format("; worse than the best by %.1f standard errors", std::min(errors, 999.0));
  return reach + "; as good as the chosen one, but with more parameters";
}

std::vector<ModelScore> hypotheses(const CalibrationSetup& setup) {
  std::vector<ModelScore> list;
  const bool settled = std::ranges::any_of(setup.boards, &BoardSetup::free_warp);
  for (const std::string& model : calibrated_models()) {
    for (const bool warp : {false, true}) {
      if (settled && !warp) continue;
      int terms = 4 + (warp ? 2 : 0);
      for (std::size_t t = 0; t < distortion_terms; ++t) terms += camera_model_info(model, "").fitted.has(t);
      terms += camera_model_info(model, "").fisheye > 0;  // the projection itself is chosen
      list.push_back({.model = model, .warp = warp, .parameters = terms});
    }
  }
  std::ranges::stable_sort(list, {}, &ModelScore::parameters);
  return list;
}

CalibrationSetup setup_of(const CalibrationSetup& setup, const ModelScore& hypothesis) {
  CalibrationSetup result = setup;
  for (CameraSetup& camera : result.cameras) camera.model = hypothesis.model;
  for (BoardSetup& board : result.boards) board.free_warp = hypothesis.warp;
  return result;
}

// The shots that show the board, dealt into folds that are held out one after the other.
struct Deal {
  std::map<std::size_t, std::size_t> fold_of;
  std::size_t folds = 0;
};
Deal deal(const std::vector<View>& views) {
  Deal d;
  for (const View& view : views) {
    if (view.corners.size() >= least_corners) d.fold_of.emplace(view.shot, d.fold_of.size());
  }
  if (d.fold_of.size() < least_views) {
    throw Error(Exit::data, "--model auto",
                std::to_string(d.fold_of.size()) + " views show the board (at least " + std::to_string(least_views) +
                    " are needed to hold some out)",
                "photograph it from more directions, or name a model");
  }
  d.folds = std::min(most_folds, d.fold_of.size());
  for (auto& [shot, fold] : d.fold_of) fold %= d.folds;
  return d;
}

}  // namespace

ModelChoice score_models(const std::vector<View>& views, const CalibrationSetup& setup) {
  const Deal dealt = deal(views);
  const std::map<std::size_t, std::size_t>& fold_of = dealt.fold_of;
  const std::size_t folds = dealt.folds;
  std::vector<View> usable;
  for (const View& view : views) {
    if (view.corners.size() >= least_corners) usable.push_back(view);
  }
  ModelChoice choice;
  choice.scores = hypotheses(setup);
  std::vector<std::vector<Fold>> all(choice.scores.size(), std::vector<Fold>(folds));
  parallel_for(0, all.size() * (folds + 1), [&](std::size_t i) {
    const std::size_t h = i / (folds + 1), fold = i % (folds + 1);
    const CalibrationSetup own = setup_of(setup, choice.scores[h]);
    if (fold == folds)
      choice.scores[h].unfit = unfitness(calibrate(usable, own));
    else
      all[h][fold] = judged(usable, own, fold_of, fold);
  });
  double noise = HUGE_VAL;
  for (const auto& own : all) noise = std::min(noise, typical_px(own));
  std::vector<std::map<std::size_t, double>> scores;
  for (std::size_t h = 0; h < all.size(); ++h) {
    ModelScore& own = choice.scores[h];
    own.failed = std::ranges::any_of(all[h], &Fold::failed);
    scores.push_back(scores_of(all[h], outlier_sigmas * noise));
    own.held_out_px = std::sqrt(mean(scores.back()));
    const ModelScore& best = choice.scores[choice.best];
    if (own.eligible() && (!best.eligible() || own.held_out_px < best.held_out_px)) choice.best = h;
  }
  if (!choice.scores[choice.best].eligible()) {
    throw Error(Exit::data, "--model auto", "these views determine no lens model: " + sentence(choice, choice.best),
                "tilt the board by 20 to 45 degrees about both axes, or name a model");
  }
  choice.chosen = choice.best;
  for (std::size_t h = all.size(); h-- > 0;) {
    ModelScore& own = choice.scores[h];
    if (!own.eligible()) continue;
    double sum = 0, squares = 0;
    for (const auto& [shot, score] : scores[h]) {
      const double d = score - scores[choice.best].at(shot);
      sum += d;
      squares += d * d;
    }
    const auto n = static_cast<double>(scores[h].size());
    own.gap = sum / n;
    own.gap_sigma = std::sqrt(std::max(0.0, squares - n * own.gap * own.gap) / (n * (n - 1)));
    if (own.gap <= own.gap_sigma && h < choice.chosen) choice.chosen = h;
  }
  for (std::size_t h = 0; h < all.size(); ++h) choice.sentences.push_back(sentence(choice, h));
  return choice;
}

void choose_model(const std::vector<View>& views, CalibrationSetup& setup) {
  const ModelChoice choice = score_models(views, setup);
  for (const std::string& line : choice.sentences) log(LogLevel::info, line);
  setup = setup_of(setup, choice.scores[choice.chosen]);
}

}  // namespace gonio::camera
