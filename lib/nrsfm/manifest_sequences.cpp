// See manifest_sequences.h.
#include "nrsfm/manifest_sequences.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <utility>

#include "base/error.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/reconstruction.h"
#include "manifest/sections/sequence.h"
#include "mechanism/mechanism.h"
#include "nrsfm/files.h"
#include "nrsfm/solve/followed.h"

namespace gonio::mechanism {
const Mechanism& tracks_outliers();
}

namespace gonio::nrsfm {
namespace {

std::string name_of(const manifest::TrackSequence& entry, const std::string& key) {
  const auto found = entry.names.find(key);
  return found == entry.names.end() ? std::string() : found->second;
}

Pinhole pinhole_of(const manifest::Document& document, const std::string& name, const std::string& place) {
  const auto found = document.cameras.find(name);
  if (found == document.cameras.end())
    throw Error(Exit::data, place + "/camera", "\"" + name + "\" is not in cameras", "enter it, or leave it out");
  const manifest::Camera& camera = found->second;
  for (const manifest::Parameter* number : {&camera.fx_px, &camera.fy_px, &camera.cx_px, &camera.cy_px})
    if (!number->given())
      throw Error(Exit::data, place + "/camera", "\"" + name + "\" is no pinhole",
                  "give fx_px, fy_px, cx_px and cy_px");
  return {camera.fx_px.scalar(), camera.fy_px.scalar(), camera.cx_px.scalar(), camera.cy_px.scalar()};
}

void check_count(const char* what, std::optional<std::int64_t> said, Eigen::Index there, const std::string& place) {
  if (said && *said != there)
    throw Error(Exit::data, place + "/" + what, std::to_string(*said) + " where the file has " + std::to_string(there),
                "correct the entry");
}

// The observation names of `use` that belong to this sequence, hidden.
void hide(const manifest::MechanismUse& use, const std::string& id, const std::string& place, Sequence& s) {
  for (const std::string& name : use.on) {
    if (!name.starts_with(id + "/point-")) continue;
    long point = -1, first = -1, last = -1;
    const char* rest = name.c_str() + id.size();
    if (std::sscanf(rest, "/point-%ld/frame-%ld", &point, &first) == 2)
      last = first;
    else if (std::sscanf(rest, "/point-%ld/frames-%ld-%ld", &point, &first, &last) != 3)
      point = -1;
    if (point < 0 || point >= s.points() || first < 0 || last < first || last >= s.frames())
      throw Error(Exit::data, place,
                  "\"" + name + "\" is no observation of " + std::to_string(s.frames()) + " frames of " +
                      std::to_string(s.points()) + " points",
                  "name it " + hidden_name(id, 0, 0, 0) + " or " + hidden_name(id, 0, 0, 1) + ", counted from 0");
    s.visible.col(point).segment(first, last - first + 1) = false;
    s.tracks.col(point)
        .segment(2 * first, 2 * (last - first + 1))
        .setConstant(std::numeric_limits<double>::quiet_NaN());
  }
}

}  // namespace

std::string hidden_name(const std::string& sequence, std::size_t point, std::size_t first, std::size_t last) {
  const std::string at = sequence + "/point-" + std::to_string(point) + "/frame";
  return first == last ? at + "-" + std::to_string(first)
                       : at + "s-" + std::to_string(first) + "-" + std::to_string(last);
}

Sequence sequence_of(const manifest::Document& document, const std::string& id) {
  const auto found = document.sequences.find(id);
  const std::string pointer = "/sequences/" + id, place = manifest::place(document, pointer);
  if (found == document.sequences.end())
    throw Error(Exit::data, manifest::place(document, "/sequences"), "has no \"" + id + "\"");
  const manifest::TrackSequence& entry = found->second;
  FileNames names;
  names.tracks = name_of(entry, "tracks");
  names.visible = name_of(entry, "visible");
  names.truth = name_of(entry, "truth");
  Sequence sequence = read_sequence(manifest::resolve(document, entry.file, pointer + "/file"), names);
  sequence.name = id;
  check_count("frames", entry.frames, sequence.frames(), place);
  check_count("points", entry.points, sequence.points(), place);
  if (!entry.projection.empty())
    sequence.projection = entry.projection == "perspective" ? Projection::perspective : Projection::orthographic;
  if (!entry.camera.empty()) sequence.pinhole = pinhole_of(document, entry.camera, place);
  if (!entry.truth_frame.empty())
    sequence.truth_frame = entry.truth_frame == "camera" ? ShapeFrame::camera : ShapeFrame::object;
  if (entry.unit_m) sequence.unit_m = *entry.unit_m;
  for (const auto& [factor, level] : entry.factors) sequence.factors[factor] = level;
  if (const auto use = document.mechanisms.find(mechanism::tracks_outliers().id); use != document.mechanisms.end())
    hide(use->second, id, manifest::place(document, "/mechanisms/tracks.outliers/on"), sequence);
  return sequence;
}

std::string enter_sequence(manifest::Document& document, const std::filesystem::path& file, const Sequence& sequence) {
  const std::string stem = file.stem().string();
  std::string id = stem;
  for (int k = 2; document.sequences.contains(id); ++k) id = stem + "-" + std::to_string(k);
  manifest::TrackSequence entry;
  entry.file = manifest::add_file(document, file, id);
  entry.frames = sequence.frames();
  entry.points = sequence.points();
  entry.projection = sequence.projection == Projection::perspective ? "perspective" : "orthographic";
  if (sequence.truth) entry.truth_frame = sequence.truth_frame == ShapeFrame::camera ? "camera" : "object";
  if (sequence.unit_m > 0) entry.unit_m = sequence.unit_m;
  entry.missing_share = sequence.missing_share();
  entry.factors = sequence.factors;
  document.sequences[id] = std::move(entry);
  return id;
}

void enter_reconstruction(manifest::Document& document, const std::string& id, const std::string& sequence,
                          const Solution& solution, std::uint64_t seed, const std::filesystem::path& file) {
  const Reconstruction& answer = solution.reconstruction;
  manifest::ShapeReconstruction entry;
  entry.id = id;
  entry.sequence = sequence;
  entry.algorithm = answer.name;
  entry.file = manifest::add_file(document, file, id);
  entry.frame = answer.frame == ShapeFrame::camera ? "camera" : "object";
  entry.parameters = solution.values;
  Eigen::Index estimated = 0;
  for (Eigen::Index f = 0; f < answer.frames(); ++f)
    for (Eigen::Index p = 0; p < answer.points(); ++p) estimated += shape_of(answer.shapes, f).col(p).allFinite();
  entry.estimated_share = static_cast<double>(estimated) / static_cast<double>(answer.frames() * answer.points());
  entry.reprojection_rms = solution.reprojection_rms;
  entry.iterations = solution.iterations;
  entry.converged = solution.converged;
  entry.seed = seed;
  entry.notes = solution.notes;
  const auto same = std::ranges::find(document.reconstructions, id, &manifest::ShapeReconstruction::id);
  if (same != document.reconstructions.end())
    *same = std::move(entry);
  else
    document.reconstructions.push_back(std::move(entry));
}

}  // namespace gonio::nrsfm
