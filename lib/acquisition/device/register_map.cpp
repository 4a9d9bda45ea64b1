#include "acquisition/device/register_map.h"

#include <array>
#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>

#include "base/error.h"
#include "base/text.h"
#include "manifest/value.h"

namespace gonio::acquisition {
namespace {

using Type = Register::Type;
using Table = Register::Table;

constexpr std::array<const char*, 7> type_words{"bit", "uint16", "int16", "uint32", "int32", "float32", "float64"};
constexpr std::array<const char*, 4> table_words{"holding", "input", "coil", "discrete"};
constexpr std::array<const char*, 6> joint_words{"joint",  "turn",        "speed",
                                                 "target", "speed-limit", "acceleration-limit"};
constexpr std::array<const char*, 9> other_words{
    "powered", "standing", "protective-stop", "emergency-stop", "remote-control", "mode", "command", "done", "stop"};

int words_of_type(Type type) {
  switch (type) {
    case Type::uint32:
    case Type::int32:
    case Type::float32: return 2;
    case Type::float64: return 4;
    default: return 1;
  }
}

bool is_joint_word(const std::string& name, int joints) {
  for (int joint = 1; joint <= joints; ++joint) {
    const std::string end = "-" + std::to_string(joint);
    if (name == "temperature" + end) return true;
    for (const char* word : joint_words)
      if (name == word + end) return true;
  }
  return false;
}

bool is_register_word(const std::string& name, int joints) {
  for (const char* word : other_words)
    if (name == word) return true;
  return is_joint_word(name, joints);
}

double number_of(std::span<const std::uint16_t> words, const Register& which) {
  switch (which.type) {
    case Type::bit: return words[0] != 0 ? 1 : 0;
    case Type::uint16: return words[0];
    case Type::int16: return signed_word(words[0]);
    case Type::uint32: return static_cast<std::uint32_t>(integer_of_words(words, which.order));
    case Type::int32: return integer_of_words(words, which.order);
    case Type::float32: return static_cast<double>(float_of_words(words, which.order));
    case Type::float64: return double_of_words(words, which.order);
  }
  return 0;
}

// Neighbours in one question: the angles of an arm belong to one moment.
std::vector<double> read_joint_registers(ModbusClient& device, const RegisterMap& map, const std::string& name) {
  const Register* first = map.find(name, 1);
  if (first == nullptr) return {};
  const int width = words_of_type(first->type);
  bool together = first->table == Table::holding || first->table == Table::input;
  std::vector<const Register*> all;
  for (int joint = 1; joint <= map.joints; ++joint) {
    all.push_back(map.find(name, joint));
    if (all.back() == nullptr) return {};
    together = together && all.back()->type == first->type && all.back()->table == first->table &&
               all.back()->address == first->address + width * (joint - 1);
  }
  std::vector<double> values;
  if (!together) {
    for (const Register* which : all) values.push_back(read_register(device, *which));
    return values;
  }
  const auto words = device.words(first->table == Table::holding ? WordTable::holding : WordTable::input,
                                  first->address, width * map.joints);
  for (std::size_t i = 0; i < all.size(); ++i)
    values.push_back(number_of(std::span(words).subspan(i * width, width), *all[i]) * all[i]->scale + all[i]->offset);
  return values;
}

std::optional<double> read_if(ModbusClient& device, const RegisterMap& map, const char* name) {
  const Register* which = map.find(name);
  if (which == nullptr) return {};
  return read_register(device, *which);
}
std::optional<bool> flag_if(ModbusClient& device, const RegisterMap& map, const char* name) {
  const auto value = read_if(device, map, name);
  if (!value) return {};
  return *value != 0;
}

}  // namespace

const Register* RegisterMap::find(const std::string& name, int joint) const {
  const auto at = registers.find(joint == 0 ? name : name + "-" + std::to_string(joint));
  return at == registers.end() ? nullptr : &at->second;
}

const RegisterMap& ur_register_map() {
  static const RegisterMap ur_map = [] {
    RegisterMap map;
    const auto add = [&](const std::string& name, int address, Type type, double scale = 1, double offset = 0) {
      map.registers[name] = {address, type, Table::holding, WordOrder::high_first, scale, offset};
    };
    for (int joint = 1; joint <= 6; ++joint) {
      const std::string end = "-" + std::to_string(joint);
      add("joint" + end, 269 + joint, Type::uint16, 1e-3);
      add("turn" + end, 319 + joint, Type::uint16);
      add("speed" + end, 279 + joint, Type::int16, 1e-3);
      add("temperature" + end, 299 + joint, Type::int16, 1, 273.15);
    }
    add("mode", 258, Type::uint16);
    add("powered", 260, Type::uint16);
    add("protective-stop", 261, Type::uint16);
    add("emergency-stop", 262, Type::uint16);
    return map;
  }();
  return ur_map;
}

double read_register(ModbusClient& device, const Register& which) {
  if (which.table == Table::coil || which.table == Table::discrete) {
    const auto bit = device.bits(which.table == Table::coil ? BitTable::coil : BitTable::discrete, which.address, 1);
    return (bit.at(0) ? 1 : 0) * which.scale + which.offset;
  }
  const auto table = which.table == Table::holding ? WordTable::holding : WordTable::input;
  return number_of(device.words(table, which.address, words_of_type(which.type)), which) * which.scale + which.offset;
}

void write_register(ModbusClient& device, const Register& which, double value) {
  const double raw = (value - which.offset) / which.scale;
  if (which.table == Table::coil) return device.write_bit(which.address, raw != 0);
  switch (which.type) {
    case Type::float32: return device.write_words(which.address, words_of_float(static_cast<float>(raw), which.order));
    case Type::float64: return device.write_words(which.address, words_of_double(raw, which.order));
    case Type::uint32:
    case Type::int32: {
      const auto whole = static_cast<std::uint32_t>(std::llround(raw));
      return device.write_words(which.address, words_of_integer(static_cast<std::int32_t>(whole), which.order));
    }
    default: {
      const auto word = static_cast<std::uint16_t>(std::llround(raw));
      return device.write_words(which.address, std::span(&word, 1));
    }
  }
}

double resolution(const Register& which) {
  return which.type == Type::float32 || which.type == Type::float64 ? 0 : std::abs(which.scale);
}

RegisterReading read_registers(ModbusClient& device, const RegisterMap& map) {
  RegisterReading reading;
  reading.joints_rad = read_joint_registers(device, map, "joint");
  const auto turns = read_joint_registers(device, map, "turn");
  for (std::size_t i = 0; i < turns.size(); ++i) reading.joints_rad[i] -= 2 * std::numbers::pi * turns[i];
  reading.speed_rad_per_s = read_joint_registers(device, map, "speed");
  reading.temperature_K = read_joint_registers(device, map, "temperature");
  reading.powered = flag_if(device, map, "powered");
  reading.standing = flag_if(device, map, "standing");
  reading.protective_stop = flag_if(device, map, "protective-stop");
  reading.emergency_stop = flag_if(device, map, "emergency-stop");
  reading.remote_control = flag_if(device, map, "remote-control");
  if (const auto mode = read_if(device, map, "mode")) reading.mode = static_cast<int>(*mode);
  return reading;
}

namespace {

[[noreturn]] void bad_map(const std::string& place, const std::string& problem, const std::string& remedy) {
  throw Error(Exit::data, place, problem, remedy);
}

std::string list_of(std::span<const char* const> words) {
  std::string list;
  for (const char* word : words) list += (list.empty() ? "" : ", ") + std::string(word);
  return list;
}

int word_index(const manifest::Value* value, std::span<const char* const> words, int preset, const std::string& place) {
  if (value == nullptr) return preset;
  for (std::size_t i = 0; i < words.size(); ++i)
    if (value->is_string() && value->as_string() == words[i]) return static_cast<int>(i);
  bad_map(place, "is none of these words", "one of " + list_of(words));
}

double finite_number(const manifest::Value* value, double preset, const std::string& place) {
  if (value == nullptr) return preset;
  if (!value->is_number() || !std::isfinite(value->as_number())) bad_map(place, "is no number", {});
  return value->as_number();
}

Register read_one_register(const manifest::Value& value, const std::string& place) {
  if (!value.is_object()) bad_map(place, "is no object", "write {\"address\": N, \"type\": ...}");
  for (const auto& [key, member] : value.as_object())
    if (key != "address" && key != "type" && key != "table" && key != "words" && key != "scale" && key != "offset")
      bad_map(place + "/" + key, "is not known", "address, type, table, words, scale, offset");
  Register one;
  const manifest::Value* address = value.find("address");
  if (address == nullptr || !address->is_integer() || address->as_integer() < 0 || address->as_integer() > 65535)
    bad_map(place + "/address", "is no address", "a whole number from 0 to 65535, counted from 0");
  one.address = static_cast<int>(address->as_integer());
  one.type = static_cast<Type>(word_index(value.find("type"), type_words, 1, place + "/type"));
  const int preset_table = one.type == Type::bit ? 2 : 0;
  one.table = static_cast<Table>(word_index(value.find("table"), table_words, preset_table, place + "/table"));
  const std::array<const char*, 2> orders{"high-first", "low-first"};
  one.order = static_cast<WordOrder>(word_index(value.find("words"), orders, 0, place + "/words"));
  one.scale = finite_number(value.find("scale"), 1, place + "/scale");
  one.offset = finite_number(value.find("offset"), 0, place + "/offset");
  if (one.scale == 0) bad_map(place + "/scale", "is 0", {});
  const bool bits = one.table == Table::coil || one.table == Table::discrete;
  if (bits && one.type != Type::bit) bad_map(place + "/type", "does not fit into a coil", "\"type\": \"bit\"");
  return one;
}

}  // namespace

RegisterMap read_register_map(const std::string& path, const std::string& place) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) throw Error(Exit::no_input, place, path + " cannot be read", "give the path of a register map");
  const manifest::Value value = manifest::parse_json(text.str(), path);
  const manifest::Value* registers = value.find("registers");
  if (registers == nullptr || !registers->is_object())
    bad_map(path, "holds no \"registers\"", "write {\"joints\": 6, \"registers\": {\"joint-1\": {...}}}");
  RegisterMap map;
  if (const manifest::Value* joints = value.find("joints")) {
    if (!joints->is_integer() || joints->as_integer() < 1 || joints->as_integer() > 12)
      bad_map(path + "#/joints", "is no number of joints", "from 1 to 12");
    map.joints = static_cast<int>(joints->as_integer());
  }
  for (const auto& [name, one] : registers->as_object()) {
    const std::string at = path + "#/registers/" + name;
    if (!is_register_word(name, map.joints))
      bad_map(at, "is not known",
              "with -1 .. -" + std::to_string(map.joints) + ": temperature, " + list_of(joint_words) + "; or " +
                  list_of(other_words));
    map.registers[name] = read_one_register(one, at);
  }
  for (int joint = 1; joint <= map.joints; ++joint)
    if (map.find("joint", joint) == nullptr)
      bad_map(path + "#/registers", "joint-" + std::to_string(joint) + " is missing", "every joint needs its angle");
  return map;
}

}  // namespace gonio::acquisition
