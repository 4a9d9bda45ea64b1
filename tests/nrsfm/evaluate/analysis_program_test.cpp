// nrsfm-eval --table and --analyse: the tables of Jensen et al. 2018 from results of their designs, evaluations of a
// manifest, and what is said of tables that cannot be.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <sstream>

#include "base/text.h"
#include "eval_program.h"
#include "io/csv.h"
#include "nrsfm/evaluate/analysis.h"
#include "tools/nrsfm-eval/views.h"

namespace gonio::nrsfm {
namespace {

using testing::HasSubstr;
using tests::Said;

const char* const shapes[] = {"articulated", "bending", "deflation", "stretching", "tearing"};
const char* const paths[] = {"circle", "flyby", "half-circle", "line", "tricky", "zigzag"};

// Their design: 18 methods, one of them on one camera, 10 of which take missing tracks (tables 3 and 10 miss some
// results: those are failures here).
std::string published_design() {
  std::string csv = "algorithm,camera,deformation,path,missing,error_mm\n";
  Random random(5);
  for (int a = 0; a < 18; ++a)
    for (const char* camera : {"orthographic", "perspective"})
      for (const char* shape : shapes)
        for (const char* path : paths)
          for (const char* missing : {"without", "with"}) {
            if (a == 0 && camera[0] == 'p') continue;
            if (missing == std::string("with") && a < 8) continue;
            csv += format("m%02d,%s,%s,%s,%s,", a, camera, shape, path, missing) +
                   shortest_text(30 + 3 * a + (missing[4] == 0 ? 6 : 0) + 5 * random.normal()) + "\n";
          }
  return csv;
}

// As LaTeX counts: a row of a tabular has one "&" fewer than columns; braces close; "$" come in pairs.
void expect_whole_tables(const std::string& tex) {
  int depth = 0;
  std::size_t columns = 0, rows = 0;
  std::istringstream lines(tex);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t spec = line.find("\\begin{tabular}{");
    if (spec != std::string::npos) columns = line.find('}', spec + 16) - spec - 16;
    std::size_t cells = 1, dollars = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
      const bool escaped = i > 0 && line[i - 1] == '\\' && !(i > 1 && line[i - 2] == '\\');
      if (escaped) continue;
      depth += line[i] == '{' ? 1 : line[i] == '}' ? -1 : 0;
      cells += line[i] == '&', dollars += line[i] == '$';
    }
    EXPECT_EQ(dollars % 2, 0) << line;
    if (!line.ends_with("\\\\")) continue;
    ++rows;
    EXPECT_EQ(cells, columns) << line;
  }
  EXPECT_EQ(depth, 0);
  EXPECT_GT(rows, 100);
}

class EvalAnalysis : public tests::EvalFolder {};

