// Provenance: {"last": key, "steps": {key: {program, version, options, inputs, manifest, after}}, "runs": {key: {time,
// host}}}. A step's key is a hash of its canonical JSON: the graph is keyed by content, so a change of any input
// changes every key downstream.
#include <set>

#include "base/hash.h"
#include "manifest/document.h"

namespace gonio::manifest {
namespace {

void erase(Value& object, std::string_view key) {
  if (object.is_object()) std::erase_if(object.as_object(), [&](const Value::Member& m) { return m.first == key; });
}

}  // namespace

std::string content_id(const Document& d) {
  Value v = to_value(d, d.folder);
  if (v.find("provenance") != nullptr) erase(v["provenance"], "runs");
  if (v.find("files") != nullptr)  // a file is its content, wherever it lies
    for (auto& [id, file] : v["files"].as_object())
      if (file.find("sha256") != nullptr) erase(file, "path");
  return sha256(canonical_json(v));
}

void record_step(Document& d, const Step& step) {
  Value node = Value::object({{"program", step.program}, {"version", step.version}, {"options", step.options}});
  Value inputs = Value::array();
  for (const auto& hash : std::set<std::string>(step.input_hashes.begin(), step.input_hashes.end()))
    inputs.push_back(hash);
  node["inputs"] = std::move(inputs);
  if (!step.input_id.empty()) node["manifest"] = step.input_id;
  if (const Value* last = d.provenance.find("last"); last != nullptr) node["after"] = *last;
  const std::string key = sha256(canonical_json(node)).substr(0, 16);
  d.provenance["steps"][key] = std::move(node);
  d.provenance["last"] = key;
  if (!step.time.empty()) d.provenance["runs"][key] = Value::object({{"time", step.time}, {"host", step.host}});
}

}  // namespace gonio::manifest
