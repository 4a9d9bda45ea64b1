// Sections whose members a registry declares: surfaces, lights, laws and mechanisms. What a model's description says
// (manifest/model.h) is what is read, checked, written and put into the schema; a table has the keys beside it.
#include <algorithm>

#include "base/error.h"
#include "manifest/field_makers.h"
#include "manifest/model.h"
#include "manifest/section_tables.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/print.h"
#include "manifest/sections/surface.h"

namespace gonio::manifest {
namespace {

// Values of `parameters` against what the model declares. Scalars stand for three equal colours where a colour is
// wanted.
void check_parameter(const ParameterInfo& info, const Value& raw, const Parameter& p, const std::string& place) {
  const auto n = static_cast<int>(p.value.size());
  if (n != info.components && !(info.rgb && n == 1))
    throw Error(Exit::data, place,
                "has " + std::to_string(n) + " numbers, " + std::to_string(info.components) + " are needed");
  check_range(raw, info.lower, info.upper, info.unit, place);
}

const ModelInfo& known_model(Family family, const std::string& id, const std::string& place) {
  if (const ModelInfo* info = find_model(family, id)) return *info;
  std::vector<std::string> known;
  for (const ModelInfo* m : models(family)) known.push_back(m->id);
  check_choice(Value(id), known, place);
  throw Error(Exit::data, place,
              "is \"" + id + "\", which no " + (family == Family::law ? "law" : "model") + " of this build is called");
}

// Has this model the member `key` of the table?
bool takes(const ModelInfo& info, const std::string& key) {
  if (key == "file") return info.attachment != Attachment::none;
  if (key == "environment") return info.takes_environment;
  if (key == "base") return info.takes_base;
  if (key == "expression") return info.takes_expression;
  return true;
}

// Says the manifest by other means than a number what `parameter` is?
bool varying(const Surface& s, const std::string& parameter) {
  return s.textures.contains(parameter) || s.spectra.contains(parameter) || s.vertices.contains(parameter) ||
         s.labels.contains(parameter) || s.laws.contains(parameter);
}

// `id` is the member that the table's first field names: which model, which law.
template <class Record>
Record read_modelled(Family family, std::string Record::*id, const std::vector<Field<Record>>& fields, const Value& v,
                     const std::string& place) {
  expect_object(v, place);
  Record out;
  const Field<Record>& first = fields.front();
  if (const Value* named = v.find(first.name))
    first.read(out, *named, place + "/" + first.name);
  else if (first.required)
    missing_key(first.name, first.sentence, place);
  const ModelInfo& info = known_model(family, out.*id, place + "/" + first.name);
  std::vector<std::string> known;
  for (const auto& f : fields)
    if (takes(info, f.name)) known.push_back(f.name);
  for (const auto& p : info.parameters) known.push_back(p.name);
  for (const auto& [key, member] : v.as_object())
    if (!key.starts_with("x-") && std::ranges::find(known, key) == known.end()) unknown_key(key, known, place);
  read_fields(out, v, fields, place,
              [&info](Record& record, const std::string& key, const Value& member, const std::string& at) {
                record.parameters[key] = Codec<Parameter>::read(member, at);
                check_parameter(*std::ranges::find(info.parameters, key, &ParameterInfo::name), member,
                                record.parameters[key], at);
              });
  if (family == Family::law) return out;  // whose parameters are asked for where it is applied (values_of)
  for (const auto& p : info.parameters) {
    bool varies = false;
    if constexpr (std::is_same_v<Record, Surface>) varies = varying(out, p.name);
    if (!p.preset && !out.parameters.contains(p.name) && !varies) missing_key(p.name, p.meaning, place);
  }
  return out;
}

// The table's members with the parameters before "sigma", which speaks of them.
template <class Record>
Value write_modelled(const Record& record, const std::vector<Field<Record>>& fields) {
  Value out = Value::object();
  const auto write_parameters = [&] {
    for (const auto& [name, p] : record.parameters)
      if (p.given()) out[name] = Codec<Parameter>::write(p);
  };
  for (const auto& f : fields) {
    if (f.name == "sigma") write_parameters();
    if (Value v = f.write(record); !v.is_null()) out[f.name] = std::move(v);
  }
  write_parameters();  // which stay where they are
  return out;
}

// What a parameter is all say alike (open_definition); of its own it has words.
Value parameter_schema(const ParameterInfo& p) {
  Value schema = Value::object();
  const std::string unit = p.unit.empty() || p.unit == "1" ? "" : " [" + p.unit + "]",
                    bounds = bounds_text(p.lower, p.upper);
  schema["description"] = p.meaning + unit + (bounds.empty() ? "" : "; " + bounds);
  if (p.preset) schema["default"] = *p.preset;
  return schema;
}

// The table's members and, under any other name, parameters.
template <class Record>
Value open_definition(const std::vector<Field<Record>>& fields) {
  Value out = object_schema(properties_of(fields), {});
  out["additionalProperties"] = Codec<Parameter>::schema();
  return out;
}

// The alternatives say which names each model has.
template <class Record>
Value modelled_definition(Family family, std::string Record::*id, const std::vector<Field<Record>>& fields) {
  Value alternatives = Value::array();
  for (const ModelInfo* model : models(family)) {
    Value properties = Value::object({{fields.front().name, Value::object({{"const", model->id}})}});
    std::vector<std::string> required;
    if (model->id != Record().*id) required.push_back(fields.front().name);
    for (const auto& p : model->parameters) {
      properties[p.name] = parameter_schema(p);
      if (family == Family::light && !p.preset) required.push_back(p.name);
    }
    for (const auto& f : fields)
      if (f.name != fields.front().name && takes(*model, f.name)) properties[f.name] = Value::object();
    Value alternative = object_schema(std::move(properties), required);
    alternative["title"] = model->id;
    alternative["description"] = model->sentence;
    alternatives.push_back(std::move(alternative));
  }
  Value out = open_definition(fields);
  out["oneOf"] = std::move(alternatives);
  return out;
}

}  // namespace

const std::vector<Field<Surface>>& surface_fields() {
  static const std::vector<Field<Surface>> table{
      field("model", &Surface::model, "", "how it reflects: a name of gonio-surfaces(7)"),
      sigma_field(&Surface::sigma),
      field("file", &Surface::file, "", "of a model that reads a table: its file id"),
      field("base", &Surface::base, "", "of a model that lies on another surface: its name"),
      field("textures", &Surface::textures, "", "parameters that a picture has: its file id"),
      field("spectra", &Surface::spectra, "",
            "parameters over wavelength: file id of a CSV or refractiveindex.info's YAML"),
      field("vertices", &Surface::vertices, "", "parameters that the mesh's vertices have: their property"),
      custom<Surface>(
          "labels", "", "parameters by the label of the mesh's faces: a value for each", defined("labels"),
          [](Surface& s, const Value& v, const std::string& place) {
            s.labels = Codec<decltype(s.labels)>::read(v, place);
          },
          [](const Surface& s) { return Codec<decltype(s.labels)>::write(s.labels); }),
      field("laws", &Surface::laws, "", "parameters that follow from the shape: a law and its own parameters")};
  return table;
}
const std::vector<Field<Light>>& light_fields() {
  static const std::vector<Field<Light>> table{
      field("model", &Light::model, "", "how it shines: one of those below"),
      field("file", &Light::file, "", "of a model that has a picture or table: its file id"),
      field("environment", &Light::environment, "", "of surroundings, instead of a file: name in environments"),
      sigma_field(&Light::sigma)};
  return table;
}
const std::vector<Field<LawUse>>& law_use_fields() {
  static const std::vector<Field<LawUse>> table{
      field("law", &LawUse::law, "", "how the parameter varies: a name of gonio-surfaces(7)").needed()};
  return table;
}
const std::vector<Field<MicrostructureUse>>& microstructure_use_fields() {
  static const std::vector<Field<MicrostructureUse>> table{
      field("model", &MicrostructureUse::model, "", "which: one of those below"),
      field("file", &MicrostructureUse::file, "", "of a model that has a picture: its file id"),
      field("expression", &MicrostructureUse::expression, "",
            "of the model expression: over u_m, v_m along the surface and x_m, y_m, z_m on the platform")};
  return table;
}
const std::vector<Field<MechanismUse>>& mechanism_use_fields() {
  static const std::vector<Field<MechanismUse>> table{
      custom<MechanismUse>(
          "on", "", "name or names of the surfaces, lights, ... that it applies to; left out: all that it can apply to",
          defined("names"),
          [](MechanismUse& use, const Value& v, const std::string& place) { use.on = read_names(v, place); },
          [](const MechanismUse& use) { return Codec<std::vector<std::string>>::write(use.on); }),
      sigma_field(&MechanismUse::sigma)};
  return table;
}

Surface Codec<Surface>::read(const Value& v, const std::string& place) {
  return read_modelled(Family::surface, &Surface::model, surface_fields(), v, place);
}
Value Codec<Surface>::write(const Surface& m) {
  return write_modelled(m, surface_fields());
}
Value Codec<Surface>::schema() {
  return defined("surface");
}
Value surface_definition() {
  return modelled_definition(Family::surface, &Surface::model, surface_fields());
}

Light Codec<Light>::read(const Value& v, const std::string& place) {
  return read_modelled(Family::light, &Light::model, light_fields(), v, place);
}
Value Codec<Light>::write(const Light& m) {
  return write_modelled(m, light_fields());
}
Value Codec<Light>::schema() {
  return defined("light");
}
Value light_definition() {
  return modelled_definition(Family::light, &Light::model, light_fields());
}

// {"law": NAME, PARAMETER: NUMBER, ...}: the shape of a model whose id is called "law".
LawUse Codec<LawUse>::read(const Value& v, const std::string& place) {
  return read_modelled(Family::law, &LawUse::law, law_use_fields(), v, place);
}
Value Codec<LawUse>::write(const LawUse& m) {
  return write_modelled(m, law_use_fields());
}
Value Codec<LawUse>::schema() {
  return defined("law");
}
Value law_definition() {
  return modelled_definition(Family::law, &LawUse::law, law_use_fields());
}

MicrostructureUse Codec<MicrostructureUse>::read(const Value& v, const std::string& place) {
  return read_modelled(Family::microstructure, &MicrostructureUse::model, microstructure_use_fields(), v, place);
}
Value Codec<MicrostructureUse>::write(const MicrostructureUse& m) {
  return write_modelled(m, microstructure_use_fields());
}
Value Codec<MicrostructureUse>::schema() {
  return defined("microstructure");
}
Value microstructure_definition() {
  return modelled_definition(Family::microstructure, &MicrostructureUse::model, microstructure_use_fields());
}

// Names and bounds of a mechanism's parameters are held against the registry where programs begin
// (mechanism/validate.h).
MechanismUse Codec<MechanismUse>::read(const Value& v, const std::string& place) {
  MechanismUse out;
  read_fields(out, v, mechanism_use_fields(), place,
              [](MechanismUse& use, const std::string& key, const Value& member, const std::string& at) {
                use.parameters[key] = Codec<Parameter>::read(member, at);
              });
  return out;
}
Value Codec<MechanismUse>::write(const MechanismUse& m) {
  return write_modelled(m, mechanism_use_fields());
}
Value Codec<MechanismUse>::schema() {
  return defined("mechanism-use");
}
Value mechanism_use_definition() {
  return open_definition(mechanism_use_fields());
}

}  // namespace gonio::manifest
