// The weights behind the stated probabilities (inference/probability.h), and what these are worth.
//   prove-probability fit SOURCE...     estimates the weights by penalised maximum likelihood; prints table and
//   figures,
//                                       these by tenfold cross-validation
//   prove-probability check SOURCE...   figures of the probabilities as they were stated
// SOURCE: sealed:FOLDER (what prove-sealed judged: FOLDER.truth.json beside it) or wild:ANSWERS:TRUTHS (folders of
// NNN/out.json and NNN.json). Development seeds only for `fit`.
//
// A member of the comparison is right where its mechanisms are those that were left out, each once; "nothing" where
// nothing was, or nothing that matters; "outside" where none of the others is: what the search has missed is as good as
// outside for the weights. For the figures "outside" is right where something outside acts, as the proofs' judge has
// it. Weights have sane signs and are pulled towards those in the table, each by a Gaussian prior of its own width, so
// that a hundred cases cannot bend them far.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <numeric>

#include "base/atomic_file.h"
#include "base/error.h"
#include "inference/judgement.h"
#include "inference/probability.h"
#include "manifest/value.h"

namespace gonio::prove {
namespace {

using inference::Member;
using manifest::Value;
using std::filesystem::path;
using Rights = std::vector<std::vector<std::string>>;  // for each effect left out, the ids that count

constexpr double matters = 0.01, sure = 0.9;
constexpr double prior_width = 0.7;      // of a weight, relative to itself and at least this much
constexpr double most_of_a_domain = 60;  // cases that a domain counts for
constexpr std::size_t folds = 10;
constexpr int bins = 10;

struct Case {
  std::string id, domain;
  std::vector<Member> members;
  std::vector<char> right;
  std::vector<double> stated;
  bool significant = false, outside = false;  // outside: something acts that the library has not
};

const Value::Array& list_in(const Value& v, const char* key) {
  static const Value::Array none;
  const Value* found = v.find(key);
  return found != nullptr && found->is_array() ? found->as_array() : none;
}
std::string text_in(const Value& v, const char* key) {
  const Value* found = v.find(key);
  return found != nullptr && found->is_string() ? found->as_string() : "";
}
double number_in(const Value& v, const char* key, double otherwise) {
  const Value* found = v.find(key);
  return found != nullptr && found->is_number() ? found->as_number() : otherwise;
}
std::vector<std::string> texts(const Value::Array& list) {
  std::vector<std::string> result;
  for (const Value& v : list) result.push_back(v.as_string());
  return result;
}
std::string physics(const std::string& id) {  // a lamp elsewhere: one line of the list of mechanisms, two of its ids
  return id == "light.position" ? "light.direction" : id;
}

// Is it a one-to-one match, whatever the order?
bool matches(std::vector<std::string> ids, const Rights& rights) {
  if (ids.size() != rights.size()) return false;
  std::sort(ids.begin(), ids.end());
  do {
    bool all = true;
    for (std::size_t k = 0; k < ids.size(); ++k)
      all = all && std::any_of(rights[k].begin(), rights[k].end(),
                               [&](const std::string& r) { return physics(r) == physics(ids[k]); });
    if (all) return true;
  } while (std::next_permutation(ids.begin(), ids.end()));
  return false;
}

// `required`: effects that matter; `allowed`: these and others that are there.
Case case_of(const Value& entry, const Rights& required, const Rights& allowed, bool outside) {
  Case c;
  c.outside = outside;
  if (const Value* null_test = entry.find("null_test"))
    c.significant = null_test->find("significant") != nullptr && null_test->find("significant")->as_bool();
  for (const Value& w : list_in(entry, "weighed")) {
    Member m;
    const std::string answer = text_in(w, "answer");
    m.kind = answer == "nothing"   ? Member::Kind::nothing
             : answer == "outside" ? Member::Kind::outside
                                   : Member::Kind::set;
    if (const Value* s = w.find("statistics"))
      for (const inference::Statistic& of : inference::statistics())
        m.statistics.*of.value = number_in(*s, std::string(of.name).c_str(), 0);
    const std::vector<std::string> ids = texts(list_in(w, "mechanisms"));
    const bool right = m.kind == Member::Kind::set
                           ? !outside && (matches(ids, allowed) || (!required.empty() && matches(ids, required)))
                           : m.kind == Member::Kind::nothing && required.empty() && !outside;
    c.members.push_back(m);
    c.right.push_back(right);
    c.stated.push_back(number_in(w, "probability", 0));
  }
  if (std::none_of(c.right.begin(), c.right.end(), [](char r) { return r != 0; }))
    for (std::size_t k = 0; k < c.members.size(); ++k) c.right[k] = c.members[k].kind == Member::Kind::outside;
  // What falls to nothing, or to outside, is right with it.
  for (std::size_t k = 0; k < c.members.size(); ++k) {
    std::vector<double> alone(c.members.size());
    alone[k] = 1;
    const inference::Rest rest = inference::rest_of(c.members, alone);
    for (std::size_t j = 0; j < c.members.size(); ++j)
      if (c.right[j] != 0 && ((rest.nothing > 0 && c.members[j].kind == Member::Kind::nothing) ||
                              (rest.outside > 0 && c.members[j].kind == Member::Kind::outside)))
        c.right[k] = 1;
  }
  return c;
}

void add(const Value& document, const std::string& id, const std::string& domain, const Rights& required,
         const Rights& allowed, bool outside, std::vector<Case>& cases) {
  const Value::Array& entries = list_in(document, "explanations");
  if (entries.empty()) return;
  const Value* own = &entries[0];
  for (const Value& e : entries)
    if (text_in(e, "domain") == domain) own = &e;
  Case c = case_of(*own, required, allowed, outside);
  if (c.members.empty()) return;
  // Where nothing is significant and something is there, these recordings cannot show it: no set was weighed.
  if (!c.significant && (outside || !required.empty())) return;
  c.id = id, c.domain = domain;
  cases.push_back(std::move(c));
}

void read_sealed(const path& folder, std::vector<Case>& cases) {
  const path file = folder.string() + ".truth.json";
  const Value truths = manifest::parse_json(read_file(file), file.string());
  for (const auto& [id, t] : truths.as_object()) {
    const path out = folder / id / "out.json";
    if (!std::filesystem::exists(out)) continue;
    const std::string kind = text_in(t, "kind");
    Rights there;
    for (const std::string& m : texts(list_in(t, "mechanisms"))) there.push_back({m});
    const bool tells = kind != "null" && kind != "distractor" && kind != "invisible";
    const bool large = tells && number_in(t, "share", 0) >= matters;
    add(manifest::parse_json(read_file(out), out.string()), id, text_in(t, "domain"), large ? there : Rights{}, there,
        kind == "outside" && large, cases);
  }
}

void read_wild(const path& answers, const path& truths, std::vector<Case>& cases) {
  const path names = path(GONIO_SOURCE) / "tests" / "wild" / "right.json";
  const Value counted = manifest::parse_json(read_file(names), names.string());
  for (const auto& at : std::filesystem::directory_iterator(answers)) {
    const std::string id = at.path().filename().string();
    const path out = at.path() / "out.json", truth = truths / (id + ".json");
    if (!std::filesystem::exists(out) || !std::filesystem::exists(truth)) continue;
    const Value t = manifest::parse_json(read_file(truth), truth.string());
    Rights required, allowed;
    bool outside = false;
    for (const Value& e : list_in(t, "effects")) {
      const std::vector<std::string> right = texts(list_in(counted, text_in(e, "name").c_str()));
      const bool large = number_in(e, "fair_relative_rms", 0) >= matters;
      outside = outside || (right.empty() && large);
      if (right.empty()) continue;
      allowed.push_back(right);
      if (large) required.push_back(right);
    }
    add(manifest::parse_json(read_file(out), out.string()), id, "images", required, allowed, outside, cases);
    if (!cases.empty() && cases.back().id == id) cases.back().domain = "wild";
  }
}

inference::Simulator simulator_of(const Case& c) {
  return c.domain == "wild" || c.domain == "images" ? inference::Simulator::errs : inference::Simulator::exact;
}

double chance_of_right(const Case& c, const std::vector<double>& p) {
  double sum = 0;
  for (std::size_t k = 0; k < p.size(); ++k) sum += c.right[k] != 0 ? p[k] : 0;
  return std::max(sum, 1e-12);
}

// Projected gradient ascent of the penalised log likelihood, by backtracking.
class Estimator {
 public:
  // Of cases of one kind of simulator.
  Estimator(const std::vector<const Case*>& cases, inference::Simulator simulator)
      : cases_(cases), start_(inference::weights_of(simulator)) {
    std::map<std::string, double> count;
    for (const Case* c : cases) ++count[c->domain];
    for (const Case* c : cases) share_.push_back(std::min(1.0, most_of_a_domain / count[c->domain]));
  }
  std::vector<double> weights() const {
    std::vector<double> w = start_, g;
    double step = 0.01, value = objective(w, g);
    for (int k = 0; k < 4000 && step > 1e-9; ++k) {
      std::vector<double> next = w;
      for (std::size_t t = 0; t < w.size(); ++t) {
        const int sign = inference::logit_terms()[t].sign;
        next[t] += step * g[t];
        if (sign != 0 && next[t] * sign < 0) next[t] = 0;
      }
      std::vector<double> slope;
      const double at = objective(next, slope);
      if (at < value) {
        step /= 3;
        continue;
      }
      w = std::move(next), g = std::move(slope), value = at, step *= 1.3;
    }
    return w;
  }

