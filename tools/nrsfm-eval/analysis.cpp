// See analysis.h.
#include "tools/nrsfm-eval/analysis.h"

#include <algorithm>
#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/text.h"

namespace gonio::tools::nrsfm_eval {

using namespace gonio::nrsfm;

namespace {

using cli::Type;

const std::vector<std::string>& covariance_names() {  // in the enum's order
  static const std::vector<std::string> names = {"classical", "hc0", "hc1", "hc2", "hc3"};
  return names;
}

std::vector<std::string> separated(const std::string& text) {
  std::vector<std::string> out;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t end = std::min(text.find(',', from), text.size());
    if (end > from) out.push_back(text.substr(from, end - from));
    from = end + 1;
  }
  return out;
}

Results asked_for(cli::Invocation& call) {
  const std::string error = call.given("error") ? call.text("error") : "";
  const std::vector<std::string> factors =
      call.given("factors") ? separated(call.text("factors")) : std::vector<std::string>{};
  if (call.given("table")) {
    std::vector<Results> tables;
    for (const std::string& file : call.texts("table")) {
      call.note_input(file);
      tables.push_back(read_results(file, error, factors));
    }
    return joined(std::move(tables));
  }
  const std::size_t slash = std::min(error.find('/'), error.size());
  Results results =
      results_of(call.document, error.substr(0, slash), slash < error.size() ? error.substr(slash + 1) : "");
  keep_factors(results, factors);
  return results;
}

// Fractions of a metre as millimetres.
Results readable(Results results) {
  const bool small = std::ranges::none_of(results.rows, [](const Result& r) { return std::abs(r.error) >= 1; });
  if (results.unit != "m" || !small) return results;
  results.unit = "mm";
  for (Result& r : results.rows) r.error *= 1000;
  return results;
}

AnalysisOptions options_of(const cli::Invocation& call) {
  AnalysisOptions o;
  o.model = call.text("model");
  o.algorithm = call.text("rank"), o.missing = call.text("missing"), o.without = call.text("without");
  o.type = static_cast<stats::SumsOfSquares>(std::stoi(call.text("sums")) - 1);
  o.covariance = static_cast<stats::Covariance>(std::ranges::find(covariance_names(), call.text("covariance")) -
                                                covariance_names().begin());
  o.significance = call.number("significance"), o.confidence = call.number("confidence");
  o.draws = static_cast<int>(call.integer("rank-draws"));
  o.seed = call.seed;
  return o;
}

}  // namespace

bool analysis_asked(const cli::Invocation& call) {
  return call.given("table") || call.flag("analyse");
}

void check_analysis(const cli::Invocation& call) {
  if (!analysis_asked(call)) {
    for (const cli::Option& o : analysis_options())
      if (o.type != Type::flag && call.given(o.name))
        throw Error(Exit::usage, "--" + o.name, "belongs to an analysis", "give --table FILE or --analyse");
    return;
  }
  if (call.out.empty() && !call.given("html"))
    throw Error(Exit::usage, call.given("table") ? "--table" : "--analyse", "has no place to write to",
                "give --out FOLDER, --html FILE, or both");
}

std::vector<cli::Option> analysis_options() {
  return {
      {.name = "table",
       .type = Type::input_file,
       .help = "Analyse this table of results (CSV, a column for each factor and one for the error; or what --csv "
               "wrote) instead of evaluating; several are one.",
       .repeat = true,
       .conflicts = {"truth", "csv"}},
      {.name = "analyse",
       .help = "Analyse the manifest's evaluations, those that were just made among them.",
       .conflicts = {"table", "truth"}},
      {.name = "error",
       .type = Type::text,
       .help = "Which error is analysed: a column of --table, or measure/alignment: e3d/frame-rotation. Left out: the "
               "first.",
       .metavar = "NAME"},
      {.name = "factors",
       .type = Type::text,
       .help = "Factors that count, with commas between; left out: all.",
       .metavar = "NAME,..."},
      {.name = "model",
       .type = Type::text,
       .help =
           "Terms: \"main\", \"pairs\" (main effects and all two-way interactions that have results everywhere), or "
           "names: \"algorithm + path + algorithm:path\", \"pairs - algorithm:camera\".",
       .metavar = "TERMS",
       .preset = "pairs"},
      {.name = "sums",
       .type = Type::choice,
       .help = "Type of the sums of squares.",
       .preset = "3",
       .choices = {"1", "2", "3"}},
      {.name = "covariance",
       .type = Type::choice,
       .help = "Of the tests: equal error variance, or robust against unequal ones (Wald tests).",
       .preset = "classical",
       .choices = covariance_names()},
      {.name = "significance",
       .type = Type::number,
       .help = "Terms with a p below are marked.",
       .preset = "0.0005",
       .lower = 1e-300,
       .upper = 0.5},
      {.name = "rank",
       .type = Type::text,
       .help = "Factor whose levels are ranked.",
       .metavar = "FACTOR",
       .preset = "algorithm"},
      {.name = "missing",
       .type = Type::text,
       .help =
           "Factor that says whether tracks are missing: the complete ones are analysed for all algorithms, then all "
           "for those that take both.",
       .metavar = "FACTOR",
       .preset = "missing"},
      {.name = "without",
       .type = Type::text,
       .help = "Its level where nothing is missing.",
       .metavar = "LEVEL",
       .preset = "without"},
      {.name = "rank-draws",
       .type = Type::integer,
       .help = "Draws of the bootstrap behind the ranks' intervals.",
       .preset = "4000",
       .lower = 100,
       .upper = 1000000},
  };
}

std::optional<Analysis> analysis_of(cli::Invocation& call) {
  if (!analysis_asked(call)) return {};
  return analyse(readable(asked_for(call)), options_of(call));
}

void write_analysis(const cli::Invocation& call, const Analysis& analysis) {
  if (call.out.empty()) return;
  for (const auto& [name, text] : analysis_files(analysis)) write_file(call.output_path(name), text);
}

}  // namespace gonio::tools::nrsfm_eval
