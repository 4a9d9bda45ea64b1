// See eval_call.h.
#include "nrsfm/eval_call.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/atomic_file.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "base/text.h"

namespace gonio::nrsfm {
namespace {

using cli::Type;

Measure measure_named(const std::string& name) {
  return static_cast<Measure>(std::ranges::find(measure_names(), name) - measure_names().begin());
}
Alignment alignment_named(const std::string& name) {
  return static_cast<Alignment>(std::ranges::find(alignment_names(), name) - alignment_names().begin());
}

EvaluationOptions options_of(const cli::Invocation& call) {
  EvaluationOptions o;
  if (call.given("measure")) {
    o.measures.clear();
    for (const std::string& name : call.texts("measure"))
      if (std::ranges::find(o.measures, measure_named(name)) == o.measures.end())
        o.measures.push_back(measure_named(name));
  }
  if (call.given("alignment")) {
    o.alignments.clear();
    for (const std::string& name : call.texts("alignment"))
      if (std::ranges::find(o.alignments, alignment_named(name)) == o.alignments.end())
        o.alignments.push_back(alignment_named(name));
  }
  o.flips = !call.flag("no-flips");
  o.reflection = !call.flag("no-reflection"), o.centre = call.flag("centre");
  if (call.integer("draws") == 0) o.intervals.reset();
  if (o.intervals)
    o.intervals = IntervalOptions{.draws = static_cast<int>(call.integer("draws")),
                                  .block = call.given("block") ? call.integer("block") : 0,
                                  .confidence = call.number("confidence"),
                                  .seed = call.seed};
  return o;
}

// Value in the truth's unit to metres, where its length is known.
struct Scale {
  double factor = 1;
  std::string unit;
};
Scale scale_of(Measure measure, double unit_m) {
  if (measure == Measure::e3d || measure == Measure::nrmse) return {1, "1"};
  const bool root = measure == Measure::robust_printed;
  if (!(unit_m > 0)) return {1, root ? "root of the truth's" : "of the truth"};
  return {root ? std::sqrt(unit_m) : unit_m, root ? "sqrt(m)" : "m"};
}

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

// Earlier evaluations of the same reconstructions give way.
void enter(cli::Invocation& call, std::vector<manifest::Evaluation> entries) {
  std::set<std::string> ids;
  for (const manifest::Evaluation& e : entries) ids.insert(e.id);
  std::erase_if(call.document.evaluations, [&ids](const manifest::Evaluation& e) { return ids.contains(e.id); });
  for (manifest::Evaluation& e : entries) call.document.evaluations.push_back(std::move(e));
}

// With the place of the submission before what is wrong with it.
Evaluated evaluated(const Submission& s, const Sequence& sequence, const EvaluationOptions& options) {
  try {
    return evaluate(sequence, s.reconstruction, options);
  } catch (const Error& error) {
    throw Error(error.code(), s.id + " of " + sequence.name, error.place() + " " + error.problem(), error.remedy());
  }
}

}  // namespace

std::vector<cli::Option> eval_options() {
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
      {.name = "truth-variable",
       .type = Type::text,
       .help = "The truth's name in --truth.",

       .needs = {"truth"}},
      {.name = "shapes-variable",
       .type = Type::text,
       .help = "The shapes' name in RECONSTRUCTIONs.",

       .needs = {"truth"}},
      {.name = "algorithm",
       .type = Type::text,
       .help = "What made the RECONSTRUCTIONs.",

       .needs = {"truth"}},
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
      {.name = "csv", .type = Type::output_file, .help = "Write the errors as a table, one row for each."},
  };
}

void check_eval(cli::Invocation& call) {
  const bool files = !call.texts("RECONSTRUCTION").empty();
  if (call.given("truth") && !files)
    throw Error(Exit::usage, "RECONSTRUCTION", "is missing", "name what is to be held against " + call.text("truth"));
  if (!call.given("truth") && files)
    throw Error(Exit::usage, "--truth", "is missing", "name the sequence with the truth");
  if (!call.given("truth") && call.document.reconstructions.empty())
    throw Error(Exit::usage, call.has_document ? manifest::place(call.document, "/reconstructions") : "nrsfm-eval",
                "has no reconstruction", "give a manifest with some, or --truth SEQUENCE RECONSTRUCTION...");
  if (call.given("csv")) check_writable(call.text("csv"));
}

