#include "sealed/answer.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "base/atomic_file.h"
#include "io/exr.h"

namespace gonio::sealed {
namespace {

using manifest::Value;

double number_or(const Value* v, double otherwise) {
  return v != nullptr && v->is_number() ? v->as_number() : otherwise;
}
std::string text_or_nothing(const Value* v) {
  return v != nullptr && v->is_string() ? v->as_string() : std::string();
}
const Value::Array& list(const Value* v) {
  static const Value::Array none;
  return v != nullptr && v->is_array() ? v->as_array() : none;
}
const Value::Object& members(const Value* v) {
  static const Value::Object none;
  return v != nullptr && v->is_object() ? v->as_object() : none;
}

void add_unique(std::vector<std::string>& ids, const std::string& id) {
  if (std::find(ids.begin(), ids.end(), id) == ids.end()) ids.push_back(id);
}

// "lens.radial.k1" and "light-0/tilt_x_rad" bear the parameter's name behind the last separator.
std::string last_part(const std::string& name) {
  return name.substr(name.find_last_of("./") + 1);
}

void read_named(const Value& entry, Answer& a) {
  for (const Value& n : list(entry.find("named"))) {
    const std::string id = text_or_nothing(n.find("mechanism"));
    add_unique(a.named, id);
    for (const auto& [parameter, value] : members(n.find("parameters"))) {
      const Value* interval = n.find("interval_95") ? n.find("interval_95")->find(parameter) : nullptr;
      if (!value.is_number() || list(interval).size() != 2) continue;
      a.fitted.push_back({id, parameter, value.as_number(), number_or(&list(interval)[0], -INFINITY),
                          number_or(&list(interval)[1], INFINITY)});
    }
  }
  a.reported = a.named;
  a.set_size = a.named.size();
  for (const Value& set : list(entry.find("not_told_apart"))) {
    std::vector<std::string> ids;
    for (const Value& member : list(&set)) {
      if (member.is_string()) add_unique(ids, member.as_string());
      for (const Value& inner : list(&member))
        if (inner.is_string()) add_unique(ids, inner.as_string());
    }
    for (const std::string& id : ids) add_unique(a.reported, id);
    a.set_size = std::max(a.set_size, list(&set).size());
  }
}

void read_isolability(const Value& entry, Answer& a) {
  for (const Value& i : list(entry.find("isolability"))) {
    const std::string id = text_or_nothing(i.find("mechanism"));
    if (const Value* visible = i.find("visible"); visible && visible->is_bool() && !visible->as_bool())
      add_unique(a.invisible, id);
    for (const auto& [key, into] :
         {std::pair{"detection_limit", &a.limit}, {"limit_with_others", &a.limit_with_others}})
      for (const auto& [name, limit] : members(i.find(key))) {
        double& least = (*into)[id].try_emplace(last_part(name), INFINITY).first->second;
        least = std::min(least, number_or(&limit, INFINITY));
      }
  }
}

// One explanation of the document: the first of the case's domain.
void read_entry(const Value& entry, Answer& a) {
  a.verdict = text_or_nothing(entry.find("verdict"));
  read_named(entry, a);
  read_isolability(entry, a);
  for (const Value& m : list(entry.find("minor")))
    add_unique(a.minor, m.is_string() ? m.as_string() : text_or_nothing(m.find("mechanism")));
  if (const Value* located = entry.find("located"); located && located->is_object()) {
    a.condition = text_or_nothing(located->find("condition"));
    a.stage = text_or_nothing(located->find("stage"));
  }
  if (const Value* h = entry.find("held_out"); h && h->is_object()) {
    a.before = number_or(h->find("before"), NAN);
    a.after = number_or(h->find("after"), NAN);
  }
  if (const Value* p = entry.find("probability"); p && p->is_number()) a.probability = p->as_number();
  a.sentence = text_or_nothing(entry.find("sentence"));
}

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      fields.emplace_back();
    else if (c != '\r')
      fields.back() += c;
  }
  return fields;
}

