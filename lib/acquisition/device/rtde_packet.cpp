#include "acquisition/device/rtde_packet.h"

#include <array>
#include <bit>
#include <cstdint>

#include "base/text.h"

namespace gonio::acquisition {
namespace {

std::uint64_t big_endian(std::string_view bytes) {
  std::uint64_t value = 0;
  for (const char c : bytes) value = value << 8 | static_cast<unsigned char>(c);
  return value;
}

std::string big_endian_bytes(std::uint64_t value, int count) {
  std::string bytes;
  for (int i = count - 1; i >= 0; --i) bytes += static_cast<char>(value >> (8 * i) & 0xFF);
  return bytes;
}

struct RtdeType {
  std::string_view name;
  int bytes, count;
  enum Kind { whole, with_sign, real } kind;
};
constexpr std::array<RtdeType, 11> rtde_type_table{{{"BOOL", 1, 1, RtdeType::whole},
                                                    {"UINT8", 1, 1, RtdeType::whole},
                                                    {"UINT16", 2, 1, RtdeType::whole},
                                                    {"UINT32", 4, 1, RtdeType::whole},
                                                    {"UINT64", 8, 1, RtdeType::whole},
                                                    {"INT32", 4, 1, RtdeType::with_sign},
                                                    {"DOUBLE", 8, 1, RtdeType::real},
                                                    {"VECTOR3D", 8, 3, RtdeType::real},
                                                    {"VECTOR6D", 8, 6, RtdeType::real},
                                                    {"VECTOR6INT32", 4, 6, RtdeType::with_sign},
                                                    {"VECTOR6UINT32", 4, 6, RtdeType::whole}}};

const RtdeType* rtde_type(std::string_view name) {
  for (const auto& type : rtde_type_table)
    if (type.name == name) return &type;
  return nullptr;
}

double rtde_number(std::string_view bytes, RtdeType::Kind kind) {
  const std::uint64_t bits = big_endian(bytes);
  if (kind == RtdeType::real) return std::bit_cast<double>(bits);
  if (kind == RtdeType::with_sign) return static_cast<std::int32_t>(static_cast<std::uint32_t>(bits));
  return static_cast<double>(bits);
}

std::vector<std::string> comma_separated(std::string_view text) {
  std::vector<std::string> words(1);
  for (const char c : text) {
    if (c == ',')
      words.emplace_back();
    else
      words.back() += c;
  }
  return words;
}

}  // namespace

std::string rtde_packet(char type, std::string_view payload) {
  if (payload.size() + 3 > 0xFFFF) throw RtdeRefused("an RTDE packet of more than 65535 bytes");
  return big_endian_bytes(payload.size() + 3, 2) + type + std::string(payload);
}

RtdeHead rtde_head(std::string_view three_bytes) {
  const auto size = three_bytes.size() == 3 ? big_endian(three_bytes.substr(0, 2)) : 0;
  if (size < 3)
    throw RtdeRefused(format("an RTDE packet that claims %d bytes, its head has 3", static_cast<int>(size)));
  return {three_bytes[2], static_cast<std::size_t>(size - 3)};
}

std::string rtde_version_request(int version) {
  return rtde_packet('V', big_endian_bytes(static_cast<std::uint64_t>(version), 2));
}

std::string rtde_outputs_request(double frequency_hz, const std::vector<std::string>& names) {
  std::string list;
  for (const auto& name : names) list += (list.empty() ? "" : ",") + name;
  return rtde_packet('O', big_endian_bytes(std::bit_cast<std::uint64_t>(frequency_hz), 8) + list);
}

bool rtde_accepted(std::string_view payload) {
  if (payload.size() != 1)
    throw RtdeRefused(format("an RTDE answer of %d bytes instead of 1", static_cast<int>(payload.size())));
  return payload[0] != 0;
}

std::string rtde_text(std::string_view payload) {
  const auto counted = [&](std::size_t at) -> std::string_view {
    if (at >= payload.size()) throw RtdeRefused("an RTDE text message that is too short");
    const std::size_t count = static_cast<unsigned char>(payload[at]);
    if (at + 1 + count > payload.size()) throw RtdeRefused("an RTDE text message that is too short");
    return payload.substr(at + 1, count);
  };
  const auto message = counted(0);
  const auto source = counted(message.size() + 1);
  return std::string(source) + ": " + std::string(message);
}

std::string rtde_version(std::string_view payload) {
  if (payload.size() != 16)
    throw RtdeRefused(format("a controller's version of %d bytes instead of 16", static_cast<int>(payload.size())));
  std::string version;
  for (std::size_t i = 0; i < 4; ++i)
    version += (i == 0 ? "" : ".") + std::to_string(big_endian(payload.substr(4 * i, 4)));
  return version;
}

RtdeRecipe rtde_recipe(std::string_view payload, const std::vector<std::string>& names) {
  if (payload.empty()) throw RtdeRefused("an empty answer to an RTDE recipe");
  RtdeRecipe recipe;
  recipe.id = static_cast<unsigned char>(payload[0]);
  recipe.names = names;
  recipe.types = comma_separated(payload.substr(1));
  if (recipe.types.size() != names.size())
    throw RtdeRefused(format("%d types for %d names of an RTDE recipe", static_cast<int>(recipe.types.size()),
                             static_cast<int>(names.size())));
  recipe.data_bytes = 1;
  std::string missing;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (const RtdeType* type = rtde_type(recipe.types[i]))
      recipe.data_bytes += static_cast<std::size_t>(type->bytes * type->count);
    else
      missing += (missing.empty() ? "" : ", ") + names[i] + " (" + recipe.types[i] + ")";
  }
  if (!missing.empty()) throw RtdeRefused("the controller's RTDE has no " + missing);
  return recipe;
}

RtdeFields rtde_fields(std::string_view payload, const RtdeRecipe& recipe) {
  if (payload.size() != recipe.data_bytes)
    throw RtdeRefused(format("an RTDE data packet of %d bytes, its recipe has %d", static_cast<int>(payload.size()),
                             static_cast<int>(recipe.data_bytes)));
  if (static_cast<unsigned char>(payload[0]) != recipe.id)
    throw RtdeRefused(format("an RTDE data packet of recipe %d, asked for was %d",
                             static_cast<unsigned char>(payload[0]), recipe.id));
  RtdeFields fields;
  std::size_t at = 1;
  for (std::size_t i = 0; i < recipe.names.size(); ++i) {
    const RtdeType& type = *rtde_type(recipe.types[i]);
    auto& numbers = fields[recipe.names[i]];
    for (int k = 0; k < type.count; ++k, at += static_cast<std::size_t>(type.bytes))
      numbers.push_back(rtde_number(payload.substr(at, static_cast<std::size_t>(type.bytes)), type.kind));
  }
  return fields;
}

}  // namespace gonio::acquisition
