// The table of the proof, mechanism by mechanism.
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "sealed/judge.h"

namespace gonio::sealed {
namespace {

bool has(const std::vector<std::string>& list, const std::string& id) {
  return std::find(list.begin(), list.end(), id) != list.end();
}

void add(const Judged& j, EffectRow& row) {
  const bool named = has(j.answer.named, row.mechanism);
  ++row.cases;
  row.found += j.answer.verdict != "null";
  row.located += has(j.truth.conditions, j.answer.condition);
  row.first += !j.answer.named.empty() && j.answer.named[0] == row.mechanism;
  if (j.answer.auc) row.area.push_back(*j.answer.auc);
  row.before.push_back(j.answer.before);
  row.after.push_back(j.answer.after);
  if (j.truth.floor_known) row.floor.push_back(j.truth.floor);
  for (const TrueValue& t : j.truth.values)
    for (const Fitted& f : j.answer.fitted)
      if (named && t.value != 0 && f.mechanism == t.mechanism && f.parameter == t.parameter)
        row.error.push_back(std::abs(f.value / t.value - 1));
}

}  // namespace

std::vector<EffectRow> effect_rows(const std::vector<Judged>& cases) {
  std::map<std::pair<std::string, std::string>, EffectRow> rows;
  for (const Judged& j : cases) {
    const bool alone = j.truth.kind == Kind::single || j.truth.kind == Kind::alike;
    if (!alone || !j.answer.ran || j.truth.mechanisms.empty() || !clearly_there(j)) continue;
    EffectRow& row = rows[{j.spec.domain, j.truth.mechanisms[0]}];
    row.domain = j.spec.domain, row.mechanism = j.truth.mechanisms[0];
    add(j, row);
  }
  std::vector<EffectRow> list;
  for (auto& [key, row] : rows) list.push_back(std::move(row));
  return list;
}

}  // namespace gonio::sealed