// What explain calls the domain of a world.
std::string domain_of(const Spec& spec) {
  for (const char* same : {"boards", "robot", "images", "heights", "volumes"})
    if (spec.domain == same) return spec.domain;
  return spec.domain == "exposures" || spec.domain == "photometric" ? "stacks" : "tables";
}

struct Evidence {
  Numbers observed, effect;
  std::vector<std::string> group;
};
Evidence read_evidence(const std::filesystem::path& file) {
  const std::string text = read_file(file);
  Evidence e;
  std::size_t observed = 0, effect = 0, group = 0;
  for (std::size_t at = 0, line = 0; at < text.size(); ++line) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::vector<std::string> fields = split(text.substr(at, end - at));
    at = end + 1;
    if (line == 0) {
      const auto place = [&](const char* name) {
        return static_cast<std::size_t>(std::find(fields.begin(), fields.end(), name) - fields.begin());
      };
      observed = place("observed"), effect = place("effect"), group = place("group");
      continue;
    }
    if (fields.size() <= std::max({observed, effect, group})) continue;
    e.observed.push_back(std::atof(fields[observed].c_str()));
    e.effect.push_back(std::atof(fields[effect].c_str()));
    e.group.push_back(fields[group]);
  }
  return e;
}

// Root mean squares of `count` runs of equal length.
Numbers of_runs(const Numbers& values, std::size_t count) {
  Numbers rms(count);
  for (std::size_t i = 0; i < values.size(); ++i) rms[i * count / values.size()] += values[i] * values[i];
  for (double& v : rms) v = std::sqrt(v * static_cast<double>(count) / static_cast<double>(values.size()));
  return rms;
}

struct Ranked {
  Numbers score, effect;  // the answer's, the truth's
};
void set_areas(const Ranked& r, Answer& a) {
  a.auc = area_under_curve(r.score, affected(r.effect, true));
  a.auc_any = area_under_curve(r.score, affected(r.effect, false));
}

// Rows of the evidence are the case's rows, known by the value that was observed where that is written in its own unit,
// else by their order: the makers write groups one after the other. Where they are not as many (a robot's poses against
// corners), groups are compared.
void ask_evidence(const std::filesystem::path& file, const Case& sealed, Answer& a) {
  const Evidence e = read_evidence(file);
  std::vector<std::pair<double, double>> truth;
  Numbers in_order;
  for (const Observed& o : sealed.observed) {
    truth.emplace_back(o.value, std::abs(o.effect));
    in_order.push_back(std::abs(o.effect));
  }
  std::sort(truth.begin(), truth.end());
  Ranked known;
  for (std::size_t k = 0; k < e.observed.size(); ++k) {
    const double value = e.observed[k], slack = 1e-6 * std::abs(value) + 1e-300;
    const auto near = std::lower_bound(truth.begin(), truth.end(), std::pair{value - slack, 0.0});
    if (near == truth.end() || near->first > value + slack) continue;
    known.score.push_back(e.effect[k]);
    known.effect.push_back(near->second);
  }
  if (!truth.empty() && 10 * known.score.size() > 9 * truth.size()) return set_areas(known, a);
  if (e.effect.size() == in_order.size()) return set_areas({e.effect, in_order}, a);
  const std::size_t groups = std::set<std::string>(e.group.begin(), e.group.end()).size();
  if (groups == 0 || in_order.empty() || e.effect.size() % groups != 0 || in_order.size() % groups != 0) return;
  set_areas({of_runs(e.effect, groups), of_runs(in_order, groups)}, a);
}

// Masks that images and stacks write, effect-ID.exr, against the effect on every pixel.
void ask_masks(const std::filesystem::path& folder, const Case& sealed, Answer& a) {
  Ranked r;
  for (const auto& [id, effect] : sealed.pixels) {
    const std::filesystem::path file = folder / ("effect-" + id + ".exr");
    if (!std::filesystem::exists(file)) continue;
    const io::Image mask = io::decode_exr(read_file(file), file.string());
    if (mask.pixels() != effect.size()) continue;
    for (std::size_t p = 0; p < effect.size(); ++p) {
      r.score.push_back(mask.data[p * mask.channels.size()]);
      r.effect.push_back(effect[p]);
    }
  }
  if (!r.score.empty()) set_areas(r, a);
}

}  // namespace

