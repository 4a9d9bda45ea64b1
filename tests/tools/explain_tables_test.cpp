// explain on tables as a person types it: CSV, JSON, units, expressions; the upgraded manifest runs again; what is
// wrong is said in one line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/atomic_file.h"
#include "base/random.h"
#include "base/text.h"
#include "data.h"
#include "geom/angle.h"
#include "manifest/document.h"
#include "manifest/sections/file.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/table.h"
#include "process.h"
#include "schema_check.h"

namespace gonio::tests {
namespace {

using testing::HasSubstr;
using testing::Not;

class ExplainTables : public testing::Test {
 protected:
  // f = 0.5 cos(theta) + 0.2, 0.3 % noise, times a lamp that warms up by `drift`.
  std::string csv(const std::string& theta, double unit, double drift, std::uint64_t seed = 1) const {
    Random random(seed, 1);
    std::string text = "series," + theta + ",time_s,f\n";
    for (int s = 0; s < 8; ++s)
      for (int i = 0; i < 25; ++i) {
        const double angle = 0.05 * i, time = 100.0 * s + i;
        const double f = (0.5 * std::cos(angle) + 0.2) * (1 + drift * std::exp(-time / 200));
        text += std::to_string(s) + "," + shortest_text(angle / unit) + "," + shortest_text(time) + "," +
                shortest_text(f * (1 + 0.003 * random.normal())) + "\n";
      }
    return text;
  }
  void write(const std::string& name, const std::string& text) const { write_file(folder_ / name, text); }
  Ended explain(std::vector<std::string> words, const std::string& input = {}) const {
    words.insert(words.begin(), "explain");
    Ended ended = run(words, folder_.path(), input);
    if (ended.out.starts_with("{")) expect_described(ended.out);
    return ended;
  }
  std::string verdict(const std::string& out) const {
    const manifest::Document d = manifest::parse_document(out, "o", folder_.path(), {.allow_outside = true});
    return d.explanations.at(0).find("verdict")->as_string();
  }
  static std::vector<std::string> quick(const std::string& file) {
    return {file, "--model", "a*cos(theta)+b", "--observed", "f", "--group", "series", "--free", "a=1,b=0"};
  }
  ScratchFolder folder_;
};

TEST_F(ExplainTables, ACsvBecomesAManifestThatRunsAgain) {
  write("d.csv", csv("theta [deg]", degree, 0.08));
  const Ended first = explain(quick("d.csv"));
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_THAT(first.out, HasSubstr("\"light.drift\""));
  const manifest::Document d = manifest::parse_document(first.out, "o", folder_.path());
  EXPECT_EQ(d.tables.at("d").file, "d");
  EXPECT_EQ(d.files.at("d").sha256.size(), 64u);
  EXPECT_NEAR(d.tables.at("d").parameters.at("a").scalar(), 0.5, 0.01);
  EXPECT_NEAR(d.mechanisms.at("light.drift").parameters.at("amplitude").scalar(), 0.08, 0.01);
  write("o.json", first.out);
  const Ended again = explain({"o.json"});
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(verdict(again.out), "null") << again.out;
}

TEST_F(ExplainTables, HeadingsUnitsAndJsonMeanTheSame) {
  write("bracket.csv", csv("theta [deg]", degree, 0));
  write("suffix.csv", csv("theta_deg", degree, 0));
  write("bare.csv", csv("theta", degree, 0));
  std::vector<std::string> bare = quick("bare.csv");
  bare.insert(bare.end(), {"--units", "theta=deg"});
  std::string rows;
  const std::string text = csv("theta", degree, 0);
  for (std::size_t at = text.find('\n') + 1; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    std::string line = text.substr(at, end - at), object = "{\"series\": ";
    for (const char* next : {", \"theta\": ", ", \"time_s\": ", ", \"f\": "}) {
      object += line.substr(0, line.find(',')) + next;
      line = line.substr(line.find(',') + 1);
    }
    rows += (rows.empty() ? "" : ", ") + object + line + "}";
    at = end + 1;
  }
  write("t.json", "{\"units\": {\"theta\": \"deg\"}, \"rows\": [" + rows + "]}");
  std::vector<std::string> json = quick("t.json");
  json.insert(json.begin(), "--table");
  const auto a = [&](const std::vector<std::string>& words) {
    const Ended ended = explain(words);
    EXPECT_EQ(ended.status, 0) << ended.err;
    return manifest::parse_document(ended.out, "o", folder_.path()).tables.begin()->second.parameters.at("a").scalar();
  };
  const double reference = a(quick("bracket.csv"));
  EXPECT_NEAR(reference, 0.5, 0.005);
  EXPECT_DOUBLE_EQ(a(quick("suffix.csv")), reference);
  EXPECT_NEAR(a(bare), reference, 1e-9);
  EXPECT_NEAR(a(json), reference, 1e-9);
}

TEST_F(ExplainTables, HypothesesProtectAndRepeatAreHeard) {
  write("d.csv", csv("theta [deg]", degree, 0.08));
  std::vector<std::string> words = quick("d.csv");
  words.insert(words.end(), {"--hypotheses", "sensor.black-offset"});
  EXPECT_THAT(explain(words).out, Not(HasSubstr("\"mechanisms\"")));
  words = quick("d.csv");
  words.insert(words.end(), {"--protect", "tables/d/a"});
  const Ended held = explain(words);
  EXPECT_EQ(manifest::parse_document(held.out, "o", folder_.path()).tables.at("d").parameters.at("a").scalar(), 1);
  words = quick("d.csv");
  words.insert(words.end(), {"--budget", "100ms"});
  const Ended hurried = explain(words);
  EXPECT_EQ(hurried.status, 0) << hurried.err;
  EXPECT_EQ(hurried.out, explain(words).out);  // an amount of work, not a clock
  write("again.csv", csv("theta [deg]", degree, 0.08, 2));
  words = quick("d.csv");
  words.insert(words.end(), {"--repeat", "again.csv"});
  const Ended repeated = explain(words);
  EXPECT_EQ(repeated.status, 0) << repeated.err;
  EXPECT_THAT(repeated.out, HasSubstr("repeated observations"));
}

TEST_F(ExplainTables, WhatIsWrongIsSaidInOneLine) {
  write("d.csv", csv("theta [deg]", degree, 0));
  write("bad.csv", "theta,f\n0,1\n1,x\n");
  write("ragged.csv", "theta,f\n0,1\n1\n");
  write("quote.csv", "theta,f\n0,\"1\n1,2\n");
  write("few.csv", "theta,f\n0,1\n1,2\n");
  write("unit.csv", "theta [furlong],f\n0,1\n1,2\n");
  const auto with = [](std::string file, std::string model, std::string observed = "f") {
    return std::vector<std::string>{std::move(file), "--model", std::move(model), "--observed", std::move(observed)};
  };
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {with("none.csv", "1"), "none.csv"},
      {with("bad.csv", "1"), "bad.csv:3: f: \"x\" is no number"},
      {with("ragged.csv", "1"), "ragged.csv:3: has 1 fields, the header names 2"},
      {with("quote.csv", "1"), "quote.csv:2: a quote is opened and never closed"},
      {with("few.csv", "1"), "has 2 rows"},
      {with("unit.csv", "1"), "unit \"furlong\" is not known"},
      {with("d.csv", "a*cos(theta"), "does not parse"},
      {with("d.csv", "a*cos(phi)"), "uses a, phi, neither columns nor parameters"},
      {with("d.csv", "2*f"), "which is what it has to predict"},
      {with("d.csv", "f=2"), "assigns at position 2"},
      {with("d.csv", "1", "g"), "has no column \"g\""},
      {{"d.csv"}, "is a table without --model"},
      {{"--free", "a=1"}, "none is given"},
      {{"d.csv", "--model", "a", "--observed", "f", "--free", "a"}, "is not NAME=VALUE"}};
  for (const auto& [words, message] : cases) {
    const Ended ended = explain(words);
    EXPECT_GE(ended.status, 64) << message;
    EXPECT_LT(ended.status, 70) << message << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(message));
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
    EXPECT_EQ(ended.out, "");
  }
}

