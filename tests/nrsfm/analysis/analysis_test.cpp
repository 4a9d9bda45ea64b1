// From tables of results to tests, means, ranks, files and a page. Truth is made with known effects; fixed seeds, the
// false-alarm rate stands beside each statistical claim.
#include "nrsfm/evaluate/analysis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "base/error.h"
#include "base/random.h"
#include "base/text.h"
#include "io/csv.h"
#include "manifest/document.h"
#include "manifest/sections/evaluation.h"
#include "report/page.h"

namespace gonio::nrsfm {
namespace {

using testing::HasSubstr;

const std::vector<std::string> algorithms = {"csf", "ksta", "multibody", "pta", "spfm", "rigid"};
const std::vector<std::string> shapes = {"articulated", "bending", "deflation", "stretching", "tearing"};
const std::vector<std::string> paths = {"circle", "flyby", "half-circle", "line", "tricky", "zigzag"};

double merit(std::size_t algorithm, std::size_t shape, std::size_t path, bool missing) {
  return 30 + 6 * double(algorithm) + 3 * double(shape == 0) + 2 * double(path == 4) + 1.5 * double(algorithm * shape) +
         (missing ? 5 + 6 * double(path == 4) + 3 * double(algorithm == 0) : 0);
}

// Every algorithm on every sequence, but for multibody, which knows one camera; two take missing tracks.
std::string table(std::uint64_t seed, double noise) {
  std::string csv = "algorithm,camera,deformation,path,missing,error_mm\n";
  Random random(seed);
  for (std::size_t a = 0; a < algorithms.size(); ++a)
    for (const char* camera : {"orthographic", "perspective"})
      for (std::size_t s = 0; s < shapes.size(); ++s)
        for (std::size_t p = 0; p < paths.size(); ++p)
          for (const bool missing : {false, true}) {
            if (a == 2 && camera[0] == 'p') continue;
            if (missing && a > 1) continue;
            csv += algorithms[a] + "," + camera + "," + shapes[s] + "," + paths[p] + "," +
                   (missing ? "with" : "without") + "," +
                   shortest_text(merit(a, s, p, missing) + (camera[0] == 'p' ? 4 : 0) + noise * random.normal()) + "\n";
          }
  return csv;
}

std::vector<std::string> names(const Part& part) {
  std::vector<std::string> list;
  for (const stats::Term& t : part.terms) list.push_back(stats::term_name(part.design, t));
  return list;
}
const MeansTable& means_of(const Part& part, const std::string& name) {
  for (const MeansTable& t : part.tables)
    if (stats::term_name(part.design, t.term) == name) return t;
  throw std::runtime_error(name);
}

TEST(Analysis, TwoModelsAsThePaperHasThem) {
  const Analysis analysis = analyse(parse_results(table(1, 2), "results.csv"));
  ASSERT_EQ(analysis.parts.size(), 2u);
  EXPECT_EQ(analysis.measure, "error");
  EXPECT_EQ(analysis.unit, "mm");
  const Part &complete = analysis.parts[0], &both = analysis.parts[1];
  // Their equation 8: no algorithm:camera, since one algorithm has one camera; nothing of "missing".
  EXPECT_THAT(names(complete),
              testing::ElementsAre("algorithm", "camera", "deformation", "path", "algorithm:deformation",
                                   "algorithm:path", "camera:deformation", "camera:path", "deformation:path"));
  EXPECT_THAT(complete.notes, testing::Contains(HasSubstr("algorithm:camera is left out of the model: 1 of its")));
  EXPECT_EQ(complete.empty_cells.size(), 30u);
  for (const Factors& cell : complete.empty_cells) {
    EXPECT_EQ(cell.at("algorithm"), "multibody");
    EXPECT_EQ(cell.at("camera"), "perspective");
  }
  EXPECT_FALSE(complete.anova.balanced);
  std::vector<int> degrees;
  for (const stats::TermRow& r : complete.anova.rows) degrees.push_back(r.degrees);
  EXPECT_THAT(degrees, testing::ElementsAre(5, 1, 4, 5, 20, 25, 4, 5, 20));
  EXPECT_EQ(complete.anova.total_degrees, 329);
  // Their equation 5, of the algorithms that take missing tracks.
  EXPECT_EQ(both.design.factors[0].levels, (std::vector<std::string>{"csf", "ksta"}));
  EXPECT_EQ(both.terms.size(), 15u);
  EXPECT_TRUE(both.anova.balanced);
  EXPECT_TRUE(both.empty_cells.empty());
}

// Means of pairs, 30 of their own 6 to 12 results each: chi-square between its 0.0005 quantiles on either side, 11 to
// 61 (they share the other factors' effects, which adds little). Of single factors: within 4 sigma each, 17 x 6e-5.
TEST(Analysis, MeansAreTheTruthWithinTheirSigma) {
  const Analysis analysis = analyse(parse_results(table(2, 2), "results.csv"));
  const Part& part = analysis.parts[0];
  const auto truth = [&](const std::string& a, const std::string& s, const std::string& p) {
    double sum = 0;
    int n = 0;
    for (std::size_t i = 0; i < algorithms.size(); ++i)
      for (std::size_t k = 0; k < shapes.size(); ++k)
        for (std::size_t l = 0; l < paths.size(); ++l)
          if ((a.empty() || a == algorithms[i]) && (s.empty() || s == shapes[k]) && (p.empty() || p == paths[l]))
            sum += merit(i, k, l, false) + 2, ++n;
    return sum / n;
  };
  const auto level = [&](int factor, const stats::MarginalMean& m, std::size_t i) {
    return part.design.factors[std::size_t(factor)].levels[std::size_t(m.levels[i])];
  };
  double chi2 = 0;
  for (const auto& m : means_of(part, "algorithm:deformation").means)
    chi2 += std::pow((m.value - truth(level(0, m, 0), level(2, m, 1), "")) / m.sigma, 2);
  for (const auto& m : means_of(part, "algorithm").means)
    EXPECT_NEAR(m.value, truth(level(0, m, 0), "", ""), 4 * m.sigma);
  for (const auto& m : means_of(part, "deformation").means)
    EXPECT_NEAR(m.value, truth("", level(2, m, 0), ""), 4 * m.sigma);
  for (const auto& m : means_of(part, "path").means) EXPECT_NEAR(m.value, truth("", "", level(3, m, 0)), 4 * m.sigma);
  EXPECT_GT(chi2, 10.8);
  EXPECT_LT(chi2, 62.1);
  const auto& sorted = means_of(part, "algorithm").means;
  EXPECT_TRUE(std::is_sorted(sorted.begin(), sorted.end(), [](auto& a, auto& b) { return a.value < b.value; }));
  EXPECT_EQ(means_of(part, "algorithm:deformation").formula, "mu + algorithm + deformation + algorithm:deformation");
  // Two sigma per step of the algorithm and effects of 25 sigma: ranks are certain, and p is tiny.
  ASSERT_EQ(part.ranks.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(part.design.factors[0].levels[std::size_t(part.ranks[i].level)], algorithms[i]);
    EXPECT_EQ(part.ranks[i].lower, double(i + 1));
    EXPECT_EQ(part.ranks[i].upper, double(i + 1));
  }
  EXPECT_LT(part.anova.rows[0].log10_p, -60);
}

// An algorithm that was only run where it is easy does not look better for it.
TEST(Analysis, EasySequencesDoNotFlatterAnAlgorithm) {
  Results results = parse_results(table(3, 0.5), "results.csv");
  std::erase_if(results.rows, [](const Result& r) {
    return r.factors.at("missing") == "with" ||
           (r.factors.at("algorithm") == "pta" && r.factors.at("path") == "tricky");
  });
  AnalysisOptions options;
  options.model = "algorithm + camera + deformation + path + algorithm:deformation";
  const Analysis analysis = analyse(results, options);
  ASSERT_EQ(analysis.parts.size(), 1u);
  EXPECT_THAT(analysis.parts[0].notes, testing::Contains("missing is \"without\" everywhere: not a factor here"));
  for (const auto& m : means_of(analysis.parts[0], "algorithm").means)
    if (analysis.parts[0].design.factors[0].levels[std::size_t(m.levels[0])] == "pta") {
      EXPECT_NEAR(m.value, 30 + 6 * 3 + 0.6 + 2 / 6.0 + 1.5 * 3 * 2 + 2, 4.5 * m.sigma);
      EXPECT_LT(m.sigma, 0.1);  // the average of what it has is 0.33 lower
      EXPECT_EQ(m.observations, 50);
    }
}

TEST(Analysis, ModelsInWords) {
  const Analysis all = analyse(parse_results(table(1, 2), "results.csv"));
  const stats::Design& design = all.parts[1].design;
  std::vector<std::string> notes;
  const auto words = [&](const std::string& model, const std::vector<std::string>& absent = {}) {
    std::string text;
    for (const stats::Term& t : model_terms(design, model, notes, absent)) text += stats::term_name(design, t) + " ";
    return text;
  };
  EXPECT_EQ(words("main"), "algorithm camera deformation path missing ");
  EXPECT_EQ(words("path*algorithm"), "algorithm path algorithm:path ");
  EXPECT_EQ(words("path:algorithm + algorithm + path"), "algorithm path algorithm:path ");
  EXPECT_EQ(words("main - camera"), "algorithm deformation path missing ");
  EXPECT_EQ(words("algorithm*path*missing - algorithm:path:missing"),
            "algorithm path missing algorithm:path algorithm:missing path:missing ");
  EXPECT_EQ(words("algorithm + light + algorithm:light", {"light"}), "algorithm ");
  EXPECT_EQ(model_terms(design, "pairs", notes).size(), 15u);
  EXPECT_EQ(model_terms(design, "pairs - algorithm:camera", notes).size(), 14u);
  for (const char* wrong : {"algorithm + light", "algorithm + ", ""}) EXPECT_THROW(words(wrong), Error);
  try {
    words("algorithm + light");
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::usage);
    EXPECT_STREQ(e.what(),
                 "--model: there is no factor \"light\"; factors are algorithm, camera, deformation, path, missing");
  }
}

template <class Call>
std::string refusal(Exit code, const Call& call) {
  try {
    call();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), code) << e.what();
    return e.what();
  }
  return "nothing refused";
}

