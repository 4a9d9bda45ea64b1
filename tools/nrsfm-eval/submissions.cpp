// See submissions.h.
#include "tools/nrsfm-eval/submissions.h"

#include <algorithm>
#include <map>

#include "manifest/sections/reconstruction.h"
#include "manifest/sections/sequence.h"
#include "nrsfm/files.h"
#include "nrsfm/manifest_sequences.h"

namespace gonio::tools::nrsfm_eval {

using namespace gonio::nrsfm;

namespace {

namespace fs = std::filesystem;

std::string member(const std::map<std::string, std::string>& names, const std::string& key) {
  const auto found = names.find(key);
  return found == names.end() ? std::string() : found->second;
}

ShapeFrame frame_named(const std::string& name) {
  return name == "camera" ? ShapeFrame::camera : ShapeFrame::object;
}

void note_inputs(cli::Invocation& call, const fs::path& path) {
  if (!fs::is_directory(path)) return call.note_input(path);
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(path))
    if (entry.path().extension() == ".ply") files.push_back(entry.path());
  std::ranges::sort(files);
  for (const fs::path& file : files) call.note_input(file);
}

void add_entry(cli::Invocation& call, std::size_t index, Submissions& out, std::map<std::string, std::size_t>& known) {
  const manifest::ShapeReconstruction& entry = call.document.reconstructions[index];
  if (!known.contains(entry.sequence)) {
    known[entry.sequence] = out.sequences.size();
    out.sequences.push_back(sequence_of(call.document, entry.sequence));
    call.note_input(manifest::resolve(call.document, call.document.sequences.at(entry.sequence).file,
                                      "/sequences/" + entry.sequence + "/file"));
  }
  const std::string pointer = "/reconstructions/" + std::to_string(index);
  const fs::path path = entry.folder.empty() ? manifest::resolve(call.document, entry.file, pointer + "/file")
                                             : call.document.folder / entry.folder;
  note_inputs(call, path);
  FileNames names;
  names.shapes = member(entry.names, "shapes");
  Submission s{entry.id, known.at(entry.sequence), {}, {}};
  s.reconstruction = read_reconstruction(path, names, &s.notes);
  s.reconstruction.name = entry.algorithm;
  if (!entry.frame.empty()) s.reconstruction.frame = frame_named(entry.frame), s.notes.clear();
  for (const auto& [factor, level] : entry.factors) s.reconstruction.factors[factor] = level;
  out.all.push_back(std::move(s));
}

void add_files(cli::Invocation& call, Submissions& out) {
  const fs::path truth = call.text("truth");
  call.note_input(truth);
  FileNames names;
  if (call.given("truth-variable")) names.truth = call.text("truth-variable");
  if (call.given("shapes-variable")) names.shapes = call.text("shapes-variable");
  std::vector<std::string> notes;
  out.sequences.push_back(read_sequence(truth, names, &notes));
  if (call.given("unit")) out.sequences.back().unit_m = call.number("unit");
  for (const std::string& file : call.texts("RECONSTRUCTION")) {
    note_inputs(call, file);
    Submission s{fs::path(file).stem().string(), out.sequences.size() - 1, {}, notes};
    s.reconstruction = read_reconstruction(file, names, &s.notes);
    if (call.given("algorithm")) s.reconstruction.name = call.text("algorithm");
    if (call.text("frame") != "file") s.reconstruction.frame = frame_named(call.text("frame"));
    int again = 1;
    const std::string stem = s.id;
    while (std::ranges::find(out.all, s.id, &Submission::id) != out.all.end())
      s.id = stem + "-" + std::to_string(++again);
    out.all.push_back(std::move(s));
  }
}

}  // namespace

Submissions submissions_of(cli::Invocation& call) {
  Submissions out;
  std::map<std::string, std::size_t> known;
  if (call.given("truth")) add_files(call, out);
  if (!call.given("truth"))
    for (std::size_t i = 0; i < call.document.reconstructions.size(); ++i) add_entry(call, i, out, known);
  return out;
}

}  // namespace gonio::tools::nrsfm_eval
