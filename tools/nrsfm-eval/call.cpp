// See call.h.
#include "tools/nrsfm-eval/call.h"

#include <algorithm>
#include <set>

#include "base/atomic_file.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "base/text.h"
#include "nrsfm/evaluate/evaluate.h"
#include "nrsfm/evaluate/evaluation_entries.h"
#include "tools/nrsfm-eval/analysis.h"
#include "tools/nrsfm-eval/page.h"
#include "tools/nrsfm-eval/submissions.h"

namespace gonio::tools::nrsfm_eval {

using namespace gonio::nrsfm;

namespace {

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

// A line for each of one or two, one for all of many: from orthographic tracks, mirrored shapes are no surprise.
void say_flips(const Submissions& submissions, const std::vector<manifest::Evaluation>& entries) {
  std::size_t mirrored = 0, flipped = 0, orthographic = 0;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const manifest::Evaluation& e = entries[i];
    const Sequence& sequence = submissions.sequences[submissions.all[i].sequence];
    const bool whole = e.mirrored.value_or(false);
    mirrored += whole, flipped += !e.flips.empty();
    orthographic += whole && sequence.projection == Projection::orthographic;
    if (entries.size() <= 2 && whole) log(LogLevel::warning, e.id + ": the whole sequence is mirrored");
    if (entries.size() <= 2 && !e.flips.empty())
      log(LogLevel::warning,
          e.id + format(e.flips.size() == 1 ? ": %zu frame is flipped" : ": %zu frames are flipped", e.flips.size()));
  }
  if (entries.size() > 2 && mirrored + flipped > 0)
    log(LogLevel::warning,
        format("%zu of %zu reconstructions are mirrored, %zu of them from orthographic tracks, which "
               "do not tell; %zu have flipped frames: see \"flips\"",
               mirrored, entries.size(), orthographic, flipped));
}

// Every submission against its truth, into the manifest, the table and the page.
void evaluate_all(cli::Invocation& call, EvaluationPage& page) {
  const EvaluationOptions options = options_of(call);
  const Submissions submissions = submissions_of(call);
  std::vector<Evaluated> all(submissions.all.size());
  parallel_for(0, all.size(), [&](std::size_t i) {
    const Submission& s = submissions.all[i];
    all[i] = evaluated(s, submissions.sequences[s.sequence], options);
  });
  std::vector<manifest::Evaluation>& entries = page.evaluations;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Submission& s = submissions.all[i];
    entries.push_back(entry_of(s, submissions.sequences[s.sequence], all[i], options));
  }
  say_flips(submissions, entries);
  if (call.given("csv")) write_file(call.text("csv"), evaluations_csv(entries));
  if (call.given("html"))
    page.views =
        views_of(submissions, all, {.most = static_cast<std::size_t>(call.integer("views")), .centre = options.centre});
  enter(call, entries);
}

}  // namespace

Exit run(cli::Invocation& call) {
  EvaluationPage page;
  if (call.given("table"))
    call.writes_document = false;
  else
    evaluate_all(call, page);
  page.analysis = analysis_of(call);
  if (page.analysis) write_analysis(call, *page.analysis);
  if (call.given("html")) write_file(call.text("html"), evaluation_page(page));
  return Exit::done;
}

}  // namespace gonio::tools::nrsfm_eval
