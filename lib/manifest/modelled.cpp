// Sections whose members a registry declares: surfaces, lights, laws and mechanisms. What a model's description says
// (manifest/model.h) is what is read, checked, written and put into the schema.
#include <algorithm>

#include "base/error.h"
#include "manifest/field_makers.h"
#include "manifest/model.h"
#include "manifest/section_tables.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mechanism_use.h"
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

using Names = std::map<std::string, std::string>;

// The members of a surface beside its model's parameters. False: `key` is none of them.
bool read_variation(Surface& out, const std::string& key, const Value& member, const ModelInfo& info,
                    const std::string& at) {
  if (key == "textures")
    out.textures = Codec<Names>::read(member, at);
  else if (key == "spectra")
    out.spectra = Codec<Names>::read(member, at);
  else if (key == "vertices")
    out.vertices = Codec<Names>::read(member, at);
  else if (key == "labels")
    out.labels = Codec<std::map<std::string, Parameters>>::read(member, at);
  else if (key == "laws")
    out.laws = Codec<std::map<std::string, LawUse>>::read(member, at);
  else if (key == "base" && info.takes_base)
    out.base = Codec<std::string>::read(member, at);
  else
    return false;
  return true;
}

// Says the manifest by other means than a number what `parameter` is?
bool varying(const Surface& s, const std::string& parameter) {
  return s.textures.contains(parameter) || s.spectra.contains(parameter) || s.vertices.contains(parameter) ||
         s.labels.contains(parameter) || s.laws.contains(parameter);
}

}  // namespace

template <class Record>
Record read_modelled(Family family, const Value& v, const std::string& place) {
  expect_object(v, place);
  Record out;
  if (const Value* model = v.find("model")) out.model = Codec<std::string>::read(*model, place + "/model");
  const ModelInfo* info = find_model(family, out.model);
  if (info == nullptr) {
    std::vector<std::string> known;
    for (const ModelInfo* m : models(family)) known.push_back(m->id);
    check_choice(Value(out.model), known, place + "/model");
    throw Error(Exit::data, place + "/model", "is \"" + out.model + "\", which no model of this build is called");
  }
  for (const auto& [key, member] : v.as_object()) {
    const std::string at = place + "/" + key;
    if (key == "model" || key.starts_with("x-")) continue;
    if (key == "sigma") {
      expect_object(member, at);
      for (const auto& [name, value] : member.as_object())
        out.sigma[name] = value.is_number() ? std::vector<double>{value.as_number()}
                                            : Codec<std::vector<double>>::read(value, at + "/" + name);
      continue;
    }
    if constexpr (std::is_same_v<Record, Surface>)
      if (read_variation(out, key, member, *info, at)) continue;
    if (key == "file" && info->attachment != Attachment::none) {
      out.file = Codec<std::string>::read(member, at);
      continue;
    }
    const auto found = std::ranges::find(info->parameters, key, &ParameterInfo::name);
    if (found == info->parameters.end()) {
      std::vector<std::string> known{"model", "sigma"};
      for (const auto& p : info->parameters) known.push_back(p.name);
      unknown_key(key, known, place);
    }
    out.parameters[key] = Codec<Parameter>::read(member, at);
    check_parameter(*found, member, out.parameters[key], at);
  }
  for (const auto& p : info->parameters) {
    bool varies = false;
    if constexpr (std::is_same_v<Record, Surface>) varies = varying(out, p.name);
    if (!p.preset && !out.parameters.contains(p.name) && !varies) missing_key(p.name, p.meaning, place);
  }
  return out;
}

Surface Codec<Surface>::read(const Value& v, const std::string& place) {
  return read_modelled<Surface>(Family::surface, v, place);
}
Light Codec<Light>::read(const Value& v, const std::string& place) {
  return read_modelled<Light>(Family::light, v, place);
}

namespace {
void write_parameters(const Parameters& parameters, const Sigmas& sigma, Value& out) {
  for (const auto& [name, p] : parameters)
    if (p.given()) out[name] = Codec<Parameter>::write(p);
  for (const auto& [name, numbers] : sigma)
    out["sigma"][name] = numbers.size() == 1 ? Value(numbers[0]) : Value(numbers);
}
}  // namespace

Value Codec<Surface>::write(const Surface& m) {
  Value out = Value::object({{"model", m.model}});
  write_parameters(m.parameters, m.sigma, out);
  if (!m.file.empty()) out["file"] = m.file;
  if (!m.base.empty()) out["base"] = m.base;
  const auto write = [&out]<class Map>(const char* key, const Map& map) {
    if (!map.empty()) out[key] = Codec<Map>::write(map);
  };
  write("textures", m.textures);
  write("spectra", m.spectra);
  write("vertices", m.vertices);
  write("labels", m.labels);
  write("laws", m.laws);
  return out;
}
Value Codec<Light>::write(const Light& m) {
  Value out = Value::object({{"model", m.model}});
  if (!m.file.empty()) out["file"] = m.file;
  write_parameters(m.parameters, m.sigma, out);
  return out;
}