TEST(Analysis, TablesOfResultsAreReadAndRefused) {
  const Results r = parse_results(
      "# of a run\nalgorithm,block,e3d,path\npta,s1,0.5,line\ncsf,s1,nan,line\ncsf,s2,,zigzag\n", "r.csv", "e3d");
  EXPECT_EQ(r.factors, (std::vector<std::string>{"algorithm", "path"}));
  EXPECT_EQ(r.rows[0].block, "s1");
  EXPECT_EQ(r.rows[0].error, 0.5);
  EXPECT_TRUE(std::isnan(r.rows[1].error) && std::isnan(r.rows[2].error));
  const auto parse = [](const char* text, const char* error, std::vector<std::string> factors) {
    return [=] { parse_results(text, "r.csv", error, factors); };
  };
  EXPECT_THAT(refusal(Exit::data, parse("a,error\nx,1\n,2\n", "", {})), HasSubstr("r.csv:3: factor \"a\" is empty"));
  EXPECT_THAT(refusal(Exit::data, parse("a,error\nx,1\ny,two\n", "", {})), HasSubstr("r.csv:3"));
  EXPECT_THAT(refusal(Exit::data, parse("error\n1\n", "", {})), HasSubstr("no column is left for a factor"));
  EXPECT_THAT(refusal(Exit::usage, parse("a,error\nx,1\n", "rms", {})),
              HasSubstr("--error: r.csv has no column \"rms\"; it has \"a\", \"error\""));
  EXPECT_THAT(refusal(Exit::usage, parse("a,error\nx,1\n", "", {"b"})), HasSubstr("--factors"));
  const auto run = [](const std::string& text, const AnalysisOptions& options = {}) {
    return [=] { analyse(parse_results(text, "r.csv"), options); };
  };
  EXPECT_THAT(refusal(Exit::data, run("a,error\nx,1\nx,2\n")),
              HasSubstr("r.csv: all results: no factor has two levels"));
  EXPECT_THAT(refusal(Exit::data, run("a,error\nx,1\ny,2\n")), HasSubstr("2 observations for 2 coefficients"));
  EXPECT_THAT(refusal(Exit::data, run("a,error\nx,1\ny,1\nx,1\n")), HasSubstr("all observations are the same"));
  EXPECT_THAT(refusal(Exit::usage, run("a,missing,error\nx,no,1\ny,yes,1\n")),
              HasSubstr("factor \"missing\" has no level \"without\"; its levels are \"no\" and \"yes\""));
}

