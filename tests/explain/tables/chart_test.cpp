// What a colour chart's readings leave out, in worlds integrated over spectra (chart_world.h) and in photographs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "chart_world.h"

namespace gonio::explain::tables::tests {
namespace {

const std::array<const char*, 3> cameras = {"Canon_5DMarkII_camspec_Canon_5DMarkII.csv",
                                            "Nikon_D5100_camspec_Nikon_D5100.csv",
                                            "Sony_NEX-5N_camspec_SONY_NEX-5N.csv"};

struct Answers {
  int nothing = 0, alone = 0, listed = 0, first = 0, wrong = 0, covered = 0, intervals = 0;
  std::string texts;
};
std::set<std::string> listed_in(const Problem& problem, const Explanation& e) {
  std::set<std::string> ids;
  for (const std::size_t c : e.named) ids.insert(problem.candidates()[c].id());
  for (const auto* sets : {&e.not_told_apart, &e.instead})
    for (const auto& set : *sets)
      for (const std::size_t c : set) ids.insert(problem.candidates()[c].id());
  return ids;
}
Answers ask(const char* what, const ChartTruth& truth, const std::string& id, int seeds,
            const std::string& parameter = "", double value = 0) {
  Answers a;
  for (int seed = 1; seed <= seeds; ++seed) {
    const ChartSpectra spectra = chart_spectra(cameras[static_cast<std::size_t>(seed) % cameras.size()]);
    const TablesProblem problem = chart_world(static_cast<std::uint64_t>(seed), spectra, truth).problem();
    const Explanation e = explain(problem, {});
    const std::string text = named(problem, e);
    const auto listed = listed_in(problem, e);
    a.nothing += text.empty() ? 1 : 0, a.alone += text == id && listed.size() == 1 ? 1 : 0;
    a.first += text == id ? 1 : 0, a.listed += listed.contains(id) ? 1 : 0;
    a.wrong += !text.empty() && !listed.contains(id) ? 1 : 0;
    std::string others;
    for (const std::string& other : listed) others += other + " ";
    std::printf("   %d: [%s] listed %s| %s\n", seed, text.c_str(), others.c_str(), e.sentence.substr(0, 200).c_str());
    if (const Estimate* x = parameter.empty() ? nullptr : estimate_of(problem, e, parameter)) {
      ++a.intervals, a.covered += x->lower_95 <= value && value <= x->upper_95 ? 1 : 0;
      std::printf("      %s = %g (%g .. %g)\n", parameter.c_str(), x->value, x->lower_95, x->upper_95);
    }
  }
  std::printf("%s: nothing %d, first %d, alone %d, listed %d, wrong %d, of %d; covered %d of %d\n", what, a.nothing,
              a.first, a.alone, a.listed, a.wrong, seeds, a.covered, a.intervals);
  return a;
}

TEST(ChartExplore, All) {
  const int n = std::getenv("N") ? std::atoi(std::getenv("N")) : 3;
  const std::string w = std::getenv("W") ? std::getenv("W") : "";
  const std::string g = "colour.glare", o = "sensor.black-offset", p = "colour.glare.share";
  if (w.empty() || w == "null") ask("null", {}, "none", n);
  for (const double share : {0.01, 0.02, 0.03})
    if (w.empty() || w == "glare") ask(format("glare %g", share).c_str(), {.glare = share}, g, n, p, share);
  if (w.empty() || w == "offset") ask("offset 1 %", {.offset = {.01, .01, .01}}, o, n, o + ".offset", 0.01);
  for (const double share : {0.01, 0.03})
    if (w.empty() || w == "two")
      ask(format("two, glare %g", share).c_str(), {.glare = share, .exposures = {1, 0.25}}, g, n, p, share);
  if (w.empty() || w == "two-offset") ask("two, offset 1 %", {.offset = {.01, .01, .01}, .exposures = {1, 0.25}}, o, n, o + ".offset", 0.01);
  if (w.empty() || w == "bent") ask("bent", {.quadratic = -0.15}, "sensor.non-linearity", n);
  if (w.empty() || w == "clipped") ask("clipped", {.full_scale = 0.6}, "sensor.saturation", n);
  if (w.empty() || w == "light") ask("light", {.across = 0.12, .down = -0.05}, "light.inverse-square", n);
}

}  // namespace
}  // namespace gonio::explain::tables::tests