namespace {
Value modelled_schema(Family family) {
  Value alternatives = Value::array();
  for (const ModelInfo* model : models(family)) {
    Value properties = Value::object({{"model", Value::object({{"const", model->id}})}});
    Value required = Value(Value::Array{"model"});
    for (const auto& p : model->parameters) {
      Value s = Codec<Parameter>::schema();
      s["description"] = p.meaning + (p.unit.empty() || p.unit == "1" ? "" : " [" + p.unit + "]");
      properties[p.name] = std::move(s);
    }
    properties["sigma"] = Value::object();
    if (family == Family::surface) {
      for (const char* key : {"textures", "spectra", "vertices"}) properties[key] = Codec<Names>::schema();
      properties["labels"] = Codec<std::map<std::string, Parameters>>::schema();
      properties["laws"] = Codec<std::map<std::string, LawUse>>::schema();
    }
    if (model->attachment != Attachment::none) properties["file"] = Codec<std::string>::schema();
    if (model->takes_base) properties["base"] = Codec<std::string>::schema();
    alternatives.push_back(Value::object({{"title", model->id},
                                          {"description", model->sentence},
                                          {"type", "object"},
                                          {"properties", std::move(properties)},
                                          {"patternProperties", Value::object({{"^x-", Value::object()}})},
                                          {"required", std::move(required)},
                                          {"additionalProperties", false}}));
  }
  return Value::object({{"oneOf", std::move(alternatives)}});
}
}  // namespace
Value Codec<Surface>::schema() {
  return modelled_schema(Family::surface);
}
Value Codec<Light>::schema() {
  return modelled_schema(Family::light);
}

// {"law": NAME, PARAMETER: NUMBER, ...}: the shape of a model whose id is called "law".
LawUse Codec<LawUse>::read(const Value& v, const std::string& place) {
  expect_object(v, place);
  LawUse out;
  const Value* name = v.find("law");
  if (name == nullptr) missing_key("law", "the name of the law", place);
  out.law = Codec<std::string>::read(*name, place + "/law");
  const ModelInfo* info = find_model(Family::law, out.law);
  if (info == nullptr) {
    std::vector<std::string> known;
    for (const ModelInfo* m : models(Family::law)) known.push_back(m->id);
    check_choice(Value(out.law), known, place + "/law");
    throw Error(Exit::data, place + "/law", "is \"" + out.law + "\", which no law of this build is called");
  }
  for (const auto& [key, member] : v.as_object()) {
    if (key == "law" || key.starts_with("x-")) continue;
    const auto found = std::ranges::find(info->parameters, key, &ParameterInfo::name);
    if (found == info->parameters.end()) {
      std::vector<std::string> known{"law"};
      for (const auto& p : info->parameters) known.push_back(p.name);
      unknown_key(key, known, place);
    }
    out.parameters[key] = Codec<Parameter>::read(member, place + "/" + key);
    check_parameter(*found, member, out.parameters[key], place + "/" + key);
  }
  return out;
}
Value Codec<LawUse>::write(const LawUse& m) {
  Value out = Value::object({{"law", m.law}});
  write_parameters(m.parameters, {}, out);
  return out;
}
Value Codec<LawUse>::schema() {
  Value alternatives = Value::array();
  for (const ModelInfo* law : models(Family::law)) {
    Value properties = Value::object({{"law", Value::object({{"const", law->id}})}});
    for (const auto& p : law->parameters) properties[p.name] = Codec<Parameter>::schema();
    alternatives.push_back(Value::object({{"title", law->id},
                                          {"description", law->sentence},
                                          {"type", "object"},
                                          {"properties", std::move(properties)},
                                          {"patternProperties", Value::object({{"^x-", Value::object()}})},
                                          {"required", Value(Value::Array{"law"})},
                                          {"additionalProperties", false}}));
  }
  return models(Family::law).empty() ? Value::object() : Value::object({{"oneOf", std::move(alternatives)}});
}

MechanismUse Codec<MechanismUse>::read(const Value& v, const std::string& place) {
  expect_object(v, place);
  MechanismUse out;
  for (const auto& [key, member] : v.as_object()) {
    const std::string at = place + "/" + key;
    if (key == "on")
      out.on = member.is_string() ? std::vector<std::string>{member.as_string()}
                                  : Codec<std::vector<std::string>>::read(member, at);
    else if (key == "sigma") {
      expect_object(member, at);
      for (const auto& [name, value] : member.as_object())
        out.sigma[name] = value.is_number() ? std::vector<double>{value.as_number()}
                                            : Codec<std::vector<double>>::read(value, at + "/" + name);
    } else if (!key.starts_with("x-")) {
      out.parameters[key] = Codec<Parameter>::read(member, at);
    }
  }
  return out;
}
Value Codec<MechanismUse>::write(const MechanismUse& m) {
  Value out = Value::object();
  if (!m.on.empty()) out["on"] = m.on;
  write_parameters(m.parameters, m.sigma, out);
  return out;
}
Value Codec<MechanismUse>::schema() {
  return Value::object({{"type", "object"}});
}

}  // namespace gonio::manifest