TEST(Analysis, TablesOfNrsfmEvalAreKnown) {
  const std::string csv =
      "id,sequence,algorithm,path,measure,alignment,value,lower,upper,unit,flips\n"
      "s1-pta,s1,pta,line,e3d,none,0.5,,,1,0\ns1-pta,s1,pta,line,rmse,none,7,6,8,mm,0\n"
      "s1-pta,s1,pta,line,rmse,frame-rotation,5,4,6,mm,0\ns2-csf,s2,csf,zigzag,rmse,none,9,8,9,mm,0\n";
  Results r = parse_results(csv, "r.csv", "rmse");
  ASSERT_EQ(r.rows.size(), 2u);  // under the first row's alignment
  EXPECT_EQ(r.factors, (std::vector<std::string>{"algorithm", "path"}));
  EXPECT_EQ(r.rows[1].error, 9);
  EXPECT_EQ(r.rows[1].block, "s2");
  EXPECT_EQ(r.measure, "rmse");
  EXPECT_EQ(r.unit, "mm");
  EXPECT_EQ(parse_results(csv, "r.csv", "rmse/frame-rotation").rows.at(0).error, 5);
  EXPECT_EQ(parse_results(csv, "r.csv").measure, "e3d");
  EXPECT_THAT(refusal(Exit::usage, [&] { parse_results(csv, "r.csv", "nrmse"); }), HasSubstr("no row of \"nrmse\""));
  const Results plain = parse_results(
      "id,sequence,algorithm,measure,alignment,value\nx,s1,pta,e3d,none,1\ny,s2,pta,e3d,none,2\n", "r.csv");
  EXPECT_EQ(plain.factors, (std::vector<std::string>{"algorithm", "sequence"}));
}

