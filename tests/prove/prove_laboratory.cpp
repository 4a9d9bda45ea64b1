// scripts/proofs/sealed-laboratory: laboratories whose perturbations no program under test is told, from the plan of
// their views to what explain makes of their frames.
//   prove-laboratory FOLDER SEED...    runs what has not been run, and prints the table
// Detection limits are those that explain prints for these very recordings, of a number alone, at its own significance
// (sealed/judge.h).
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <set>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/text.h"
#include "sealed/judge.h"
#include "sealed/laboratory/laboratory_run.h"

namespace gonio::sealed {
namespace {

using std::filesystem::path;

struct Counts {
  int above = 0, named_above = 0, there = 0, named = 0, laboratories = 0, invented = 0, failed = 0;
};

Answer answer_in(const path& folder, const std::string& domain) {
  Case asked;
  asked.spec.domain = domain;
  return read_answer(folder, asked);
}

double times_the_limit_of(const Perturbation& p, const Answer& answer) {
  Judged judged;
  judged.truth.values = {{p.mechanism, p.parameter, p.value}};
  judged.truth.mechanisms = {p.mechanism};
  judged.answer = answer;
  return times_the_limit(judged);
}

bool is_name_of(const Perturbation& p, const std::string& name) {
  return name == p.mechanism || std::ranges::find(p.likewise, name) != p.likewise.end();
}

void judge_one(const LaboratoryCase& sealed, const path& folder, Counts& counts) {
  ++counts.laboratories;
  const Answer all = answer_in(folder, "robot");
  if (!all.ran) {
    ++counts.failed;
    std::printf("%4llu  no answer: %s\n", static_cast<unsigned long long>(sealed.seed), all.error.c_str());
    return;
  }
  std::set<std::string> names(all.named.begin(), all.named.end());
  names.insert(all.elsewhere.begin(), all.elsewhere.end());
  std::string truth, found;
  for (const Perturbation& p : sealed.perturbations) {
    const double times = times_the_limit_of(p, answer_in(folder, p.domain));
    const bool named = std::ranges::any_of(names, [&p](const std::string& name) { return is_name_of(p, name); });
    ++counts.there;
    counts.named += named;
    counts.above += times >= 1;
    counts.named_above += times >= 1 && named;
    truth += (truth.empty() ? "" : " + ") + p.mechanism + format(" %.3g (%.1f limits)", p.value, times) +
             (named        ? ""
              : times >= 1 ? " MISSED"
                           : " not named");
  }
  bool invented = false;
  for (const std::string& name : names) {
    const bool there =
        std::ranges::any_of(sealed.perturbations, [&name](const Perturbation& p) { return is_name_of(p, name); });
    found += (found.empty() ? "" : " + ") + name + (there ? "" : " INVENTED");
    invented = invented || !there;
  }
  counts.invented += invented;
  std::printf("%4llu  %-84s %-44s %4.0f s\n", static_cast<unsigned long long>(sealed.seed),
              truth.empty() ? "nothing" : truth.c_str(), found.empty() ? "nothing" : found.c_str(), all.seconds);
  std::fflush(stdout);
}

int run(const std::vector<std::string>& words) {
  if (words.size() < 2) {
    std::fputs("prove-laboratory FOLDER SEED...\n", stderr);
    return 64;
  }
  std::printf("%4s  %-84s %-44s\n", "seed", "what was so (size, times what could be seen)", "named");
  Counts counts;
  for (std::size_t k = 1; k < words.size(); ++k) {
    const std::string folder_name = "laboratory-" + words[k];
    const path folder = path(words[0]) / folder_name;
    make_folder(folder);
    const LaboratoryCase sealed = laboratory_case(std::strtoull(words[k].c_str(), nullptr, 10), false, folder);
    if (!std::filesystem::exists(folder / "status.txt")) run_laboratory(sealed, 4, folder, path(words[0]) / "truths");
    judge_one(sealed, folder, counts);
  }
  const double share = counts.above > 0 ? static_cast<double>(counts.named_above) / counts.above : 1;
  const int allowed = counts.laboratories / 12;
  const bool all_named = share >= 0.9, none_invented = counts.invented <= allowed && counts.failed == 0;
  std::printf(
      "sealed-laboratory named of those above their detection limit: measured %d of %d (of %d of any size %d) "
      "required >= 90 %%%s\n",
      counts.named_above, counts.above, counts.there, counts.named, all_named ? "" : "  NOT MET");
  std::printf(
      "sealed-laboratory laboratories in which something was named that is not there: measured %d of %d, %d "
      "without an answer; required <= %d%s\n",
      counts.invented, counts.laboratories, counts.failed, allowed, none_invented ? "" : "  NOT MET");
  return all_named && none_invented ? 0 : 1;
}

}  // namespace
}  // namespace gonio::sealed

int main(int argc, char** argv) {
  try {
    return gonio::sealed::run({argv + 1, argv + argc});
  } catch (const gonio::Error& e) {
    std::fprintf(stderr, "prove-laboratory: %s\n", e.what());
    return 70;
  }
}
