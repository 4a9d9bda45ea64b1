// scripts/proofs/explain-boards: sealed cases of the boards domain through the program itself, and one table: found,
// named, how much, intervals, unseen effects, false alarms. The case's manifest is all that explain is given; the truth
// stays in this process.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <optional>
#include <thread>

#include "base/atomic_file.h"
#include "explain/boards/board_world.h"
#include "manifest/value.h"
#include "stats/intervals.h"

namespace gonio::prove {
namespace {

using manifest::Value;

struct Answer {
  bool ran = false;
  std::string verdict;
  std::vector<std::string> named;
  std::vector<std::string> reported;  // named, and what was not told apart from it
  double before = 0, after = 0;
  Value entry;
};

Answer ask(const BoardCase& sealed, const std::filesystem::path& folder) {
  const std::filesystem::path in = folder / (sealed.name + ".json"), out = folder / (sealed.name + ".out.json");
  write_file(in, sealed.manifest);
  const std::string command =
      std::string(GONIO_BIN) + "/explain --threads 1 --log-level quiet -i " + in.string() + " -o " + out.string();
  const int status = std::system(command.c_str());
  Answer answer;
  answer.ran = WIFEXITED(status) && WEXITSTATUS(status) <= 2;
  if (!answer.ran) return answer;
  const Value document = manifest::parse_json(read_file(out), out.string());
  answer.entry = document.find("explanations")->as_array().at(0);
  answer.verdict = answer.entry.find("verdict")->as_string();
  for (const Value& n : answer.entry.find("named")->as_array())
    answer.named.push_back(n.find("mechanism")->as_string());
  answer.reported = answer.named;
  for (const Value& set : answer.entry.find("not_told_apart")->as_array())
    for (const Value& id : set.as_array()) answer.reported.push_back(id.as_string());
  answer.before = answer.entry.find("held_out")->find("before")->as_number();
  answer.after = answer.entry.find("held_out")->find("after")->as_number();
  return answer;
}

// What the fit should have found, where the world's equation is the model's own.
std::optional<double> true_value(const CaseTruth& t, const std::string& parameter) {
  if (parameter == "k1" && t.lens.division == 0) return t.lens.k1;
  if (parameter == "p1") return t.lens.p1;
  if (parameter == "p2") return t.lens.p2;
  if (parameter == "s1") return t.lens.s1;
  if (parameter == "s3") return t.lens.s3;
  if (parameter == "sag_x_m") return t.board.sag_x_m;
  if (parameter == "sag_y_m") return t.board.sag_y_m;
  if (parameter == "scale_x") return t.board.stretch_x;
  if (parameter == "pupil_m") return t.lens.pupil_m;
  return std::nullopt;
}

struct Row {
  int cases = 0, found = 0, exact = 0, reported = 0, wrong = 0, unknown = 0;
  std::vector<double> errors;
  int intervals = 0, covered = 0;
};

void enter(const BoardCase& sealed, const Answer& answer, Row& row) {
  const CaseTruth& truth = sealed.truth;
  ++row.cases;
  row.found += answer.verdict != "null";
  row.unknown += answer.verdict == "unknown";
  std::vector<std::string> named = answer.named;
  std::sort(named.begin(), named.end());
  row.exact += named == truth.effects;
  const auto has = [](const std::vector<std::string>& list, const std::string& id) {
    return std::find(list.begin(), list.end(), id) != list.end();
  };
  row.wrong += std::any_of(named.begin(), named.end(), [&](const std::string& id) { return !has(truth.effects, id); });
  row.reported += std::all_of(truth.effects.begin(), truth.effects.end(),
                              [&](const std::string& id) { return has(answer.reported, id); });
  for (const Value& n : answer.entry.find("named")->as_array()) {
    if (!has(truth.effects, n.find("mechanism")->as_string())) continue;
    for (const auto& [parameter, value] : n.find("parameters")->as_object()) {
      const std::optional<double> expected = true_value(truth, parameter);
      if (!expected || *expected == 0) continue;
      row.errors.push_back(std::abs(value.as_number() / *expected - 1));
      const auto& interval = n.find("interval_95")->find(parameter)->as_array();
      ++row.intervals;
      row.covered += interval[0].as_number() <= *expected && *expected <= interval[1].as_number();
    }
  }
}

std::string kind_of(const CaseTruth& t) {
  if (t.outside) return "outside the library: periodic sensor error";
  if (t.effects.empty()) return "nothing left out";
  std::string kind;
  for (const std::string& e : t.effects) kind += (kind.empty() ? "" : " + ") + e;
  return t.lens.division != 0 ? kind + " (no polynomial)" : kind;
}

bool print_claim(const char* name, int successes, int trials, double required, bool at_most) {
  const double share = trials > 0 ? static_cast<double>(successes) / trials : 0;
  const bool met = at_most ? share <= required : share >= required;
  std::printf("explain-boards %s: measured %d of %d (%.1f %%) required %s %.0f %%%s\n", name, successes, trials,
              100 * share, at_most ? "<=" : ">=", 100 * required, met ? "" : "  NOT MET");
  return met;
}

int prove(std::size_t repeats) {
  const std::vector<BoardCase> cases = all_board_cases(20261, repeats);
  std::string name = (std::filesystem::temp_directory_path() / "gonio-prove-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) return 73;
  std::vector<Answer> answers(cases.size());
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t k = next++; k < cases.size(); k = next++) answers[k] = ask(cases[k], name);
  };
  std::thread other(work);
  work();
  other.join();
  std::filesystem::remove_all(name);