TEST_F(EvalAnalysis, AllTablesOfThePaperComeOutOfItsDesign) {
  write_file(path("r.csv"), published_design());
  const Said said =
      run({"--table", path("r.csv"), "--out", path("t"), "--html", path("p.html"), "--rank-draws", "200"});
  ASSERT_EQ(said.status, 0) << said.error;
  EXPECT_FALSE(std::filesystem::exists(path("out.json")));  // there is no manifest
  const io::Csv anova = io::read_csv(path("t/anova.csv"));
  std::map<std::string, std::string> degrees;
  for (const auto& row : anova.rows) degrees[row[0] + " " + row[1]] = row[2];
  // Tables 3 and 10: 18 methods instead of the 16 whose results they have.
  EXPECT_EQ(degrees["complete algorithm"], "17");
  EXPECT_EQ(degrees["complete camera"], "1");
  EXPECT_EQ(degrees["complete deformation"], "4");
  EXPECT_EQ(degrees["complete path"], "5");
  EXPECT_EQ(degrees["complete algorithm:deformation"], "68");
  EXPECT_EQ(degrees["complete algorithm:path"], "85");
  EXPECT_EQ(degrees["complete camera:deformation"], "4");
  EXPECT_EQ(degrees["complete camera:path"], "5");
  EXPECT_EQ(degrees["complete deformation:path"], "20");
  EXPECT_FALSE(degrees.contains("complete algorithm:camera"));  // one of its cells is empty
  EXPECT_EQ(degrees["missing missing"], "1");
  EXPECT_EQ(degrees["missing algorithm:missing"], "9");
  EXPECT_EQ(degrees["missing missing:path"].empty() ? degrees["missing path:missing"] : degrees["missing missing:path"],
            "5");
  // Tables 4 to 9 and 11 to 13: means of every single factor, and of the pairs that they print.
  std::set<std::string> means;
  for (const auto& row : io::read_csv(path("t/means.csv")).rows) means.insert(row[0] + " " + row[1]);
  for (const char* table : {"complete algorithm", "complete algorithm:deformation", "complete algorithm:path",
                            "complete camera", "complete deformation", "complete path", "missing path:missing",
                            "missing deformation:missing", "missing algorithm:missing"})
    EXPECT_TRUE(means.contains(table)) << table;
  const std::string tex = read_file(path("t/tables.tex"));
  std::size_t begun = 0, ended = 0;
  for (std::size_t at = tex.find("\\begin{table}"); at != std::string::npos; at = tex.find("\\begin{table}", at + 1))
    ++begun;
  for (std::size_t at = tex.find("\\end{table}"); at != std::string::npos; at = tex.find("\\end{table}", at + 1))
    ++ended;
  EXPECT_EQ(begun, 1 + 4 + 5 + 1 + 1 + 5 + 10 + 1);  // two analyses of variance, singles, pairs, two tables of ranks
  EXPECT_EQ(ended, begun);
  expect_whole_tables(tex);
  EXPECT_THAT(read_file(path("p.html")), HasSubstr("with and without missing tracks"));
}

TEST_F(EvalAnalysis, TablesInPartsAreOne) {
  const std::string all = published_design();
  const std::size_t half = all.find('\n', all.size() / 2) + 1;
  write_file(path("all.csv"), all);
  write_file(path("a.csv"), all.substr(0, half));
  write_file(path("b.csv"), all.substr(0, all.find('\n') + 1) + all.substr(half));
  ASSERT_EQ(run({"--table", path("all.csv"), "--out", path("one"), "--rank-draws", "100"}).status, 0);
  ASSERT_EQ(
      run({"--table", path("a.csv"), "--table", path("b.csv"), "--out", path("two"), "--rank-draws", "100"}).status, 0);
  for (const char* name : {"anova.csv", "means.csv", "ranks.csv", "empty-cells.csv", "tables.tex"})
    EXPECT_EQ(read_file(path("one") + "/" + name), read_file(path("two") + "/" + name)) << name;
}

// A manifest of three sequences and two algorithms, of which one is twice as far off.
class EvalManifest : public EvalAnalysis {
 protected:
  void SetUp() override {
    std::string files, sequences, reconstructions;
    for (int k = 0; k < 3; ++k) {
      const Shapes q = tests::deforming(20, 10, k + 1);
      write_truth(q, "t" + std::to_string(k), {{"path", k == 0 ? "line" : k == 1 ? "circle" : "zigzag"}});
      write(tests::noisy(q, 0.004, 0, 5), "good" + std::to_string(k));
      write(tests::noisy(q, 0.008, 0, 6), "poor" + std::to_string(k));
      const std::string n = std::to_string(k), comma = k > 0 ? "," : "";
      files += comma + "\"t" + n + "\": {\"path\": \"t" + n + ".mat\"}, \"g" + n + "\": {\"path\": \"good" + n +
               ".mat\"}, \"p" + n + "\": {\"path\": \"poor" + n + ".mat\"}";
      sequences += comma + "\"s" + n + "\": {\"file\": \"t" + n + "\"}";
      for (const char* a : {"g", "p"})
        reconstructions += std::string(reconstructions.empty() ? "" : ",") + "{\"id\": \"" + a + n +
                           "\", \"sequence\": \"s" + n + "\", \"algorithm\": \"" + a + "\", \"file\": \"" + a + n +
                           "\", \"frame\": \"object\"}";
    }
    write_file(path("m.json"), "{\"gonio\": 1, \"files\": {" + files + "}, \"sequences\": {" + sequences +
                                   "}, \"reconstructions\": [" + reconstructions + "]}");
  }
};

