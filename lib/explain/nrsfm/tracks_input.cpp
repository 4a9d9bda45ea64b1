// See tracks_problem.h: from the manifest to sequences with the reconstruction that reprojects best.
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "explain/nrsfm/tracks_problem.h"
#include "nrsfm/files.h"
#include "nrsfm/manifest_sequences.h"

namespace gonio::explain {
namespace {

using manifest::Document;
using manifest::ShapeReconstruction;

bool is_candidate(const ShapeReconstruction& r) {
  return !r.file.empty() && r.frame != "camera";
}

// Places in `reconstructions`, one for each sequence that has any.
std::vector<std::size_t> best_of_each(const Document& document) {
  std::map<std::string, std::size_t> best;
  const auto rms = [&](std::size_t i) {
    return document.reconstructions[i].reprojection_rms.value_or(std::numeric_limits<double>::infinity());
  };
  for (std::size_t i = 0; i < document.reconstructions.size(); ++i) {
    const ShapeReconstruction& r = document.reconstructions[i];
    if (!is_candidate(r) || !document.sequences.contains(r.sequence)) continue;
    const auto [known, first] = best.try_emplace(r.sequence, i);
    if (!first && rms(i) < rms(known->second)) known->second = i;
  }
  std::vector<std::size_t> places;
  for (const auto& [sequence, place] : best) places.push_back(place);
  return places;
}

std::filesystem::path file_of(const Document& document, std::size_t i) {
  return manifest::resolve(document, document.reconstructions[i].file,
                           "/reconstructions/" + std::to_string(i) + "/file");
}

bool is_on(const manifest::MechanismUse& use, const std::string& name) {
  return use.on.empty() || std::find(use.on.begin(), use.on.end(), name) != use.on.end();
}

// What the manifest has switched on for this sequence.
void read_mechanisms(const Document& document, TracksInput& input) {
  const auto perspective = document.mechanisms.find("tracks.perspective");
  const std::string& camera = document.sequences.at(input.sequence).camera;
  if (perspective != document.mechanisms.end() && is_on(perspective->second, camera)) {
    const manifest::MechanismUse& use = perspective->second;
    const auto value = use.parameters.find("inverse_focal_per_px");
    const auto place = std::find(use.on.begin(), use.on.end(), camera) - use.on.begin();
    if (value != use.parameters.end() && value->second.given())
      input.inverse_focal = value->second.value.size() > 1 ? value->second.value[static_cast<std::size_t>(place)]
                                                           : value->second.scalar();
  }
  const auto scale = document.mechanisms.find("tracks.scale");
  if (scale != document.mechanisms.end() && is_on(scale->second, input.sequence)) input.solved.free_scales = true;
}

}  // namespace

bool has_tracks(const Document& document) {
  return !best_of_each(document).empty();
}

std::vector<std::filesystem::path> tracks_files(const Document& document) {
  std::vector<std::filesystem::path> files;
  for (const std::size_t i : best_of_each(document)) {
    files.push_back(file_of(document, i));
    const std::string& sequence = document.reconstructions[i].sequence;
    files.push_back(
        manifest::resolve(document, document.sequences.at(sequence).file, "/sequences/" + sequence + "/file"));
  }
  return files;
}

std::vector<TracksInput> tracks_inputs(const Document& document) {
  std::vector<TracksInput> inputs;
  for (const std::size_t i : best_of_each(document)) {
    const ShapeReconstruction& entry = document.reconstructions[i];
    TracksInput input;
    input.sequence = entry.sequence;
    input.reconstruction = entry.id;
    input.solved.place = manifest::place(document, "/reconstructions/" + std::to_string(i));
    input.solved.sequence = gonio::nrsfm::sequence_of(document, entry.sequence);
    input.solved.sequence.truth.reset();  // nobody who measures has it
    input.solved.sequence.cameras.clear();
    gonio::nrsfm::FileNames names;
    if (const auto shapes = entry.names.find("shapes"); shapes != entry.names.end()) names.shapes = shapes->second;
    input.solved.reconstruction = gonio::nrsfm::read_reconstruction(file_of(document, i), names);
    if (input.solved.reconstruction.frame == gonio::nrsfm::ShapeFrame::camera && entry.frame != "object")
      throw Error(Exit::data, input.solved.place, "has its shapes in each frame's camera",
                  "explain takes shapes in one frame of reference with rotations, as orthographic solvers give them");
    const auto scales = entry.parameters.find("free_scales");
    input.solved.free_scales = scales != entry.parameters.end() && scales->second > 0;
    read_mechanisms(document, input);
    inputs.push_back(std::move(input));
  }
  return inputs;
}

}  // namespace gonio::explain