std::vector<bool> affected(const Numbers& effect, bool most) {
  double squares = 0;
  for (const double e : effect) squares += e * e;
  const double least = most ? std::sqrt(squares / std::max<double>(1, static_cast<double>(effect.size()))) : 0;
  std::vector<bool> marks;
  for (const double e : effect) marks.push_back(e >= std::max(1.0, least));
  return marks;
}

std::optional<double> area_under_curve(const Numbers& score, const std::vector<bool>& affected) {
  const auto positive = static_cast<double>(std::count(affected.begin(), affected.end(), true));
  const double negative = static_cast<double>(affected.size()) - positive;
  if (std::min(positive, negative) < 0.05 * static_cast<double>(affected.size()) || affected.size() < 20) return {};
  std::vector<std::size_t> order(score.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return score[a] < score[b]; });
  double ranks = 0;  // of the affected, ties shared (Mann & Whitney 1947)
  for (std::size_t first = 0; first < order.size();) {
    std::size_t last = first;
    while (last < order.size() && score[order[last]] == score[order[first]]) ++last;
    for (std::size_t k = first; k < last; ++k)
      if (affected[order[k]]) ranks += 0.5 * static_cast<double>(first + last + 1);
    first = last;
  }
  return (ranks - 0.5 * positive * (positive + 1)) / (positive * negative);
}

Declared declared_conditions(const std::string& list) {
  Declared declared;
  std::string id;
  bool seen = false;
  for (std::size_t at = 0; at < list.size();) {
    const std::size_t end = std::min(list.find('\n', at), list.size());
    const std::string line = list.substr(at, end - at);
    at = end + 1;
    const std::size_t first = line.find_first_not_of(' ');
    if (first == std::string::npos) continue;
    if (first == 0) id = line.find(' ') == std::string::npos ? line : "";
    if (first < 6) seen = line.starts_with("    seen in: ");
    if (!seen || id.empty()) continue;
    const std::string text = line.substr(line.starts_with("    seen in: ") ? 13 : first);
    for (std::size_t from = 0; from < text.size();) {
      const std::size_t to = std::min(text.find(',', from), text.size()), start = text.find_first_not_of(' ', from);
      if (start < to) declared[id].push_back(text.substr(start, to - start));
      from = to + 1;
    }
  }
  return declared;
}

Answer read_answer(const std::filesystem::path& folder, const Case& sealed) {
  Answer a;
  if (std::filesystem::exists(folder / "status.txt")) {
    const std::string status = read_file(folder / "status.txt");
    double user = 0, system = 0;
    a.begun = true;
    if (std::sscanf(status.c_str(), "%d %lf %lf %lf", &a.exit, &a.seconds, &user, &system) < 1) a.exit = 70;
    a.processor_seconds = user + system;
  }
  const std::filesystem::path out = folder / "out.json";
  if (!std::filesystem::exists(out)) {
    if (std::filesystem::exists(folder / "stderr.txt")) a.error = read_file(folder / "stderr.txt");
    return a;
  }
  const Value document = manifest::parse_json(read_file(out), out.string());
  const Value::Array& explanations = list(document.find("explanations"));
  if (explanations.empty()) return a;
  a.ran = true;
  std::size_t own = 0;
  for (std::size_t k = 0; k < explanations.size(); ++k)
    if (text_or_nothing(explanations[k].find("domain")) == domain_of(sealed.spec)) own = k;
  read_entry(explanations[own], a);
  for (std::size_t k = 0; k < explanations.size(); ++k)
    for (const Value& n : list(explanations[k].find("named")))
      if (k != own) add_unique(a.elsewhere, text_or_nothing(n.find("mechanism")));
  if (!sealed.pixels.empty()) {
    ask_masks(folder / "out", sealed, a);
  } else if (const auto file = folder / "out" / ("evidence-" + domain_of(sealed.spec) + ".csv");
             std::filesystem::exists(file)) {
    ask_evidence(file, sealed, a);
  }
  return a;
}

}  // namespace gonio::sealed