  std::map<std::string, Row> rows;
  int failed = 0;
  for (std::size_t k = 0; k < cases.size(); ++k) {
    if (answers[k].ran)
      enter(cases[k], answers[k], rows[kind_of(cases[k].truth)]);
    else
      ++failed;
  }
  Row all, effects, nothing, outside;
  std::printf("%-46s %5s %6s %6s %9s %6s %8s %10s %9s\n", "effect", "cases", "found", "named", "in answer", "wrong",
              "unknown", "med. error", "coverage");
  for (const auto& [kind, row] : rows) {
    std::printf("%-46s %5d %6d %6d %9d %6d %8d ", kind.c_str(), row.cases, row.found, row.exact, row.reported,
                row.wrong, row.unknown);
    if (row.errors.empty())
      std::printf("%10s %9s\n", "-", "-");
    else
      std::printf("%8.1f %% %5d/%d\n", 100 * stats::median(row.errors), row.covered, row.intervals);
    Row& sum = kind == "nothing left out" ? nothing : kind.starts_with("outside") ? outside : effects;
    sum.cases += row.cases, sum.found += row.found, sum.exact += row.exact, sum.reported += row.reported,
        sum.wrong += row.wrong;
    sum.intervals += row.intervals, sum.covered += row.covered;
    sum.errors.insert(sum.errors.end(), row.errors.begin(), row.errors.end());
  }
  bool met = failed == 0;
  met &= print_claim("nothing left out, named", nothing.wrong, nothing.cases, 0.02, true);
  met &= print_claim("present, found", effects.found, effects.cases, 0.95, false);
  met &= print_claim("present, named exactly", effects.exact, effects.cases, 0.9, false);
  met &= print_claim("present, in the answer", effects.reported, effects.cases, 0.95, false);
  met &= print_claim("outside the library, named as known", outside.wrong, outside.cases, 0.05, true);
  met &= print_claim("95 % intervals cover", effects.covered, effects.intervals, 0.9, false);
  std::printf("explain-boards median error of parameters: measured %.1f %% required <= 10 %%\n",
              100 * stats::median(effects.errors));
  met &= stats::median(effects.errors) <= 0.1;
  return met ? 0 : 1;
}

}  // namespace
}  // namespace gonio::prove

int main(int argc, char** argv) {
  return gonio::prove::prove(argc > 1 ? static_cast<std::size_t>(std::max(1, std::atoi(argv[1]))) : 5);
}