TEST(Analysis, FailuresAreLeftOutAndCounted) {
  const Analysis analysis = analyse(parse_results(
      "algorithm,path,error\npta,line,1\npta,zigzag,2\ncsf,line,3\ncsf,zigzag,4.5\ncsf,circle,nan\npta,circle,2.5\n"
      "pta,line,1.2\n",
      "r.csv"));
  EXPECT_EQ(analysis.parts[0].failed, 1u);
  EXPECT_THAT(analysis.parts[0].notes, testing::Contains("1 of 7 results are failures"));
  ASSERT_EQ(analysis.parts[0].empty_cells.size(), 1u);
  EXPECT_EQ(analysis.parts[0].empty_cells[0], (Factors{{"algorithm", "csf"}, {"path", "circle"}}));
}

TEST(Analysis, EvaluationsOfAManifest) {
  manifest::Document document;
  document.name = "all.json";
  EXPECT_THAT(refusal(Exit::data, [&] { results_of(document); }), HasSubstr("all.json#/evaluations: there are none"));
  for (const char* algorithm : {"pta", "csf"})
    for (const char* sequence : {"yoga", "walk", "shark"}) {
      manifest::Evaluation e;
      e.id = std::string(sequence) + "-" + algorithm;
      e.sequence = sequence;
      e.algorithm = algorithm;
      e.errors = {{"e3d", "frame-rotation", "1", 0.1}, {"rmse", "frame-rotation", "mm", double(e.id.size())}};
      document.evaluations.push_back(e);
    }
  const Results results = results_of(document, "rmse", "frame-rotation");
  EXPECT_EQ(results.factors, (std::vector<std::string>{"algorithm", "sequence"}));
  EXPECT_EQ(results.unit, "mm");
  EXPECT_EQ(results.rows[2].error, 9);
  EXPECT_EQ(results.rows[2].block, "shark");
  EXPECT_EQ(results_of(document).measure, "e3d");
  for (auto& e : document.evaluations) e.factors = {{"path", "line"}};
  document.evaluations[4].factors.clear();
  EXPECT_THAT(refusal(Exit::data, [&] { results_of(document); }),
              HasSubstr("all.json#/evaluations/4: it has no level"));
  EXPECT_THAT(refusal(Exit::data, [&] { results_of(document, "nrmse"); }), HasSubstr("/evaluations"));
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t i = text.find(what); i != std::string::npos; i = text.find(what, i + what.size())) ++n;
  return n;
}

