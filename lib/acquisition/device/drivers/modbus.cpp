// modbus://host:port
//   robot      of Universal Robots; with registers=FILE any controller that has a register map
//   lamp       /coil/N
//   turntable  /register/N?scale=0.01deg
#include "acquisition/device/modbus_devices.h"
#include "acquisition/device/register_map.h"
#include "acquisition/device/ur_robot.h"
#include "acquisition/device/url_query.h"
#include "base/error.h"

namespace gonio::acquisition::drivers {
namespace {

ModbusAddress modbus_address(const Url& url, UrlQuery& query, int preset_unit, const std::string& place) {
  if (url.host.empty())
    throw Error(Exit::usage, place, url.text + ": names no host", "write modbus://HOST or modbus://HOST:PORT");
  ModbusAddress address;
  address.host = url.host;
  address.port = url.port.value_or(502);
  address.unit = query.integer("unit", preset_unit, 0, 255);
  if (address.unit > 247 && address.unit != 255)
    throw Error(Exit::usage, place, url.text + ": unit is " + std::to_string(address.unit), "0 to 247, or 255");
  address.timeout_s = query.timeout();
  return address;
}

std::unique_ptr<RobotDevice> modbus_robot(const Url& url, const std::string& place) {
  UrlQuery query(url, place);
  const std::string registers = query.text("registers");
  const ModbusAddress address = modbus_address(url, query, registers.empty() ? 255 : 1, place);
  const double stall_s = query.quantity("stall", Dimension::time, 5, 1e-3, 3600);
  if (!url.path.empty() && url.path != "/")
    throw Error(Exit::usage, place, url.text + ": a robot's URL has no path", "write modbus://HOST:PORT");
  if (!registers.empty()) {
    query.end();
    return make_register_robot(address, read_register_map(registers, place), stall_s, place);
  }
  UrAddress ur;
  ur.host = address.host;
  ur.modbus_unit = address.unit;
  ur.timeout_s = address.timeout_s;
  ur.stall_s = stall_s;
  ur.modbus_port = query.flag("check", true) ? std::optional<int>(address.port) : std::nullopt;
  ur.rtde_port = query.port("rtde", ur.rtde_port).value_or(ur.rtde_port);
  ur.script_port = query.port("script", ur.script_port).value_or(ur.script_port);
  ur.dashboard_port = query.port("dashboard", 29999);
  ur.program_register = query.integer("register", ur.program_register, 0, 47);
  ur.begin_s = query.quantity("begin", Dimension::time, ur.begin_s, 1e-3, 3600);
  query.end();
  return make_ur_robot(ur, place);
}

std::unique_ptr<LampDevice> modbus_lamp(const Url& url, const std::string& place) {
  UrlQuery query(url, place);
  const ModbusAddress address = modbus_address(url, query, 1, place);
  ModbusLamp lamp;
  lamp.coil = query.path_number("coil", 65535);
  if (const int answer = query.integer("answer", -1, 0, 65535); answer >= 0) lamp.answer = answer;
  lamp.inverse = query.flag("inverse", false);
  query.end();
  return make_modbus_lamp(address, lamp, place);
}

Register::Type turntable_type(const Url& url, const std::string& word, const std::string& place) {
  if (word == "int16") return Register::Type::int16;
  if (word == "uint16") return Register::Type::uint16;
  if (word == "int32") return Register::Type::int32;
  if (word == "float32") return Register::Type::float32;
  throw Error(Exit::usage, place, url.text + ": type is '" + word + "'", "int16, uint16, int32 or float32");
}

std::unique_ptr<TurntableDevice> modbus_turntable(const Url& url, const std::string& place) {
  UrlQuery query(url, place);
  const ModbusAddress address = modbus_address(url, query, 1, place);
  ModbusTurntable table;
  table.target.address = query.path_number("register", 65535);
  table.target.type = turntable_type(url, query.text("type", "int32"), place);
  const std::string words = query.text("words", "high-first");
  if (words != "high-first" && words != "low-first")
    throw Error(Exit::usage, place, url.text + ": words is '" + words + "'", "high-first or low-first");
  table.target.order = words == "low-first" ? WordOrder::low_first : WordOrder::high_first;
  query.required("scale", "the angle that one stands for, as 0.01deg");
  table.target.scale = query.quantity("scale", Dimension::angle, 0, -10, 10);
  if (table.target.scale == 0) throw Error(Exit::usage, place, url.text + ": scale is 0", "as 0.01deg");
  table.actual = table.target;
  const int width = table.target.type == Register::Type::int32 || table.target.type == Register::Type::float32 ? 2 : 1;
  table.actual.address = query.integer("actual", std::min(table.target.address + width, 65535), 0, 65535);
  if (const int stop = query.integer("stop", -1, 0, 65535); stop >= 0) table.stop = stop;
  table.tolerance_rad = query.quantity("tolerance", Dimension::angle, 1e-3, 1e-9, 1);
  table.stall_s = query.quantity("stall", Dimension::time, 5, 1e-3, 3600);
  query.end();
  return make_modbus_turntable(address, table, place);
}

}  // namespace

const Driver& modbus() {
  static const Driver its_driver = [] {
    Driver driver;
    driver.scheme = "modbus";
    driver.sentence =
        "modbus://HOST:502 is an arm of Universal Robots (rtde=30004, script=30002, dashboard=29999 or none, "
        "check=no), "
        "or with registers=FILE any controller by its register map; modbus://HOST/coil/N a lamp (answer=N, "
        "inverse=yes); "
        "modbus://HOST/register/N?scale=0.01deg a turntable (actual=N, type=int32, words=high-first, tolerance=0.1deg, "
        "stop=N); unit=1 and timeout=2s for all.";
    driver.robot = modbus_robot;
    driver.lamp = modbus_lamp;
    driver.turntable = modbus_turntable;
    return driver;
  }();
  return its_driver;
}

}  // namespace gonio::acquisition::drivers
