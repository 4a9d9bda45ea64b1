// See followed.h.
#include "nrsfm/solve/followed.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "manifest/document.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/reconstruction.h"
#include "manifest/sections/sequence.h"
#include "mechanism/mechanism.h"
#include "nrsfm/files.h"
#include "nrsfm/manifest_sequences.h"
#include "nrsfm/solve/follow.h"
#include "nrsfm/solve/near_camera.h"
#include "nrsfm/solve/outliers.h"

namespace gonio::mechanism {
const Mechanism& tracks_perspective();
const Mechanism& tracks_scale();
}  // namespace gonio::mechanism

namespace gonio::nrsfm {
namespace {

using manifest::Document;
using manifest::ShapeReconstruction;

bool is_candidate(const ShapeReconstruction& r) {
  return !r.file.empty() && r.frame != "camera";
}

// Places in `reconstructions` by sequence, those that reproject best first.
std::map<std::string, std::vector<std::size_t>> candidates(const Document& document) {
  std::map<std::string, std::vector<std::size_t>> all;
  const auto rms = [&](std::size_t i) {
    return document.reconstructions[i].reprojection_rms.value_or(std::numeric_limits<double>::infinity());
  };
  for (std::size_t i = 0; i < document.reconstructions.size(); ++i) {
    const ShapeReconstruction& r = document.reconstructions[i];
    if (is_candidate(r) && document.sequences.contains(r.sequence)) all[r.sequence].push_back(i);
  }
  for (auto& [sequence, places] : all) std::ranges::stable_sort(places, {}, rms);
  return all;
}

std::filesystem::path file_of(const Document& document, std::size_t i) {
  return manifest::resolve(document, document.reconstructions[i].file,
                           "/reconstructions/" + std::to_string(i) + "/file");
}

bool is_on(const manifest::MechanismUse& use, const std::string& name) {
  return use.on.empty() || std::find(use.on.begin(), use.on.end(), name) != use.on.end();
}

// What the manifest has switched on for this sequence.
std::optional<double> known_perspective(const Document& document, const std::string& sequence) {
  const auto found = document.mechanisms.find(mechanism::tracks_perspective().id);
  const std::string& camera = document.sequences.at(sequence).camera;
  if (found == document.mechanisms.end() || !is_on(found->second, camera)) return std::nullopt;
  const manifest::MechanismUse& use = found->second;
  const auto value = use.parameters.find("inverse_focal_per_px");
  if (value == use.parameters.end() || !value->second.given()) return std::nullopt;
  const auto place = std::find(use.on.begin(), use.on.end(), camera) - use.on.begin();
  return value->second.value.size() > 1 ? value->second.value[static_cast<std::size_t>(place)] : value->second.scalar();
}

bool scales_are_on(const Document& document, const std::string& sequence) {
  const auto found = document.mechanisms.find(mechanism::tracks_scale().id);
  return found != document.mechanisms.end() && is_on(found->second, sequence);
}

Solved solved_of(const Document& document, std::size_t i) {
  const ShapeReconstruction& entry = document.reconstructions[i];
  Solved solved;
  solved.place = manifest::place(document, "/reconstructions/" + std::to_string(i));
  solved.sequence = sequence_of(document, entry.sequence);
  FileNames names;
  if (const auto shapes = entry.names.find("shapes"); shapes != entry.names.end()) names.shapes = shapes->second;
  solved.reconstruction = read_reconstruction(file_of(document, i), names);
  if (solved.reconstruction.frame == ShapeFrame::camera && entry.frame != "object")
    throw Error(Exit::data, solved.place, "has its shapes in each frame's camera",
                "explain takes shapes in one frame of reference with rotations, as orthographic solvers give them");
  const auto scales = entry.parameters.find("free_scales");
  solved.free_scales =
      (scales != entry.parameters.end() && scales->second > 0) || scales_are_on(document, entry.sequence);
  return solved;
}

std::vector<std::size_t> numbers(const std::vector<Eigen::Index>& all) {
  return {all.begin(), all.end()};
}

std::shared_ptr<const Followed::Parts> parts_of(const Solved& solved, double false_alarm) {
  Outliers outliers = find_outliers(solved, false_alarm);
  Solved sound = solved;
  sound.sequence = without(solved.sequence, outliers.runs);
  sound.sequence.truth.reset();  // nobody who measures has it
  sound.sequence.cameras.clear();
  DeformingModel model(settled(sound.sequence, solved_model(sound)));
  auto parts = std::make_shared<Followed::Parts>(std::move(sound.sequence), std::move(model), std::move(outliers),
                                                 solved.free_scales);
  const SolvedModel& m = parts->model.start();
  for (const Eigen::Index p : m.points) {
    parts->places.emplace_back();
    for (Eigen::Index f = 0; f < m.frame_count(); ++f)
      if (parts->sequence.visible(m.frames[static_cast<std::size_t>(f)], p)) parts->places.back().push_back(f);
    parts->seen.push_back(numbers(parts->places.back()));
  }
  return parts;
}

}  // namespace

Followed::Followed(std::shared_ptr<const Parts> parts) : parts_(std::move(parts)) {
  const SolvedModel& m = parts_->model.start();
  const Sequence& s = parts_->sequence;
  free_scales = parts_->free_scales;
  perspective = s.projection == Projection::perspective;
  if (s.pinhole) pinhole = {s.pinhole->fx_px, s.pinhole->fy_px, s.pinhole->cx_px, s.pinhole->cy_px};
  all_frames = static_cast<std::size_t>(s.frames());
  all_points = static_cast<std::size_t>(s.points());
  frames = numbers(m.frames);
  points = numbers(m.points);
  terms = static_cast<std::size_t>(m.terms());
  centre = {m.centre.x(), m.centre.y()};
  layout = parts_->model.layout();
  start = parts_->model.values();
  outliers = parts_->outliers;
  shape_size.assign(terms, 0.0);
  for (const Eigen::MatrixXd& b : m.basis)
    for (std::size_t k = 0; k < terms; ++k)
      shape_size[k] += b.col(static_cast<Eigen::Index>(k)).squaredNorm() / static_cast<double>(3 * points.size());
  for (double& size : shape_size) size = std::sqrt(size);
}

const std::vector<std::size_t>& Followed::seen(std::size_t point) const {
  return parts_->seen[point];
}

std::vector<double> Followed::observed(std::size_t point) const {
  std::vector<double> result;
  for (const std::size_t f : seen(point))
    for (Eigen::Index i = 0; i < 2; ++i)
      result.push_back(parts_->sequence.tracks(static_cast<Eigen::Index>(2 * frames[f]) + i,
                                               static_cast<Eigen::Index>(points[point])));
  return result;
}

void Followed::predict(std::span<const double> values, std::size_t point, std::span<double> prediction) const {
  parts_->model.predict(values, point, parts_->places[point], prediction);
}

void Followed::jacobian(std::span<const double> values, std::size_t point, std::span<const std::size_t> columns,
                        std::span<double> derivatives) const {
  parts_->model.jacobian(values, point, parts_->places[point], columns, derivatives);
}

std::vector<Followed::Place> Followed::places(std::span<const double> values, std::size_t point) const {
  const std::vector<DeformingModel::Frame> all = parts_->model.frames(values);
  std::vector<Place> result;
  for (const std::size_t f : seen(point)) {
    const Eigen::Vector3d q = parts_->model.in_camera(values, all[f], point);
    const Eigen::Vector2d at = q.head<2>() + all[f].shift;
    result.push_back({{q.x(), q.y(), q.z()}, {at.x() - centre[0], at.y() - centre[1]}});
  }
  return result;
}

const NearCamera& Followed::near_camera() const {
  std::call_once(parts_->near_camera_asked, [&] {
    const double enough = beyond_noise * std::sqrt(2.0) * outliers.noise;
    parts_->near_camera = find_near_camera(parts_->sequence, parts_->model.start(), enough);
    parts_->near_camera_known = true;
  });
  return parts_->near_camera;
}

const NearCamera* Followed::asked_nearby() const {
  return parts_->near_camera_known && !parts_->near_camera.steps.empty() ? &parts_->near_camera : nullptr;
}

Followed follow(const Solved& solved, double false_alarm) {
  return Followed(parts_of(solved, false_alarm));
}

namespace {

// The best of them that leaves something to ask: one with as many shapes as the tracks can carry fits everything.
Followed follow_best(const Document& document, const std::vector<std::size_t>& places, double false_alarm) {
  std::optional<Error> why;
  for (const std::size_t i : places) {
    try {
      Followed followed = follow(solved_of(document, i), false_alarm);
      followed.reconstruction = document.reconstructions[i].id;
      return followed;
    } catch (const Error& e) {
      if (e.code() != Exit::data) throw;
      if (!why) why = e;
    }
  }
  if (places.size() == 1) throw *why;
  throw Error(
      Exit::data, why->place(),
      why->problem() + "; none of its " + std::to_string(places.size()) + " reconstructions leaves anything to ask",
      "solve it with --solver rigid or --solver csf as well");
}

}  // namespace

bool has_followed(const Document& document) {
  return !candidates(document).empty();
}

std::vector<std::filesystem::path> followed_files(const Document& document) {
  std::vector<std::filesystem::path> files;
  for (const auto& [sequence, places] : candidates(document)) {
    for (const std::size_t i : places) files.push_back(file_of(document, i));
    files.push_back(
        manifest::resolve(document, document.sequences.at(sequence).file, "/sequences/" + sequence + "/file"));
  }
  return files;
}

std::vector<Followed> followed_tracks(const Document& document, double false_alarm) {
  std::vector<Followed> all;
  for (const auto& [sequence, places] : candidates(document)) {
    all.push_back(follow_best(document, places, false_alarm));
    all.back().sequence = sequence;
    all.back().inverse_focal = known_perspective(document, all.back().sequence);
  }
  return all;
}

}  // namespace gonio::nrsfm