TEST_F(EvalManifest, EvaluatesAndAnalysesAtOnceOrOneAfterTheOther) {
  ASSERT_EQ(run({"-i", path("m.json"), "--draws", "0", "--csv", path("e.csv"), "--analyse", "--model", "main", "--out",
                 path("once")})
                .status,
            0);
  write_file(path("evaluated.json"), read_file(path("out.json")));
  ASSERT_EQ(run({"--table", path("e.csv"), "--model", "main", "--out", path("later")}).status, 0);
  EXPECT_EQ(read_file(path("once/anova.csv")), read_file(path("later/anova.csv")));
  EXPECT_EQ(read_file(path("once/means.csv")), read_file(path("later/means.csv")));
  const io::Csv ranks = io::read_csv(path("once/ranks.csv"));
  ASSERT_EQ(ranks.rows.size(), 2);
  EXPECT_EQ(ranks.rows[0][2], "g");
  EXPECT_NEAR(std::stod(ranks.rows[0][3]), 4 * std::sqrt(3) * 0.001, 0.6 * 0.001);  // mm
  EXPECT_NEAR(std::stod(ranks.rows[1][3]) / std::stod(ranks.rows[0][3]), 2, 0.2);
  // Another error, of the evaluations alone.
  ASSERT_EQ(run({"-i", path("m.json"), "--analyse", "--error", "e3d/frame-rotation", "--factors", "algorithm", "--out",
                 path("e3d"), "--html", path("page.html")})
                .status,
            0);
  EXPECT_EQ(io::read_csv(path("e3d/anova.csv")).rows.size(), 3);  // algorithm, error, total
  EXPECT_THAT(read_file(path("page.html")), HasSubstr("g has the least expected error"));
}

TEST_F(EvalAnalysis, ManyReconstructionsAreAMatrixAndOneWarning) {
  std::string files, sequences, reconstructions;
  for (int k = 0; k < 4; ++k) {
    const std::string n = std::to_string(k), comma = k > 0 ? "," : "";
    const Shapes q = tests::deforming(20, 8, k + 1);
    write_truth(q, "t" + n, {});
    files += comma + "\"t" + n + "\": {\"path\": \"t" + n + ".mat\"}";
    sequences += comma + "\"s" + n + "\": {\"file\": \"t" + n + "\"}";
    for (const std::string a : {"csf", "pta", "rigid", "spfm"}) {
      write(tests::noisy(a == "pta" ? Shapes(-q) : q, 0.004, 0, 5), a + n, a);
      files += ",\"" + a + n + "\": {\"path\": \"" + a + n + ".mat\"}";
      reconstructions += std::string(reconstructions.empty() ? "" : ",") + "{\"id\": \"s" + n + "-" + a +
                         "\", \"sequence\": \"s" + n + "\", \"algorithm\": \"" + a + "\", \"file\": \"" + a + n +
                         "\", \"frame\": \"object\"}";
    }
  }
  write_file(path("many.json"), "{\"gonio\": 1, \"files\": {" + files + "}, \"sequences\": {" + sequences +
                                    "}, \"reconstructions\": [" + reconstructions + "]}");
  const Said said = run({"-i", path("many.json"), "--draws", "0", "--html", path("p.html")});
  ASSERT_EQ(said.status, 0);
  EXPECT_THAT(said.error, HasSubstr("4 of 16 reconstructions are mirrored, 4 of them from orthographic tracks"));
  EXPECT_EQ(std::ranges::count(said.error, '\n'), 1) << said.error;
  const std::string page = read_file(path("p.html"));
  EXPECT_THAT(page, HasSubstr("class=\"heat\""));
  EXPECT_THAT(page, HasSubstr("<summary>All errors</summary>"));
  EXPECT_THAT(page, HasSubstr("4 of 16 reconstructions: of each algorithm the one of median error"));
}

TEST_F(EvalManifest, ViewsAreTypicalOnes) {
  // a: 1, 2, 9; b: 4, 5 -> of each the (lower) median, the least first.
  const std::vector<std::string> algorithms = {"a", "b", "a", "b", "a"};
  const std::vector<double> errors = {9, 5, 1, 4, 2};
  EXPECT_EQ(gonio::tools::nrsfm_eval::typical(algorithms, errors, 4), (std::vector<std::size_t>{4, 3}));
  EXPECT_EQ(gonio::tools::nrsfm_eval::typical(algorithms, errors, 1), (std::vector<std::size_t>{4}));
  EXPECT_EQ(gonio::tools::nrsfm_eval::typical(algorithms, errors, 5), (std::vector<std::size_t>{2, 4, 3, 1, 0}));
  EXPECT_TRUE(gonio::tools::nrsfm_eval::typical(algorithms, errors, 0).empty());
}

