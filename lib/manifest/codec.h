// Codecs: how one C++ type is read from, written to and described in JSON. `place` is NAME#/json/pointer, for messages.
#pragma once
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "geom/rigid.h"
#include "manifest/noise.h"
#include "manifest/parameter.h"
#include "manifest/pose.h"
#include "manifest/value.h"

namespace gonio::manifest {

inline constexpr double infinite = std::numeric_limits<double>::infinity();
inline constexpr double tiny = std::numeric_limits<double>::denorm_min();  // lower bound of "greater than zero"

// {"$ref": "#/$defs/NAME"}: what many fields share stands once in the schema (manifest/reference.cpp has the list).
Value defined(const std::string& name);
std::string definition_name(const Value& reference);  // NAME of such a reference; empty: it is none

// Any keys: own ones (x-*) hold anything, all others what `entry` describes.
Value by_name(Value entry);

// One name, or a list of names.
std::vector<std::string> read_names(const Value& value, const std::string& place);

// One standard deviation beside each fitted value, under the same key; a number stands for a list of one.
Sigmas read_sigmas(const Value& value, const std::string& place);
Value write_sigmas(const Sigmas& sigmas);

[[noreturn]] void wrong_type(const Value& value, const std::string& wanted, const std::string& place);
void expect_object(const Value& value, const std::string& place);
void expect_array(const Value& value, const std::string& place);
std::string item(const std::string& place, std::size_t index);  // place/3

// The rigid motion of a pose: {"rotation", "translation_m", "sigma"} or {"matrix", "sigma"}. Checks finiteness and
// orthonormality.
struct RigidFields {
  Quaternion rotation;
  Vec3 translation_m;
  std::optional<PoseSigma> sigma;
};

template <class T>
struct Codec;  // static T read(const Value&, place); static Value write(const T&); static Value schema();

#define GONIO_CODEC(TYPE)                                           \
  template <>                                                       \
  struct Codec<TYPE> {                                              \
    static TYPE read(const Value& value, const std::string& place); \
    static Value write(const TYPE& member);                         \
    static Value schema();                                          \
  }
GONIO_CODEC(bool);
GONIO_CODEC(int);
GONIO_CODEC(std::int64_t);
GONIO_CODEC(std::uint64_t);
GONIO_CODEC(double);
GONIO_CODEC(std::string);
GONIO_CODEC(Value);
GONIO_CODEC(Quaternion);
GONIO_CODEC(Vec3);
GONIO_CODEC(Parameter);
GONIO_CODEC(PoseSigma);
GONIO_CODEC(Noise);
GONIO_CODEC(RigidFields);
#undef GONIO_CODEC

template <class T>
struct Codec<std::optional<T>> {
  static std::optional<T> read(const Value& v, const std::string& place) { return Codec<T>::read(v, place); }
  static Value write(const std::optional<T>& m) { return m ? Codec<T>::write(*m) : Value(); }
  static Value schema() { return Codec<T>::schema(); }
};
template <class T>
struct Codec<std::vector<T>> {
  static std::vector<T> read(const Value& v, const std::string& place) {
    expect_array(v, place);
    std::vector<T> out;
    for (std::size_t i = 0; i < v.as_array().size(); ++i)
      out.push_back(Codec<T>::read(v.as_array()[i], item(place, i)));
    return out;
  }
  static Value write(const std::vector<T>& m) {
    if (m.empty()) return {};
    Value out = Value::array();
    for (const T& e : m) out.push_back(written(e));
    return out;
  }
  static Value schema() { return Value::object({{"type", "array"}, {"items", Codec<T>::schema()}}); }

 private:
  static Value written(const T& e) {  // an empty text is left out of a record, and stays in a list
    if constexpr (std::is_same_v<T, std::string>) return Value(e);
    return Codec<T>::write(e);
  }
};
template <class T>
struct Codec<std::map<std::string, T>> {
  static std::map<std::string, T> read(const Value& v, const std::string& place) {
    expect_object(v, place);
    std::map<std::string, T> out;
    for (const auto& [key, member] : v.as_object())
      if (!key.starts_with("x-")) out[key] = Codec<T>::read(member, place + "/" + key);
    return out;
  }
  static Value write(const std::map<std::string, T>& m) {
    if (m.empty()) return {};
    Value out = Value::object();
    for (const auto& [key, member] : m) out[key] = Codec<T>::write(member);
    return out;
  }
  static Value schema() {
    if constexpr (std::is_same_v<T, std::string>) return defined("texts");
    if constexpr (std::is_same_v<T, std::vector<double>>) return defined("lists");
    return by_name(Codec<T>::schema());
  }
};

template <class To, class From>
struct Codec<Pose<To, From>> {
  static Pose<To, From> read(const Value& v, const std::string& place) {
    const RigidFields r = Codec<RigidFields>::read(v, place);
    Pose<To, From> pose;
    pose.rotation = r.rotation;
    pose.translation_m = r.translation_m;
    pose.sigma = r.sigma;
    return pose;
  }
  static Value write(const Pose<To, From>& m) {
    return Codec<RigidFields>::write({m.rotation, m.translation_m, m.sigma});
  }
  static Value schema() { return Codec<RigidFields>::schema(); }
};

}  // namespace gonio::manifest
