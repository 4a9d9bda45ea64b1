// scripts/proofs/sealed: makes the sealed cases, and judges the answers when all are in.
//   prove-sealed make FOLDER quick|full [DOMAIN...]    folders with recording.json; prints the seal of every truth
//   prove-sealed list FOLDER quick|full [DOMAIN...]    the cases' folders, one a line
//   prove-sealed judge FOLDER quick|full [DOMAIN...]   table on stdout; FOLDER.html, FOLDER.truth.json beside it;
//                                                      FOLDER/list.txt: what explain --list prints, if it is there
// Between the two no truth exists on any disk: judge computes it again from the same seeds and holds it against the
// seal. SEALED_SEEDS in the environment, a word, draws other seeds for every case: some to develop on, others to
// report.
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <numeric>
#include <set>
#include <thread>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/random.h"
#include "sealed/judge.h"
#include "sealed/worlds.h"

namespace gonio::sealed {
namespace {

using std::filesystem::path;

std::string seal_of(const Case& made) {
  Judged j{made.spec, made.truth, made.id, {}};
  return sha256(print_json(truth_json({j})));
}

template <class Work>
void for_all(std::size_t count, Work work) {
  std::atomic<std::size_t> next{0};
  const auto loop = [&] {
    for (std::size_t k = next++; k < count; k = next++) work(k);
  };
  std::thread other(loop);
  loop();
  other.join();
}

// Of the cases as they are planned where no word is given.
std::uint64_t seed_of(const Spec& spec) {
  const char* word = std::getenv("SEALED_SEEDS");
  std::uint64_t seed = spec.seed;
  for (const char* c = word == nullptr ? "" : word; *c != '\0'; ++c)
    seed = split_mix(seed ^ static_cast<unsigned char>(*c));
  return seed;
}

std::vector<Spec> chosen(bool quick, const std::vector<std::string>& domains) {
  std::set<std::string> known;
  for (const Spec& s : all_specs()) known.insert(s.domain);
  for (const std::string& domain : domains)
    if (!known.contains(domain))
      throw Error(Exit::usage, domain, "is no domain of sealed cases",
                  "give some of:" +
                      std::accumulate(known.begin(), known.end(), std::string(),
                                      [](const std::string& all, const std::string& one) { return all + " " + one; }));
  std::vector<Spec> specs;
  for (Spec& s : all_specs()) {
    s.seed = seed_of(s);
    const bool wanted = domains.empty() || std::find(domains.begin(), domains.end(), s.domain) != domains.end();
    if (wanted && (!quick || s.quick)) specs.push_back(std::move(s));
  }
  return specs;
}

// Every domain spread evenly over the list: however far a run comes, it has asked a fair share.
std::vector<Spec> spread(std::vector<Spec> specs) {
  std::map<std::string, double> count, met;
  for (const Spec& s : specs) ++count[s.domain];
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t k = 0; k < specs.size(); ++k)
    order.emplace_back((++met[specs[k].domain] - 0.5) / count[specs[k].domain], k);
  std::sort(order.begin(), order.end());
  std::vector<Spec> sorted;
  for (const auto& [place, k] : order) sorted.push_back(std::move(specs[k]));
  return sorted;
}

void make(const path& folder, const std::vector<Spec>& specs) {
  for_all(specs.size(), [&](std::size_t k) {
    const path own = folder / case_id(specs[k]);
    if (std::filesystem::exists(own / "recording.json")) return;
    const Case made = make_case(specs[k]);
    make_folder(own);
    write_file(folder / "seals" / made.id, seal_of(made) + "\n");
    for (const auto& [name, bytes] : made.files)
      if (name != "recording.json") write_file(own / name, bytes);
    write_file(own / "recording.json", made.files.at("recording.json"));
  });
  std::printf("%zu cases in %s\n", specs.size(), folder.c_str());
}

int judge_all(const path& folder, const std::vector<Spec>& specs, const std::string& mode) {
  std::vector<Judged> cases(specs.size());
  const path list = folder / "list.txt";
  const Declared declared = declared_conditions(std::filesystem::exists(list) ? read_file(list) : "");
  std::atomic<int> broken{0};
  for_all(specs.size(), [&](std::size_t k) {
    if (!std::filesystem::exists(folder / case_id(specs[k]) / "status.txt")) {  // not begun: nothing to judge
      cases[k] = {specs[k], {}, case_id(specs[k]), {}};
      return;
    }
    const Case made = make_case(specs[k]);
    cases[k] = {made.spec, made.truth, made.id, read_answer(folder / made.id, made)};
    for (const std::string& id : made.truth.mechanisms)  // what the library says of the mechanism is right, too
      if (const auto said = declared.find(id); said != declared.end())
        for (const std::string& condition : said->second) cases[k].truth.conditions.push_back(condition);
    const path seal = folder / "seals" / made.id;
    if (!std::filesystem::exists(seal) || read_file(seal) != seal_of(made) + "\n") ++broken;
  });
  const Judgement judgement = judge(cases);
  std::fputs(table_text(judgement).c_str(), stdout);
  write_file(folder.string() + ".html", page_html(judgement, cases, "scripts/prove sealed, mode " + mode));
  write_file(folder.string() + ".truth.json", print_json(truth_json(cases)) + "\n");
  if (broken > 0) std::printf("sealed: %d truths are not those that were sealed\n", broken.load());
  bool missed = broken > 0 || judgement.unanswered > 0;
  for (const Question& q : judgement.questions) {
    if (!q.required) continue;
    std::printf("sealed %s, %s: measured %s required %s%s\n", q.question.c_str(), q.measure.c_str(),
                q.measured().c_str(), q.to_reach.c_str(), q.met() ? "" : "  NOT MET");
    missed = missed || q.surely_missed();
  }
  return missed ? 1 : 0;
}

int run(const std::vector<std::string>& words) {
  if (words.size() < 3 || (words[2] != "quick" && words[2] != "full")) {
    std::fputs("prove-sealed make|list|judge FOLDER quick|full [DOMAIN...]\n", stderr);
    return 64;
  }
  const std::vector<Spec> specs = chosen(words[2] == "quick", {words.begin() + 3, words.end()});
  if (words[0] == "list")
    for (const Spec& s : spread(specs)) std::printf("%s\n", (path(words[1]) / case_id(s)).c_str());
  if (words[0] == "judge") return judge_all(words[1], specs, words[2]);
  if (words[0] == "make") {
    make_folder(path(words[1]) / "seals");
    make(words[1], specs);
  }
  return 0;
}

}  // namespace
}  // namespace gonio::sealed

int main(int argc, char** argv) {
  try {
    return gonio::sealed::run({argv + 1, argv + argc});
  } catch (const std::exception& e) {
    std::fprintf(stderr, "prove-sealed: %s\n", e.what());
    return 70;
  }
}
