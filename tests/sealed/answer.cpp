#include "sealed/answer.h"

#include <algorithm>
#include <cmath>
#include <numeric>

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
    a.set_size = std::max(a.set_size, ids.size());
  }
}

void read_isolability(const Value& entry, Answer& a) {
  for (const Value& i : list(entry.find("isolability"))) {
    const std::string id = text_or_nothing(i.find("mechanism"));
    if (const Value* visible = i.find("visible"); visible && visible->is_bool() && !visible->as_bool())
      add_unique(a.invisible, id);
    for (const auto& [name, limit] : members(i.find("detection_limit"))) {
      double& least = a.limit[id].try_emplace(last_part(name), INFINITY).first->second;
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
  for (const char* same : {"boards", "robot", "images", "heights"})
    if (spec.domain == same) return spec.domain;
  return spec.domain == "exposures" || spec.domain == "photometric" ? "stacks" : "tables";
}

struct Evidence {
  Numbers observed, effect;
};
Evidence read_evidence(const std::filesystem::path& file) {
  const std::string text = read_file(file);
  Evidence e;
  std::size_t observed = 0, effect = 0;
  for (std::size_t at = 0, line = 0; at < text.size(); ++line) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::vector<std::string> fields = split(text.substr(at, end - at));
    at = end + 1;
    if (line == 0) {
      const auto place = [&](const char* name) {
        return static_cast<std::size_t>(std::find(fields.begin(), fields.end(), name) - fields.begin());
      };
      observed = place("observed"), effect = place("effect");
      continue;
    }
    if (fields.size() <= std::max(observed, effect)) continue;
    e.observed.push_back(std::atof(fields[observed].c_str()));
    e.effect.push_back(std::atof(fields[effect].c_str()));
  }
  return e;
}

// Rows of the evidence are the case's rows, known by the value that was observed where that is written in its own unit,
// else by their order: the makers write groups one after the other.
std::optional<double> auc_of(const std::filesystem::path& file, const Case& sealed) {
  const Evidence e = read_evidence(file);
  std::vector<std::pair<double, double>> truth;
  for (const Observed& o : sealed.observed) truth.emplace_back(o.value, std::abs(o.effect));
  std::sort(truth.begin(), truth.end());
  Numbers score;
  std::vector<bool> affected;
  for (std::size_t k = 0; k < e.observed.size(); ++k) {
    const double value = e.observed[k], slack = 1e-6 * std::abs(value) + 1e-300;
    const auto near = std::lower_bound(truth.begin(), truth.end(), std::pair{value - slack, 0.0});
    if (near == truth.end() || near->first > value + slack) continue;
    score.push_back(e.effect[k]);
    affected.push_back(near->second >= 1);
  }
  if (10 * score.size() > 9 * truth.size()) return area_under_curve(score, affected);
  if (e.effect.size() != sealed.observed.size()) return {};
  affected.clear();
  for (const Observed& o : sealed.observed) affected.push_back(std::abs(o.effect) >= 1);
  return area_under_curve(e.effect, affected);
}

// Masks that images and stacks write, effect-ID.exr, against the effect on every pixel.
std::optional<double> auc_of_masks(const std::filesystem::path& folder, const Case& sealed) {
  Numbers score;
  std::vector<bool> affected;
  for (const auto& [id, effect] : sealed.pixels) {
    const std::filesystem::path file = folder / ("effect-" + id + ".exr");
    if (!std::filesystem::exists(file)) continue;
    const io::Image mask = io::decode_exr(read_file(file), file.string());
    if (mask.pixels() != effect.size()) continue;
    for (std::size_t p = 0; p < effect.size(); ++p) {
      score.push_back(mask.data[p * mask.channels.size()]);
      affected.push_back(effect[p] >= 1);
    }
  }
  return score.empty() ? std::nullopt : area_under_curve(score, affected);
}

}  // namespace

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

Answer read_answer(const std::filesystem::path& folder, const Case& sealed) {
  Answer a;
  if (std::filesystem::exists(folder / "status.txt")) {
    const std::string status = read_file(folder / "status.txt");
    if (std::sscanf(status.c_str(), "%d %lf", &a.exit, &a.seconds) < 1) a.exit = 70;
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
    a.auc = auc_of_masks(folder / "out", sealed);
  } else if (const auto file = folder / "out" / ("evidence-" + domain_of(sealed.spec) + ".csv");
             std::filesystem::exists(file)) {
    a.auc = auc_of(file, sealed);
  }
  return a;
}

}  // namespace gonio::sealed
