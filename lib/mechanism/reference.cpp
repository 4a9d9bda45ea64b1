#include "mechanism/reference.h"

#include "manifest/section_tables.h"
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

manifest::Value uses_schema() {
  using manifest::Value;
  Value properties = Value::object();
  for (const Mechanism* m : all_mechanisms()) {
    Value members = Value::object();
    for (const Parameter& p : m->parameters) {
      Value schema = Value::object();
      schema["description"] = p.meaning + (p.unit.empty() || p.unit == "1" ? "" : " [" + p.unit + "]") + "; " +
                              manifest::bounds_text(p.lower, p.upper);
      schema["default"] = p.neutral;
      members[p.name] = std::move(schema);
    }
    for (const auto& f : manifest::mechanism_use_fields()) members[f.name] = Value::object();
    Value use = manifest::object_schema(std::move(members), {});
    use["description"] = m->sentence;
    properties[m->id] = std::move(use);
  }
  // What all have alike is said once; each entry says which names it has.
  Value uses = manifest::object_schema(std::move(properties), {});
  uses["allOf"].push_back(manifest::Codec<std::map<std::string, manifest::MechanismUse>>::schema());
  return uses;
}

}  // namespace gonio::mechanism
