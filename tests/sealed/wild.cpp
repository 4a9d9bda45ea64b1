#include "sealed/wild.h"

#include <algorithm>
#include <cstring>

#include "base/atomic_file.h"
#include "base/error.h"

namespace gonio::sealed {
namespace {

using manifest::Value;
using std::filesystem::path;

const Value& member(const Value& of, const char* key, const std::string& place) {
  const Value* found = of.find(key);
  if (!found) throw Error(Exit::data, place + "/" + key, "is missing", "record the case again");
  return *found;
}

Kind kind_of_word(const std::string& word, const std::string& place) {
  for (const Kind kind : {Kind::null, Kind::distractor, Kind::single, Kind::pair, Kind::outside})
    if (kind_name(kind) == word) return kind;
  throw Error(Exit::data, place + "/kind", "\"" + word + "\" is no kind of case", "record the case again");
}

std::string effect_name(const Value& effect, const std::string& place) {
  return member(effect, "name", place).as_string();
}

// Changes of the readings in noise widths, the largest of a pixel's three, picture after picture.
void read_changes(const path& file, const Value& truth, const std::string& place, Case& into) {
  if (!std::filesystem::exists(file)) return;
  const std::string bytes = read_file(file);
  std::size_t at = 0;
  for (const Value& picture : member(truth, "pictures", place).as_array()) {
    const auto count = static_cast<std::size_t>(member(picture, "width", place).as_number() *
                                                member(picture, "height", place).as_number());
    if (at + 12 * count > bytes.size())
      throw Error(Exit::data, file.string(), "is shorter than its pictures", "record the case again");
    std::vector<float>& pixels = into.pixels[member(picture, "id", place).as_string()];
    for (std::size_t p = 0; p < count; ++p, at += 12) {
      float rgb[3];
      std::memcpy(rgb, bytes.data() + at, sizeof rgb);
      pixels.push_back(std::max({rgb[0], rgb[1], rgb[2]}));
    }
  }
}

void enter_effect(const Value& effect, const Rights& rights, const std::string& place, Truth& truth) {
  const std::string name = effect_name(effect, place);
  const auto right = rights.find(name);
  if (right == rights.end()) throw Error(Exit::data, place, "\"" + name + "\" is not in right.json", "enter it");
  if (!right->second.empty()) truth.mechanisms.push_back(right->second.front());
  const double share = member(effect, "fair_relative_rms", place).as_number();
  const double length = member(effect, "fair_length", place).as_number();
  const bool first = truth.world.empty();
  truth.share = first ? share : std::min(truth.share, share);
  truth.strength = first ? length : std::min(truth.strength, length);
  truth.world += (first ? "" : " + ") + name;
  for (const Value& v : member(effect, "values", place).as_array())
    if (!right->second.empty() && member(v, "mechanism", place).as_string() == right->second.front())
      truth.values.push_back({right->second.front(), member(v, "parameter", place).as_string(),
                              member(v, "value", place).as_number(), member(v, "exact", place).as_bool(), true});
}

bool holds(const std::vector<std::string>& list, const std::string& id) {
  return std::find(list.begin(), list.end(), id) != list.end();
}
bool nothing_wrong(const Judged& j) {
  return j.truth.kind == Kind::null || j.truth.kind == Kind::distractor;
}
bool names_anything(const Judged& j) {
  return !j.answer.named.empty() || !j.answer.elsewhere.empty();
}
bool names_what_is_not_there(const Judged& j) {
  return std::any_of(j.answer.named.begin(), j.answer.named.end(),
                     [&](const std::string& id) { return !holds(j.truth.mechanisms, id); });
}
bool names_alone(const Judged& j) {
  return !j.answer.named.empty() && j.answer.reported.size() == j.answer.named.size();
}
bool clear_alone(const Judged& j) {
  return j.truth.kind == Kind::single && clearly_there(j);
}
bool first_or_among_three(const Judged& j) {
  const std::string& id = j.truth.mechanisms.at(0);
  if (!j.answer.named.empty() && j.answer.named[0] == id) return true;
  return holds(j.answer.reported, id) && j.answer.set_size <= 3;
}
bool clear_outside(const Judged& j) {
  return j.truth.kind == Kind::outside && clearly_there(j);
}

}  // namespace

Rights read_rights(const path& file) {
  Rights rights;
  const Value table = manifest::parse_json(read_file(file), file.string());
  for (const auto& [effect, names] : table.as_object())
    for (rights[effect]; const Value& name : names.as_array()) rights[effect].push_back(name.as_string());
  return rights;
}

Case read_wild_truth(const path& truths, const std::string& name, const Rights& rights) {
  const path file = truths / (name + ".json");
  const Value truth = manifest::parse_json(read_file(file), file.string());
  Case made;
  made.id = name;
  made.spec.domain = "images";
  made.spec.seed = static_cast<std::uint64_t>(member(truth, "seed", file.string()).as_number());
  made.truth.kind = kind_of_word(member(truth, "kind", file.string()).as_string(), file.string());
  made.truth.apart = Apart::yes;  // as far as anybody counted; what names alike is in right.json
  const Value::Array& effects = member(truth, "effects", file.string()).as_array();
  for (const Value& effect : effects) enter_effect(effect, rights, file.string(), made.truth);
  if (effects.size() == 1) made.truth.kind = made.truth.mechanisms.empty() ? Kind::outside : Kind::single;
  for (const Value& d : member(truth, "distractors", file.string()).as_array())
    made.truth.world += (made.truth.world.empty() ? "with " : ", with ") + effect_name(d, file.string());
  made.truth.floor = member(truth, "floor", file.string()).as_number();
  made.truth.floor_known = true;
  if (!made.truth.mechanisms.empty()) read_changes(truths / (name + ".effect"), truth, file.string(), made);
  return made;
}

void use_first_names(const Case& made, const Rights& rights, Answer& answer) {
  std::map<std::string, std::string> first;
  for (const auto& [effect, names] : rights)
    if (!names.empty() && holds(made.truth.mechanisms, names.front()))
      for (const std::string& name : names) first.emplace(name, names.front());
  const auto rename = [&](std::vector<std::string>& ids) {
    std::vector<std::string> renamed;
    for (const std::string& id : ids) {
      const auto found = holds(made.truth.mechanisms, id) ? first.end() : first.find(id);
      const std::string& name = found == first.end() ? id : found->second;
      if (!holds(renamed, name)) renamed.push_back(name);
    }
    ids = renamed;
  };
  for (std::vector<std::string>* ids : {&answer.named, &answer.reported, &answer.elsewhere}) rename(*ids);
}

Asking wild_asking() {
  const auto always = [](const Judged&) { return true; };
  const auto both = [](const Judged& j) {
    return j.truth.kind == Kind::pair && j.truth.mechanisms.size() == 2 && clearly_there(j);
  };
  Asking asking;
  asking.repaired = 0.85;
  asking.questions = {
      {share_question("nothing left out (incl. distractors)", "wrongly named", "<= 2 %", 0.02, true), nothing_wrong,
       names_anything},
      {share_question("present at 3x the detection limit", "found", ">= 95 %", 0.95, false), clear_alone,
       [](const Judged& j) { return j.answer.verdict != "null"; }},
      {share_question("which", "named first, or in a set of at most three", ">= 90 %", 0.9, false), clear_alone,
       first_or_among_three},
      {share_question("which", "named first", "", 0.9, false, false), clear_alone,
       [](const Judged& j) { return !j.answer.named.empty() && j.answer.named[0] == j.truth.mechanisms[0]; }},
      {share_question("falsely certain", "named alone, without alternatives, and wrong", "<= 2 %", 0.02, true), always,
       [](const Judged& j) { return names_alone(j) && names_what_is_not_there(j); }},
      {share_question("two at once", "both named", ">= 75 %", 0.75, false), both,
       [](const Judged& j) {
         return holds(j.answer.named, j.truth.mechanisms[0]) && holds(j.answer.named, j.truth.mechanisms[1]);
       }},
      {share_question("outside the library", "wrongly named as a known one", "<= 5 %", 0.05, true),
       [](const Judged& j) { return j.truth.kind == Kind::outside; }, names_anything},
      {share_question("outside the library", "reported as a mismatch that nothing known repairs", "", 0, false, false),
       clear_outside, [](const Judged& j) { return j.answer.verdict == "unknown"; }},
      {share_question("where", "AUC of the evidence >= 0.9", "", 0.9, false, false),
       [](const Judged& j) { return clear_alone(j) && j.answer.auc.has_value(); },
       [](const Judged& j) { return *j.answer.auc >= 0.9; }},
      {share_question("present, any size", "something named that is not there", "", 0, true, false),
       [](const Judged& j) { return !nothing_wrong(j); }, names_what_is_not_there},
  };
  return asking;
}

}  // namespace gonio::sealed