TEST_F(ExplainTables, WhatLiesBelowOutIsReplacedWithForceOnly) {
  write("d.csv", csv("theta [deg]", degree, 0.08));
  std::vector<std::string> call = quick("d.csv");
  call.insert(call.end(), {"--negative-controls", "2", "--html", "page.html", "--out", "o"});
  ASSERT_EQ(explain(call).status, 0);
  ASSERT_TRUE(std::filesystem::exists(folder_ / "o/evidence-tables.csv"));
  write("o/evidence-tables.csv", "mine");
  const Ended again = explain(call);
  EXPECT_EQ(again.status, 73);
  EXPECT_THAT(again.err, HasSubstr("evidence-tables.csv: exists; --force replaces it"));
  EXPECT_EQ(read_file(folder_ / "o/evidence-tables.csv"), "mine");
  call.push_back("--force");
  EXPECT_EQ(explain(call).status, 0);
  EXPECT_NE(read_file(folder_ / "o/evidence-tables.csv"), "mine");
}

// Options that say what a picture's numbers mean say nothing about other files.
TEST_F(ExplainTables, HeightMapsAndTablesHaveTheirOwnOptions) {
  write("d.csv", csv("theta [deg]", degree, 0));
  std::vector<std::string> call = quick("d.csv");
  call.insert(call.end(), {"--step", "1um"});
  const Ended step = explain(call);
  EXPECT_EQ(step.status, 64);
  EXPECT_THAT(step.err, HasSubstr("--step: says what the numbers of an OpenEXR or TIFF mean, and d.csv is none"));
  EXPECT_EQ(explain({"--unit", "um"}).status, 64);
  EXPECT_EQ(explain({"none.tif", "--step", "1um"}).status, 66);
  write("m.tif", std::string("II*\0\x08\0\0\0\0\0", 10));
  const Ended cut = explain({"m.tif", "--step", "1um", "--unit", "um"});
  EXPECT_EQ(cut.status, 65);
  EXPECT_THAT(cut.err, HasSubstr("m.tif: "));
  EXPECT_EQ(std::ranges::count(cut.err, '\n'), 1);
}

TEST_F(ExplainTables, ABlankSeparatedTableIsReadLikeAnyOther) {
  std::string text = csv("theta_deg", degree, 0.08);
  std::ranges::replace(text, ',', ' ');
  write("d.txt", text);
  const Ended ended = explain(quick("d.txt"));
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("\"light.drift\""));
}

}  // namespace
}  // namespace gonio::tests
