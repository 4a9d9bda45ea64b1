// What decides how well a solver does: the tables of Jensen et al. 2018, section 5, from any table of results.
//
// A result is one error (any unit) under one level of each factor: algorithm, path, camera, ... Factors are read by
// name, any number of them. Where one of them says whether tracks are missing, two models are fitted, as the paper
// does:
//   complete   results without missing tracks, of all algorithms; no term of the factor "missing"  (their equation 8)
//   missing    all results of those algorithms that have some with missing tracks                  (their equation 5)
// otherwise one. Marginal means are "mu + a_i" and "mu + a_i + s_k + as_ik" of sum-to-zero coefficients, which in
// unbalanced tables differ from plain averages.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "nrsfm/sequence.h"
#include "stats/anova.h"

namespace gonio::manifest {
struct Document;
}
namespace gonio::report {
class Page;
}

namespace gonio::nrsfm {

struct Result {
  Factors factors;
  double error = 0;   // NaN: a solver failed
  std::string block;  // results of one sequence move together in the bootstrap; empty: all factors but the algorithm
};
struct Results {
  std::string name;                  // of the file, for messages
  std::string measure, unit;         // "robust-rms", "mm"; may be empty
  std::vector<std::string> factors;  // in the order of the columns
  std::vector<Result> rows;
};
// A CSV: every column is a factor but `error` (empty: "error", else the last one) and "block". An empty error or "nan"
// is a result that failed; "error_mm" is "error" in mm. What nrsfm-eval --csv wrote is known by its columns: `error` is
// then "measure" or "measure/alignment", sequences are the blocks. `factors` chooses columns; empty: all. Error(data)
// at the line, Error(usage) for names.
Results read_results(const std::filesystem::path& file, const std::string& error = {},
                     const std::vector<std::string>& factors = {});
Results parse_results(const std::string& text, const std::string& name, const std::string& error = {},
                      const std::vector<std::string>& factors = {});
// The evaluations of a manifest: `measure` under `alignment` (empty: the first that the first evaluation has). Factors
// are the evaluations', and "algorithm"; "sequence" where they have none. Error(data) at the evaluation.
Results results_of(const manifest::Document& document, const std::string& measure = {},
                   const std::string& alignment = {});
// The evaluations' factors may be more than one wants in the model. Error(usage) at --factors for one that is not
// there.
void keep_factors(Results& results, const std::vector<std::string>& factors);
// Several tables of one experiment. Error(data) at the table whose factors, measure or unit are others.
Results joined(std::vector<Results> tables);

struct AnalysisOptions {
  // Terms: "main", "pairs" (main effects and all two-way interactions whose cells all have results), or names:
  // "algorithm + path + algorithm:path", "pairs - algorithm:camera", "algorithm*path".
  std::string model = "pairs";
  std::string algorithm = "algorithm";  // the factor that is ranked
  std::string missing = "missing";      // the factor that says whether tracks are missing, and its level for "no"
  std::string without = "without";
  stats::SumsOfSquares type = stats::SumsOfSquares::type3;
  stats::Covariance covariance = stats::Covariance::classical;
  double significance = 0.0005;  // as in the paper
  double confidence = 0.95;      // of the ranks' intervals
  int draws = 4000;
  std::uint64_t seed = 1;
};

struct MeansTable {
  stats::Term term;
  std::string formula;                     // "mu + algorithm + path + algorithm:path"
  std::vector<stats::MarginalMean> means;  // one factor: ascending; two: by the order of the first, then the second
};
struct Part {
  std::string id, title;  // "complete", "results without missing tracks"
  stats::Design design;
  std::vector<stats::Term> terms;
  stats::Anova anova;
  std::vector<MeansTable> tables;    // of every term
  std::vector<stats::Rank> ranks;    // by rank; empty where there is no factor of that name
  int ranked = -1;                   // its index in design.factors
  std::vector<Factors> empty_cells;  // of the full crossing
  std::size_t failed = 0;            // results without a number
  std::vector<std::string> notes;
};
struct Analysis {
  std::string measure, unit;
  AnalysisOptions options;
  std::vector<Part> parts;
};
// Error(data) at the results' name where nothing can be tested, Error(usage) at "--model" for terms that are not there.
Analysis analyse(const Results& results, const AnalysisOptions& options = {});

// The terms that `model` means for the design; interactions that were left out are told in `notes`. Terms of `absent`
// factors, which the part at hand does not vary, are passed over.
std::vector<stats::Term> model_terms(const stats::Design& design, const std::string& model,
                                     std::vector<std::string>& notes, const std::vector<std::string>& absent = {});

// File name -> content: "anova.csv", "means.csv", "ranks.csv", "empty-cells.csv", "tables.tex" (needs booktabs).
std::map<std::string, std::string> analysis_files(const Analysis& analysis);
std::string latex(const Analysis& analysis);  // tables as a whole document
// Drawings for add_analysis: SVG with the classes of the page's style.
std::string box_plot(const stats::Design& design, int factor, const std::string& axis);
std::string interaction_plot(const stats::Design& design, const MeansTable& table, const std::string& axis);
std::string p_text(const stats::TermRow& row);  // "5.5e-242", below what a double holds too
// The analysis as sections of a page: tables, box plots by factor, interaction plots, ranks.
void add_analysis(report::Page& page, const Analysis& analysis);

}  // namespace gonio::nrsfm