// What LaTeX insists on: groups and environments close, every row of a table has as many cells as columns, nothing that
// is special stands bare.
void expect_latex(const std::string& tex) {
  int depth = 0;
  for (std::size_t i = 0; i < tex.size(); ++i) {
    const bool escaped = i > 0 && tex[i - 1] == '\\';
    if (tex[i] == '{' && !escaped) ++depth;
    if (tex[i] == '}' && !escaped) --depth;
    ASSERT_GE(depth, 0);
    if (!escaped) {
      EXPECT_EQ(std::string("%#").find(tex[i]), std::string::npos) << tex.substr(i, 30);
    }
  }
  EXPECT_EQ(depth, 0);
  for (const char* e : {"document", "table", "tabular"})
    EXPECT_EQ(count(tex, std::string("\\begin{") + e + "}"), count(tex, std::string("\\end{") + e + "}"));
  std::istringstream lines(tex);
  std::size_t columns = 0, rows = 0;
  for (std::string line; std::getline(lines, line);) {
    EXPECT_EQ(count(line, "$") % 2, 0u) << line;
    if (const auto at = line.find("\\begin{tabular}{"); at != std::string::npos)
      columns = line.find('}', at + 16) - at - 16;
    if (!line.ends_with("\\\\")) continue;
    EXPECT_EQ(count(line, "&") - count(line, "\\&") + 1, columns) << line;
    ++rows;
  }
  EXPECT_GT(rows, 50u);
}

TEST(Analysis, FilesAndPage) {
  std::string csv = table(4, 2);
  for (std::size_t i = csv.find("multibody"); i != std::string::npos; i = csv.find("multibody"))
    csv.replace(i, 9, "m_b & 50%");
  const Analysis analysis = analyse(parse_results(csv, "results.csv"));
  const auto files = analysis_files(analysis);
  expect_latex(files.at("tables.tex"));
  EXPECT_THAT(files.at("tables.tex"), HasSubstr("m\\_b \\& 50\\%"));
  const io::Csv anova = io::parse_csv(files.at("anova.csv"), "anova.csv");
  EXPECT_EQ(anova.rows.size(), 9u + 15u + 4u);
  EXPECT_EQ(anova.rows[0][1], "algorithm");
  EXPECT_EQ(io::csv_number(anova.rows[0][5], "F"), analysis.parts[0].anova.rows[0].f);
  const io::Csv means = io::parse_csv(files.at("means.csv"), "means.csv");
  std::size_t expected = 0;
  for (const Part& p : analysis.parts)
    for (const MeansTable& t : p.tables) expected += t.means.size();
  EXPECT_EQ(means.rows.size(), expected);
  EXPECT_EQ(io::parse_csv(files.at("ranks.csv"), "ranks.csv").rows.size(), 6u + 2u);
  EXPECT_EQ(io::parse_csv(files.at("empty-cells.csv"), "empty-cells.csv").rows.size(), 30u);
  report::Page page("analysis", "headline", "lead");
  add_analysis(page, analysis);
  const std::string html = page.html();
  EXPECT_THAT(html, HasSubstr("m_b &amp; 50%"));
  EXPECT_THAT(html, HasSubstr("30 combinations without a result"));
  EXPECT_EQ(count(html, "<svg"), count(html, "</svg>"));
  EXPECT_EQ(count(html, "nan"), 0u);
  // A box for each level, in the order of medians.
  const std::string boxes = box_plot(analysis.parts[0].design, 0, "error / mm");
  EXPECT_EQ(count(boxes, "class=\"band"), 6u);
  EXPECT_LT(boxes.find(">csf<"), boxes.find(">rigid<"));
  EXPECT_EQ(count(interaction_plot(analysis.parts[0].design, analysis.parts[0].tables[4], "mm"), "class=\"line"), 10u);
}

TEST(Analysis, TinyPAreWritten) {
  stats::TermRow row;
  row.log10_p = -410.3;
  row.p = 0;
  EXPECT_EQ(p_text(row), "5.0e-411");
  row.log10_p = std::log10(0.0312);
  row.p = 0.0312;
  EXPECT_EQ(p_text(row), "0.031");
  row.log10_p = std::log10(9.97e-7);
  EXPECT_EQ(p_text(row), "1.0e-6");
}

}  // namespace
}  // namespace gonio::nrsfm
