// What decides a plan, written canonically and hashed (planner.h).
#include <algorithm>

#include "acquisition/plan/planner.h"
#include "base/hash.h"
#include "manifest/document.h"
#include "manifest/section_tables.h"
#include "manifest/sections/file.h"
#include "manifest/sections/laboratory.h"
#include "manifest/value.h"

namespace gonio::acquisition {
namespace {

using manifest::Value;

void leave_out(Value& object, const std::vector<std::string>& keys) {
  std::erase_if(object.as_object(),
                [&](const Value::Member& m) { return std::ranges::find(keys, m.first) != keys.end(); });
}

// A file's content stands for its name. One without a hash stands for itself.
void by_content(Value& object, const std::string& key, const manifest::Document& document) {
  if (object.find(key) == nullptr) return;
  Value& name = object[key];
  const auto file = document.files.find(name.as_string());
  if (file != document.files.end() && !file->second.sha256.empty()) name = file->second.sha256;
}

void solids_by_content(Value* solids, const manifest::Document& document) {
  if (solids == nullptr || !solids->is_array()) return;
  for (Value& solid : solids->as_array()) by_content(solid, "mesh", document);
}

Value deciding_part(const manifest::Document& document, const manifest::Laboratory& laboratory) {
  Value whole = manifest::Codec<manifest::Laboratory>::write(laboratory), kept = Value::object();
  for (const char* key : {"robots", "obstacles", "limits"})
    if (whole.find(key) != nullptr) kept[key] = whole[key];
  if (kept.find("robots") != nullptr)
    for (auto& [name, robot] : kept["robots"].as_object()) {
      leave_out(robot, {"url", "registers", "payload_kg", "payload_centre_m"});
      for (const char* key : {"urdf", "calibration"}) by_content(robot, key, document);
      for (const char* key : {"carries", "links"})
        if (robot.find(key) != nullptr) solids_by_content(&robot[key], document);
    }
  if (kept.find("obstacles") != nullptr) solids_by_content(&kept["obstacles"], document);
  return kept;
}

}  // namespace

std::string plan_id(const manifest::Document& document, const manifest::Plan& plan) {
  Value decides = Value::object(), steps = Value::array();
  for (const manifest::Laboratory& laboratory : document.laboratory.entry)
    decides["laboratory"] = deciding_part(document, laboratory);
  decides["pattern"] = plan.pattern;
  if (plan.seed) decides["seed"] = *plan.seed;
  for (const manifest::PlanStep& step : plan.steps) {
    Value v = manifest::Codec<manifest::PlanStep>::write(step);
    leave_out(v, {"duration_s", "smallest_singular_m", "clearance_m"});
    steps.push_back(std::move(v));
  }
  decides["steps"] = std::move(steps);
  return sha256(manifest::canonical_json(decides));
}

}  // namespace gonio::acquisition
