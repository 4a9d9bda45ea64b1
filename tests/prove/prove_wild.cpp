// scripts/proofs/wild: judges the answers to cases that another renderer recorded (tests/wild).
//   prove-wild ANSWERS TRUTHS RIGHT.json SEED...    table on stdout; ANSWERS.html beside the answers
// ANSWERS/NNN holds what explain wrote and status.txt, TRUTHS/NNN.json what was left out. Seeds without a truth are not
// there; seeds without a status were not begun.
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/text.h"
#include "sealed/wild.h"

namespace gonio::sealed {
namespace {

using std::filesystem::path;

std::vector<Judged> read_all(const path& answers, const path& truths, const Rights& rights,
                             const std::vector<std::string>& seeds) {
  std::vector<Judged> cases;
  for (const std::string& seed : seeds) {
    const std::string name = format("%03d", std::atoi(seed.c_str()));
    if (!std::filesystem::exists(truths / (name + ".json"))) continue;
    const Case made = read_wild_truth(truths, name, rights);
    Judged j{made.spec, made.truth, made.id, {}};
    if (std::filesystem::exists(answers / name / "status.txt")) j.answer = read_answer(answers / name, made);
    use_first_names(made, rights, j.answer);
    cases.push_back(std::move(j));
  }
  return cases;
}

int run(const std::vector<std::string>& words) {
  if (words.size() < 4) {
    std::fputs("prove-wild ANSWERS TRUTHS RIGHT.json SEED...\n", stderr);
    return 64;
  }
  const std::vector<Judged> cases =
      read_all(words[0], words[1], read_rights(words[2]), {words.begin() + 3, words.end()});
  const Judgement judgement = judge(cases, wild_asking());
  std::fputs(table_text(judgement).c_str(), stdout);
  write_file(words[0] + ".html",
             page_html(judgement, cases, "scripts/prove wild, seeds " + words[3] + " to " + words.back(), "wild cases",
                       "Recordings made by another renderer (Blender's Cycles) and a camera chain of its own, with "
                       "effects that the library has and effects that it has not."));
  bool missed = judgement.unanswered > 0;
  for (const Question& q : judgement.questions) {
    if (!q.required) continue;
    std::printf("wild %s, %s: measured %s required %s%s\n", q.question.c_str(), q.measure.c_str(), q.measured().c_str(),
                q.to_reach.c_str(), q.met() ? "" : "  NOT MET");
    missed = missed || q.surely_missed();
  }
  if (!judgement.stated.empty())
    std::printf("wild how sure, expected calibration error: measured %.3f required <= 0.05\n",
                reliability_of(judgement.stated).error);
  return missed ? 1 : 0;
}

}  // namespace
}  // namespace gonio::sealed

int main(int argc, char** argv) {
  try {
    return gonio::sealed::run({argv + 1, argv + argc});
  } catch (const std::exception& e) {
    std::fprintf(stderr, "prove-wild: %s\n", e.what());
    return 70;
  }
}