struct Wrong {
  std::vector<std::string> arguments;
  int status;
  std::string says;
};

TEST_F(EvalManifest, RefusesInOneLineWithPlaceValueAndRemedy) {
  write_file(path("r.csv"), published_design());
  write_file(path("other.csv"), "algorithm,speed,error_mm\na,1,2\n");
  write_file(path("metres.csv"), "algorithm,camera,deformation,path,missing,error_m\na,b,c,d,with,2\n");
  write_file(path("head.csv"), "algorithm,error\n");
  write_file(path("word.csv"), "algorithm,path,error\na,b,c\n");
  write_file(path("ragged.csv"), "algorithm,path,error\na,b,1\na,2\n");
  write_file(path("hole.csv"), "algorithm,path,error\na,b,1\n,b,2\n");
  write_file(path("one.csv"), "algorithm,error\na,1\na,2\n");
  write_file(path("few.csv"), "algorithm,error\na,1\nb,2\n");
  write_file(path("same.csv"), "algorithm,error\na,1\nb,1\na,1\nb,1\n");
  const std::string r = path("r.csv"), t = path("t"), m = path("m.json");
  const std::vector<Wrong> wrong{
      {{"--table", r}, 64, "give --out FOLDER, --html FILE"},
      {{"--table", path("none.csv"), "--out", t}, 66, "none.csv"},
      {{"--table", r, "--out", t, "--error", "speed"}, 64, "has no column \"speed\"; it has"},
      {{"--table", r, "--out", t, "--factors", "algorithm,colour"}, 64, "has no column \"colour\""},
      {{"--table", r, "--out", t, "--model", "algorithm + colour"}, 64, "there is no factor \"colour\""},
      {{"--table", r, "--out", t, "--without", "no"}, 64, "has no level \"no\""},
      {{"--table", r, "--out", t, "--sums", "4"}, 64, "choose one of 1, 2, 3"},
      {{"--table", r, "--table", path("other.csv"), "--out", t}, 65, "choose common ones with --factors"},
      {{"--table", r, "--table", path("metres.csv"), "--out", t}, 65, "analyse one error in one unit"},
      {{"--table", path("head.csv"), "--out", t}, 65, "head.csv"},
      {{"--table", path("word.csv"), "--out", t}, 65, "word.csv:2"},
      {{"--table", path("ragged.csv"), "--out", t}, 65, "ragged.csv:3"},
      {{"--table", path("hole.csv"), "--out", t}, 65, "hole.csv:3: factor \"algorithm\" is empty"},
      {{"--table", path("one.csv"), "--out", t}, 65, "no factor has two levels"},
      {{"--table", path("few.csv"), "--out", t}, 65, "few.csv"},
      {{"--table", path("same.csv"), "--out", t}, 65, "same.csv"},
      {{"--table", r, "--out", t, "--truth", path("t0.mat")}, 64, "--truth"},
      {{"--table", r, "--out", t, "-i", m}, 64, "stands alone"},
      {{"--model", "main", "-i", m}, 64, "belongs to an analysis; give --table FILE or --analyse"},
      {{"-i", m, "--analyse"}, 64, "give --out FOLDER, --html FILE"},
      {{"-i", m, "--analyse", "--out", t, "--factors", "colour"}, 64, "there is no factor \"colour\"; factors are"},
      {{"-i", m, "--analyse", "--out", t, "--error", "e3d/sideways"}, 65, "none has \"e3d\" under \"sideways\""}};
  for (const Wrong& w : wrong) {
    const Said said = run(w.arguments);
    EXPECT_EQ(said.status, w.status) << w.says << " / " << said.error;
    EXPECT_THAT(said.error, HasSubstr(w.says));
    EXPECT_EQ(std::ranges::count(said.error, '\n'), 1) << said.error;
    EXPECT_FALSE(std::filesystem::exists(t + "/anova.csv")) << w.says;
  }
}

}  // namespace
}  // namespace gonio::nrsfm
