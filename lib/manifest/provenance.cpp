// Provenance: the field tables of its graph, and how it grows. A step's key is a hash of its canonical JSON: the graph
// is keyed by content, so a change of any input changes every key downstream.
#include "manifest/sections/provenance.h"

#include <set>

#include "base/hash.h"
#include "manifest/document.h"
#include "manifest/field_makers.h"
#include "manifest/section_tables.h"

namespace gonio::manifest {
namespace {

void erase(Value& object, std::string_view key) {
  if (object.is_object()) std::erase_if(object.as_object(), [&](const Value::Member& m) { return m.first == key; });
}

}  // namespace

const std::vector<Field<ProvenanceStep>>& provenance_step_fields() {
  using T = ProvenanceStep;
  static const std::vector<Field<T>> table{
      field("program", &T::program, "", "that ran").always("").needed(),
      field("version", &T::version, "", "of gonio").always(""),
      custom<T>(
          "options", "", "that were given, by name; none that names files or says how to run",
          Value::object({{"type", "object"}}),
          [](T& step, const Value& v, const std::string& place) {
            expect_object(v, place);
            step.options = v;
          },
          [](const T& step) { return step.options; })
          .always(Value::object()),
      field("inputs", &T::inputs, "", "SHA-256 of the files that were read").always(Value::array()),
      field("manifest", &T::manifest, "", "content id of the manifest that was read"),
      field("after", &T::after, "", "key of the step before")};
  return table;
}

const std::vector<Field<ProvenanceRun>>& provenance_run_fields() {
  static const std::vector<Field<ProvenanceRun>> table{
      field("time", &ProvenanceRun::time, "", "when it ran, UTC: 2026-01-31T12:00:00Z").always(""),
      field("host", &ProvenanceRun::host, "", "where").always("")};
  return table;
}

const std::vector<Field<Provenance>>& provenance_fields() {
  static const std::vector<Field<Provenance>> table{
      field("steps", &Provenance::steps, "", "by key: a hash of the step"),
      field("last", &Provenance::last, "", "key of the step that wrote the document"),
      field("runs", &Provenance::runs, "", "by the step's key, with --stamp: when and where")};
  return table;
}

GONIO_RECORD(ProvenanceStep, provenance_step_fields);
GONIO_RECORD(ProvenanceRun, provenance_run_fields);
GONIO_RECORD(Provenance, provenance_fields);

std::string content_id(const Document& d) {
  Value v = to_value(d, d.folder);
  if (v.find("provenance") != nullptr) erase(v["provenance"], "runs");
  if (v.find("files") != nullptr)  // a file is its content, wherever it lies
    for (auto& [id, file] : v["files"].as_object())
      if (file.find("sha256") != nullptr) erase(file, "path");
  return sha256(canonical_json(v));
}

void record_step(Document& d, const Step& step) {
  ProvenanceStep entry;
  entry.program = step.program;
  entry.version = step.version;
  entry.options = step.options;
  const std::set<std::string> inputs(step.input_hashes.begin(), step.input_hashes.end());
  entry.inputs.assign(inputs.begin(), inputs.end());
  entry.manifest = step.input_id;
  if (const Value* last = d.provenance.find("last"); last != nullptr) entry.after = last->as_string();
  Value node = Codec<ProvenanceStep>::write(entry);
  const std::string key = sha256(canonical_json(node)).substr(0, 16);
  d.provenance["steps"][key] = std::move(node);
  d.provenance["last"] = key;
  if (!step.time.empty()) d.provenance["runs"][key] = Codec<ProvenanceRun>::write({step.time, step.host});
}

}  // namespace gonio::manifest
