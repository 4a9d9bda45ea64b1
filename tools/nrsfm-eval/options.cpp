// Options of nrsfm-eval, and what they need of each other. See call.h.
#include "base/atomic_file.h"
#include "cli/common_options.h"
#include "manifest/document.h"
#include "manifest/sections/evaluation.h"
#include "manifest/sections/reconstruction.h"
#include "manifest/sections/sequence.h"
#include "nrsfm/evaluate/alignment.h"
#include "nrsfm/evaluate/error_intervals.h"
#include "tools/nrsfm-eval/analysis.h"
#include "tools/nrsfm-eval/call.h"

namespace gonio::tools::nrsfm_eval {

using namespace gonio::nrsfm;

using cli::Type;

namespace {

std::vector<cli::Option> options_of_errors() {
  return {
      {.name = "truth",
       .type = Type::input_file,
       .help = "Sequence with the truth, .mat or .npz, that all RECONSTRUCTIONs are held against."},
      {.name = "measure",
       .type = Type::choice,
       .help = "What to measure; left out: robust-rms, e3d, nrmse, rms.",
       .choices = measure_names(),
       .repeat = true},
      {.name = "alignment",
       .type = Type::choice,
       .help =
           "What to lay onto the truth before; left out: none, global-similarity, frame-rotation, frame-similarity. "
           "The robust measures have the similarity that makes them least.",
       .choices = alignment_names(),
       .repeat = true},
      {.name = "frame",
       .type = Type::choice,
       .help = "Where RECONSTRUCTIONs stand: as their file says, one frame of reference, or each frame's camera.",
       .preset = "file",
       .choices = {"file", "object", "camera"},
       .needs = {"truth"}},
      {.name = "truth-variable", .type = Type::text, .help = "The truth's name in --truth.", .needs = {"truth"}},
      {.name = "shapes-variable",
       .type = Type::text,
       .help = "The shapes' name in RECONSTRUCTIONs.",
       .needs = {"truth"}},
      {.name = "algorithm", .type = Type::text, .help = "What made the RECONSTRUCTIONs.", .needs = {"truth"}},
      {.name = "unit",
       .type = Type::quantity,
       .help = "Length of the truth's unit, where its file does not say: 1mm.",
       .dimension = Dimension::length,
       .lower = 1e-12,
       .needs = {"truth"}},
      {.name = "draws",
       .type = Type::integer,
       .help = "Draws of the block bootstrap behind the intervals; 0: no intervals.",
       .preset = "200",
       .lower = 0,
       .upper = 100000},
      {.name = "confidence",
       .type = Type::number,
       .help = "Of the intervals.",
       .preset = "0.95",
       .lower = 0.5,
       .upper = 0.9999},
      {.name = "block",
       .type = Type::integer,
       .help = "Frames that are drawn together; left out: from how long errors are correlated.",
       .lower = 1,
       .upper = 1000000},
      {.name = "no-flips", .help = "Do not look for frames that are mirrored."},
      {.name = "centre",
       .help =
           "Centre every frame of both before the robust measures: orthographic tracks do not tell how deep a shape "
           "stands."},
      {.name = "no-reflection", .help = "The robust measures' similarity may not be a reflection."},
      cli::report_option(),
      {.name = "views",
       .type = Type::integer,
       .help = "Reconstructions that the page shows in space; each adds some 100 kB.",
       .preset = "6",
       .lower = 0,
       .upper = 100,
       .needs = {"html"}},
      {.name = "csv", .type = Type::output_file, .help = "Write the errors as a table, one row for each."},
  };
}

// The manifest's files are there, and whole.
void check_files(const manifest::Document& document) {
  for (std::size_t i = 0; i < document.reconstructions.size(); ++i) {
    const manifest::ShapeReconstruction& r = document.reconstructions[i];
    const std::string pointer = "/reconstructions/" + std::to_string(i);
    if (r.folder.empty()) manifest::resolve(document, r.file, pointer + "/file");
    const auto sequence = document.sequences.find(r.sequence);
    if (sequence != document.sequences.end())
      manifest::resolve(document, sequence->second.file, "/sequences/" + r.sequence + "/file");
  }
}

}  // namespace

std::vector<cli::Option> options() {
  std::vector<cli::Option> all = options_of_errors();
  for (cli::Option& o : analysis_options()) all.push_back(std::move(o));
  return all;
}

void check(cli::Invocation& call) {
  const bool files = !call.texts("RECONSTRUCTION").empty();
  if (call.given("truth") && !files)
    throw Error(Exit::usage, "RECONSTRUCTION", "is missing", "name what is to be held against " + call.text("truth"));
  if (call.given("table") && (files || call.has_document))
    throw Error(Exit::usage, "--table", "stands alone: nothing is evaluated beside it",
                "evaluate with --csv first, and name that table, too");
  if (!call.given("truth") && files)
    throw Error(Exit::usage, "--truth", "is missing", "name the sequence with the truth");
  const bool given = call.given("truth") || call.given("table") || !call.document.reconstructions.empty();
  if (!given && !(call.flag("analyse") && !call.document.evaluations.empty()))
    throw Error(call.has_document ? Exit::data : Exit::usage,
                call.has_document ? manifest::place(call.document, "/reconstructions") : "nrsfm-eval",
                "has no reconstruction", "give a manifest with some, or --truth SEQUENCE RECONSTRUCTION...");
  check_analysis(call);
  if (call.flag("check")) check_files(call.document);
  for (const char* file : {"csv", "html"})
    if (call.given(file)) check_writable(call.text(file));
}

}  // namespace gonio::tools::nrsfm_eval