 private:
  double objective(const std::vector<double>& w, std::vector<double>& gradient) const {
    gradient.assign(w.size(), 0.0);
    double value = 0;
    const auto all = inference::logit_terms();
    for (std::size_t i = 0; i < cases_.size(); ++i) {
      const Case& c = *cases_[i];
      const std::vector<double> p = inference::probabilities(c.members, w);
      const double right = chance_of_right(c, p);
      value += share_[i] * std::log(right);
      for (std::size_t k = 0; k < p.size(); ++k) {
        const double pull = share_[i] * ((c.right[k] != 0 ? p[k] / right : 0) - p[k]);
        if (pull == 0) continue;
        for (std::size_t t = 0; t < w.size(); ++t) gradient[t] += pull * all[t].of(c.members[k]);
      }
    }
    for (std::size_t t = 0; t < w.size(); ++t) {
      const double width = prior_width * std::max(1.0, std::abs(start_[t]));
      value -= 0.5 * std::pow((w[t] - start_[t]) / width, 2);
      gradient[t] -= (w[t] - start_[t]) / (width * width);
    }
    return value;
  }
  std::vector<const Case*> cases_;
  std::vector<double> start_, share_;
};

struct Figures {
  std::vector<double> stated;
  std::vector<char> held;
  int alone = 0, alone_wrong = 0, listed = 0, listed_right = 0, library = 0, quiet = 0, quiet_named = 0, foreign = 0,
      foreign_named = 0;
  double log_loss = 0;
  int cases = 0;
};
void ask(const Case& c, const std::vector<double>& p, Figures& f) {
  inference::Answer a = inference::answer(c.members, p, sure);
  if (!c.significant) a = {inference::Answer::Kind::nothing, {}, inference::rest_of(c.members, p).nothing};
  if (a.kind == inference::Answer::Kind::outside) a.probability *= inference::share_outside(simulator_of(c));
  bool held = false, nothing = false;
  for (std::size_t k = 0; k < p.size(); ++k)
    nothing = nothing || (c.right[k] != 0 && c.members[k].kind == Member::Kind::nothing);
  held = (nothing && a.kind == inference::Answer::Kind::nothing) ||
         (c.outside && a.kind == inference::Answer::Kind::outside);
  for (const std::size_t k : a.sets) held = held || c.right[k] != 0;
  f.stated.push_back(a.probability);
  f.held.push_back(held);
  f.log_loss -= std::log(chance_of_right(c, p));
  ++f.cases;
  f.alone += a.sets.size() == 1;
  f.alone_wrong += a.sets.size() == 1 && !held;
  f.quiet += nothing, f.quiet_named += nothing && !a.sets.empty();
  f.foreign += c.outside, f.foreign_named += c.outside && !a.sets.empty();
  if (nothing || c.outside) return;
  ++f.library;
  f.listed += !a.sets.empty();
  f.listed_right += !a.sets.empty() && held;
}

// Expected calibration error over bins of equal width (Naeini, Cooper & Hauskrecht, AAAI 2015).
double calibration_error(const Figures& f, bool print) {
  double error = 0;
  for (int b = 0; b < bins; ++b) {
    double n = 0, sum = 0, held = 0;
    for (std::size_t k = 0; k < f.stated.size(); ++k)
      if (std::min(bins - 1, static_cast<int>(f.stated[k] * bins)) == b) ++n, sum += f.stated[k], held += f.held[k];
    if (n == 0) continue;
    error += std::abs(sum - held) / static_cast<double>(f.stated.size());
    if (print) std::printf("  stated %.2f: held %.2f of %.0f\n", sum / n, held / n, n);
  }
  return error;
}

void print(const std::map<std::string, Figures>& by_domain) {
  std::printf("%-12s %5s %9s %6s | %12s %16s %14s %14s\n", "domain", "cases", "log loss", "ECE", "alone, wrong",
              "listed and right", "quiet, named", "outside, named");
  for (const auto& [domain, f] : by_domain)
    std::printf("%-12s %5d %9.3f %6.3f | %5d of %3d  %5d of %3d (%3d)  %4d of %4d   %4d of %4d\n", domain.c_str(),
                f.cases, f.log_loss / std::max(1, f.cases), calibration_error(f, false), f.alone_wrong, f.alone,
                f.listed_right, f.library, f.listed, f.quiet_named, f.quiet, f.foreign_named, f.foreign);
  calibration_error(by_domain.at("all"), true);
}

// Fitted to all of them, beside those in the table; then the cases that fit worst, to look at.
void tell_weights(const std::vector<const Case*>& cases, inference::Simulator simulator) {
  const std::vector<double> w = Estimator(cases, simulator).weights(), known = inference::weights_of(simulator);
  std::printf("%s\n", simulator == inference::Simulator::exact ? "exact simulators" : "simulators that err");
  for (std::size_t t = 0; t < w.size(); ++t)
    std::printf("%-10s %7.2f  (%.2f)\n", std::string(inference::logit_terms()[t].name).c_str(), w[t], known[t]);
  for (const Case* c : cases)
    if (const double right = chance_of_right(*c, inference::probabilities(c->members, w)); right < 0.2)
      std::printf("  %s %s%s: %.3f to what is right\n", c->domain.c_str(), c->id.c_str(),
                  c->significant ? "" : ", not significant", right);
}

int run(const std::vector<std::string>& words) {
  std::vector<Case> cases;
  for (std::size_t k = 1; k < words.size(); ++k) {
    const std::size_t first = words[k].find(':'), second = words[k].find(':', first + 1);
    if (words[k].starts_with("sealed:")) read_sealed(words[k].substr(first + 1), cases);
    if (words[k].starts_with("wild:"))
      read_wild(words[k].substr(first + 1, second - first - 1), words[k].substr(second + 1), cases);
  }
  if (cases.empty() || (words[0] != "fit" && words[0] != "check")) {
    std::fputs("prove-probability fit|check sealed:FOLDER|wild:ANSWERS:TRUTHS...\n", stderr);
    return 64;
  }
  std::map<std::string, Figures> figures;
  const auto tell = [&](const Case& c, const std::vector<double>& p) {
    ask(c, p, figures[c.domain]);
    ask(c, p, figures["all"]);
  };
  if (words[0] == "check") {
    for (const Case& c : cases) tell(c, c.stated);
    print(figures);
    return 0;
  }
  for (const inference::Simulator simulator : {inference::Simulator::exact, inference::Simulator::errs}) {
    std::vector<const Case*> own;
    for (const Case& c : cases)
      if (simulator_of(c) == simulator) own.push_back(&c);
    for (std::size_t fold = 0; fold < folds && !own.empty(); ++fold) {
      std::vector<const Case*> others;
      for (std::size_t k = 0; k < own.size(); ++k)
        if (k % folds != fold) others.push_back(own[k]);
      const std::vector<double> w = Estimator(others, simulator).weights();
      for (std::size_t k = fold; k < own.size(); k += folds)
        tell(*own[k], inference::probabilities(own[k]->members, w));
    }
  }
  print(figures);
  for (const inference::Simulator simulator : {inference::Simulator::exact, inference::Simulator::errs}) {
    std::vector<const Case*> own;
    for (const Case& c : cases)
      if (simulator_of(c) == simulator) own.push_back(&c);
    if (!own.empty()) tell_weights(own, simulator);
  }
  return 0;
}

}  // namespace
}  // namespace gonio::prove

int main(int argc, char** argv) {
  try {
    return gonio::prove::run({argv + 1, argv + argc});
  } catch (const std::exception& e) {
    std::fprintf(stderr, "prove-probability: %s\n", e.what());
    return 70;
  }
}
