// Tables made in memory, with their manifest: what a user would hand in.
#pragma once
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/random.h"
#include "base/text.h"
#include "explain/engine.h"
#include "explain/tables/tables_problem.h"
#include "inference/explanation.h"
#include "manifest/document.h"

namespace gonio::explain::tables::tests {

struct World {
  std::vector<std::pair<std::string, std::string>> columns;  // name, unit
  std::vector<std::vector<double>> rows;
  std::string rest;      // of the table's section: "\"model\": \"sensor\", ..."
  std::string sections;  // further sections: "\"lights\": {...},"

  manifest::Document document() const {
    std::string text = "{\"gonio\": 1, " + sections + "\"tables\": {\"t\": {\"columns\": {";
    for (std::size_t c = 0; c < columns.size(); ++c)
      text += (c == 0 ? "\"" : ", \"") + columns[c].first + "\": \"" + columns[c].second + "\"";
    text += "}, \"rows\": [";
    for (std::size_t r = 0; r < rows.size(); ++r) {
      text += r == 0 ? "[" : ", [";
      for (std::size_t c = 0; c < rows[r].size(); ++c) text += (c == 0 ? "" : ", ") + shortest_text(rows[r][c]);
      text += "]";
    }
    return manifest::parse_document(text + "], " + rest + "}}}", "t.json", ".");
  }
  TablesProblem problem(const ProblemOptions& options = {}) const { return {document(), "t", options, false}; }
};

// Readings of 6 grey patches at 12 exposures, shot noise and read noise, 12 bits. `reading` of the ideal value, the
// exposure and the time. Where sigma is not stated, the column `truth` holds it.
inline World sensor_world(std::uint64_t seed, const std::function<double(double, double, double)>& reading,
                          bool states_sigma = true) {
  World w;
  w.columns = {{"patch", ""},
               {"exposure_s", "s"},
               {"time_s", "s"},
               {"value", "1"},
               {states_sigma ? "value_sigma" : "truth", "1"}};
  w.rest = R"("model": "sensor", "observed": ["value"])";
  if (states_sigma) w.rest += R"(, "sigma": ["value_sigma"])";
  Random random(seed, 3);
  int n = 0;
  for (int e = 0; e < 12; ++e)
    for (int p = 0; p < 6; ++p) {
      const int shuffled = (e * 5) % 12;
      const double exposure = 0.002 * std::pow(1.35, shuffled), radiance = 1e4 * std::pow(1.9, p) / 10;
      const double time = 10.0 * n++, ideal = radiance * exposure;
      const double f = reading(ideal, exposure, time);
      const double sigma = std::sqrt(0.5 * 0.5 + 0.05 * std::abs(f));
      w.rows.push_back({static_cast<double>(p), exposure, time, f + sigma * random.normal(), sigma});
    }
  return w;
}

inline std::string named(const Problem& problem, const Explanation& e) {
  std::string text;
  for (const std::size_t c : e.named) text += (text.empty() ? "" : " ") + problem.candidates()[c].id();
  return text;
}

inline void expect_refused(const World& world, const std::string& words) {
  try {
    world.problem();
    FAIL() << "was accepted, not: " << words;
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::data);
    EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what();
  }
}

// The answer put into the manifest and asked again: nothing is left of what was named, and it acts once.
inline Explanation asked_again(const World& world, const TablesProblem& problem, const Explanation& e) {
  manifest::Document document = world.document();
  problem.apply(e, document);
  return explain(TablesProblem(document, "t", {}, false), {});
}

inline const Estimate* estimate_of(const Problem& problem, const Explanation& e, const std::string& parameter) {
  for (const Estimate& x : e.estimates)
    if (problem.parameters()[x.parameter].name == parameter) return &x;
  return nullptr;
}

}  // namespace gonio::explain::tables::tests
