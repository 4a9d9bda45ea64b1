// See board_checks.h.
#include "acquisition/run/board_checks.h"

#include <algorithm>
#include <cmath>

#include "acquisition/plan/stations.h"
#include "acquisition/run/frame_record.h"
#include "base/error.h"
#include "base/text.h"
#include "geom/angle.h"
#include "io/grey.h"
#include "manifest/document.h"
#include "manifest/section_tables.h"
#include "manifest/sections/board.h"
#include "manifest/sections/camera.h"

namespace gonio::acquisition {
namespace {

using manifest::Value;

std::optional<camera::Intrinsics> lens_of(const manifest::Document& document, const std::string& name) {
  const auto found = document.cameras.find(name);
  if (found == document.cameras.end() || found->second.model == "orthographic" || found->second.fx_px.value.empty())
    return std::nullopt;
  return camera::intrinsics_of(found->second, manifest::place(document, "/cameras/" + name));
}

std::string shown(double value, const std::string& unit) {
  return unit == "m"     ? format("%.3g mm", 1e3 * value)
         : unit == "rad" ? format("%.3g deg", value / degree)
                         : format("%.3g px", value);
}

std::vector<camera::Corner> corners_of(const manifest::CheckView& view, const std::string& place) {
  const std::size_t n = view.corners.size();
  if (view.u_px.size() != n || view.v_px.size() != n || view.sigma_px.size() != n)
    throw Error(Exit::data, place, "has lists of different lengths", "give corners, u_px, v_px and sigma_px one each");
  std::vector<camera::Corner> corners;
  for (std::size_t i = 0; i < n; ++i)
    corners.push_back({view.corners[i], {view.u_px[i], view.v_px[i]}, view.sigma_px[i]});
  return corners;
}

manifest::CheckView section_of_view(const std::string& image, const std::string& board,
                                    const std::vector<camera::Corner>& corners) {
  manifest::CheckView view{.image = image, .board = board};
  for (const camera::Corner& c : corners) {
    view.corners.push_back(c.id);
    view.u_px.push_back(c.pixel.x), view.v_px.push_back(c.pixel.y);
    view.sigma_px.push_back(c.sigma_px);
  }
  return view;
}

Moved with_share(const Moved& moved, double share) {
  Moved own = moved;
  for (double& c : own.covariance.m) c *= share;
  return own;
}

}  // namespace

std::string checked_image(const manifest::PlanStep& step) {
  const auto images = images_of(step);
  return images[images.size() / 2];
}

std::vector<std::size_t> check_steps(const manifest::Plan& plan) {
  std::map<std::string, int> takes;
  for (const manifest::PlanStep& step : plan.steps) takes[place_key(step)] += step.purpose == "board";
  std::vector<std::size_t> steps;
  for (std::size_t i = 0; i < plan.steps.size(); ++i)
    if (plan.steps[i].purpose == "board" && takes[place_key(plan.steps[i])] > 1) steps.push_back(i);
  return steps;
}

BoardChecks::BoardChecks(const manifest::Document& document, const manifest::Plan& plan, const CheckOptions& options)
    : plan_(plan), options_(options) {
  if (!options.board.empty()) steps_ = check_steps(plan);
  if (steps_.empty() && options.limit)
    throw Error(
        Exit::data, manifest::place(document, "/plans"),
        options.board.empty() ? "no board is described" : "the plan comes back to no view of a board",
        options.board.empty() ? "--checkerboard or --charuco" : "plan with --plan board:views=1 --board-every 20");
  if (steps_.empty()) return;
  board_ = camera::board_of(document, options.board);
  for (const std::size_t i : steps_) {
    const auto& lens = lenses_.try_emplace(plan.steps[i].camera, lens_of(document, plan.steps[i].camera)).first->second;
    if (!lens && options.limit && options.limit->unit != DriftUnit::pixels)
      throw Error(Exit::data, manifest::place(document, "/cameras/" + plan.steps[i].camera),
                  "has no lens by which a board shows the camera's pose", "calibrate it, or give --drift-limit in px");
  }
  for (const manifest::CheckView& view : plan.checks) {
    const auto step = std::ranges::find(plan.steps, view.image, &manifest::PlanStep::image);
    if (view.board == options.board && step != plan.steps.end())
      stored_[place_key(*step)] = corners_of(view, manifest::place(document, "/plans") + " checks " + view.image);
  }
}

bool BoardChecks::is_check(std::size_t step) const {
  return std::ranges::binary_search(steps_, step);
}

void BoardChecks::take_over(const Value& event) {
  const std::string what = event.find("what") == nullptr ? "" : event.find("what")->as_string();
  if (what == "drift") {
    for (const Value& image : event.find("images")->as_array()) seen_.erase(image.as_string());
  } else if (what == "check") {
    const auto view = manifest::Codec<manifest::CheckView>::read(*event.find("view"), "journal");
    seen_[view.image] = {event.find("sha256")->as_string(), event.find("problem")->as_string(),
                         corners_of(view, "journal")};
  }
}

BoardChecks::Seen BoardChecks::seen_in(const std::string& image, const std::filesystem::path& file,
                                       const std::string& sha256, const std::function<void(const Value&)>& write) {
  if (file.empty()) return {"", "the frame was refused", {}};
  if (const auto found = seen_.find(image); found != seen_.end() && found->second.sha256 == sha256)
    return found->second;
  const camera::Detection detection = camera::detect_board(io::read_grey(file), board_, {});
  Seen seen{sha256, detection.corners.empty() ? detection.problem : "", detection.corners};
  for (camera::Corner& c : seen.corners)
    if (!(c.sigma_px > 0)) c.sigma_px = detection.noise_px > 0 ? detection.noise_px : usual_sigma_px;
  write(Value::object(
      {{"what", "check"},
       {"image", image},
       {"sha256", sha256},
       {"problem", seen.problem},
       {"view", manifest::Codec<manifest::CheckView>::write(section_of_view(image, options_.board, seen.corners))}}));
  seen_[image] = seen;
  return seen;
}

std::vector<std::string> BoardChecks::images_between(std::size_t before, std::size_t last) const {
  std::vector<std::string> images;
  for (std::size_t i = before; i <= last; ++i)
    for (const std::string& image : images_of(plan_.steps[i])) images.push_back(image);
  return images;
}

std::optional<manifest::DriftedFrames> BoardChecks::judged(const Seen& seen, const std::string& image, View& view,
                                                           const std::vector<camera::Corner>* stored,
                                                           const std::optional<camera::Intrinsics>& lens) {
  manifest::DriftedFrames worst;
  worst.check = image;
  if (options_.limit) worst.limit = options_.limit->value, worst.unit = unit_name(options_.limit->unit);
  const double level = drift_false_alarms / static_cast<double>(steps_.size() * (stored_.empty() ? 1 : 2));
  bool moved = false;
  if (options_.limit && seen.corners.size() < least_check_corners)
    moved = true, words_ = image + ": " + (seen.problem.empty() ? "too few corners are seen" : seen.problem);
  const auto hold_against = [&](const std::vector<camera::Corner>& before, const std::string& name) {
    const auto shift = shift_between(before, seen.corners, board_, lens);
    if (!shift || !options_.limit) return shift;
    const DriftVerdict verdict = judge_drift(*shift, *options_.limit, level);
    if (!verdict.beyond || worst.value.value_or(0) >= verdict.value) return shift;
    worst.value = verdict.value, worst.sigma = verdict.sigma, worst.against = name, moved = true;
    words_ = image + ": has moved by " + shown(verdict.value, worst.unit) + " +- " + shown(verdict.sigma, worst.unit) +
             " since " + (name.empty() ? "an earlier run of this plan" : name) + ", limit " +
             shown(worst.limit, worst.unit);
    return shift;
  };
  if (stored != nullptr) hold_against(*stored, "");
  if (view.image.empty()) {
    if (seen.corners.size() >= least_check_corners) view.image = image, view.first = seen.corners;
  } else if (const auto shift = hold_against(view.first, view.image); shift && shift->position_m && !moved) {
    if (view.position.empty()) {  // the first take itself
      view.position.push_back(with_share({{}, shift->position_m->covariance}, 1 - shift->own_share));
      view.rotation.push_back(with_share({{}, shift->rotation_rad->covariance}, 1 - shift->own_share));
    }
    view.position.push_back(with_share(*shift->position_m, shift->own_share));
    view.rotation.push_back(with_share(*shift->rotation_rad, shift->own_share));
  }
  if (!moved) return std::nullopt;
  return worst;
}

std::optional<manifest::DriftedFrames> BoardChecks::look(std::size_t step, const std::filesystem::path& file,
                                                         const std::string& sha256,
                                                         const std::function<void(const Value&)>& write) {
  const manifest::PlanStep& at = plan_.steps[step];
  const std::string image = checked_image(at), place = place_key(at);
  const Seen seen = seen_in(image, file, sha256, write);
  const auto stored = stored_.find(place);
  auto drift =
      judged(seen, image, views_[place], stored == stored_.end() ? nullptr : &stored->second, lenses_.at(at.camera));
  moved_ = drift.has_value();
  auto reported = drift ? drift : last_drift_;  // behind a view that had moved nobody knows when it came back
  if (reported) reported->images = images_between(after_, moved_ ? step : step - 1);
  after_ = step + 1, last_drift_ = std::move(drift);
  if (reported && reported->images.empty()) return std::nullopt;
  return reported;
}

std::string BoardChecks::words() const {
  return words_;
}

std::optional<manifest::Repeatability> BoardChecks::repeatability() const {
  std::vector<std::vector<Moved>> position, rotation;
  manifest::Repeatability r;
  for (const auto& [place, view] : views_) {
    r.views += static_cast<std::int64_t>(view.position.size());
    position.push_back(view.position), rotation.push_back(view.rotation);
  }
  const auto place = scatter_of(position), turn = scatter_of(rotation);
  if (!place || !turn) return std::nullopt;
  r.position_m = place->sigma, r.position_interval_m = {place->lower, place->upper}, r.corners_m = place->noise;
  r.rotation_rad = turn->sigma, r.rotation_interval_rad = {turn->lower, turn->upper}, r.corners_rad = turn->noise;
  return r;
}

std::vector<manifest::CheckView> BoardChecks::first_views() const {
  std::vector<manifest::CheckView> list;
  for (const auto& [place, view] : views_)
    if (!view.image.empty()) list.push_back(section_of_view(view.image, options_.board, view.first));
  return list;
}

}  // namespace gonio::acquisition