manifest::Evaluation entry_of(const Submission& submission, const Sequence& sequence, const Evaluated& e,
                              const EvaluationOptions& options) {
  manifest::Evaluation out;
  out.id = submission.id, out.sequence = sequence.name, out.algorithm = submission.reconstruction.name;
  out.factors = sequence.factors;
  for (const auto& [factor, level] : submission.reconstruction.factors) out.factors[factor] = level;
  for (const MeasuredError& error : e.errors) {
    const Scale scale = scale_of(error.measure, sequence.unit_m);
    manifest::EvaluatedError entry{measure_names()[static_cast<std::size_t>(error.measure)],
                                   error.alignment,
                                   scale.unit,
                                   scale.factor * error.value,
                                   {},
                                   {}};
    if (error.interval && std::isfinite(error.interval->upper))
      entry.lower = scale.factor * error.interval->lower, entry.upper = scale.factor * error.interval->upper;
    out.errors.push_back(std::move(entry));
  }
  if (options.intervals) out.confidence = options.intervals->confidence;
  if (options.intervals && e.block > 0) out.block = static_cast<double>(e.block);
  out.whisker = e.robust.whisker, out.truncated = e.robust.truncated, out.estimated_share = e.robust.estimated;
  out.scale = e.robust.alignment.scale;
  out.mirrored = options.flips ? e.flips.whole_sequence_mirrored : e.robust.alignment.mirrored();
  out.converged = e.robust.converged;
  for (const Flip& flip : e.flips.frames)
    out.flips.push_back(
        {flip.frame, flip.kind == FlipKind::mirror ? "mirror" : "depth-reversal", flip.error_before, flip.error_after});
  out.notes = submission.notes;
  out.notes.insert(out.notes.end(), e.notes.begin(), e.notes.end());
  return out;
}

std::string evaluations_csv(const std::vector<manifest::Evaluation>& evaluations) {
  std::set<std::string> factors;
  for (const manifest::Evaluation& e : evaluations)
    for (const auto& [factor, level] : e.factors)
      if (factor != "algorithm") factors.insert(factor);
  std::string csv = "id,sequence,algorithm";
  for (const std::string& factor : factors) csv += "," + quoted(factor);
  csv += ",measure,alignment,value,lower,upper,unit,truncated,estimated_share,mirrored,flips\n";
  const auto number = [](const std::optional<double>& v) { return v ? shortest_text(*v) : std::string(); };
  for (const manifest::Evaluation& e : evaluations) {
    std::string head = quoted(e.id) + "," + quoted(e.sequence) + "," + quoted(e.algorithm);
    for (const std::string& factor : factors)
      head += "," + (e.factors.contains(factor) ? quoted(e.factors.at(factor)) : std::string());
    for (const manifest::EvaluatedError& error : e.errors)
      csv += head + "," + error.measure + "," + error.alignment + "," + shortest_text(error.value) + "," +
             number(error.lower) + "," + number(error.upper) + "," + quoted(error.unit) + "," + number(e.truncated) +
             "," + number(e.estimated_share) + "," + (e.mirrored.value_or(false) ? "1" : "0") + "," +
             std::to_string(e.flips.size()) + "\n";
  }
  return csv;
}

Exit run_eval(cli::Invocation& call) {
  const EvaluationOptions options = options_of(call);
  const Submissions submissions = submissions_of(call);
  std::vector<manifest::Evaluation> entries(submissions.all.size());
  parallel_for(0, entries.size(), [&](std::size_t i) {
    const Submission& s = submissions.all[i];
    const Sequence& sequence = submissions.sequences[s.sequence];
    entries[i] = entry_of(s, sequence, evaluated(s, sequence, options), options);
  });
  for (const manifest::Evaluation& e : entries)
    if (e.mirrored.value_or(false) || !e.flips.empty()) log(LogLevel::warning, e.id + ": " + e.notes.back());
  if (call.given("csv")) write_file(call.text("csv"), evaluations_csv(entries));
  enter(call, std::move(entries));
  return Exit::done;
}

}  // namespace gonio::nrsfm
