// What the registers of a robot's controller mean: names to addresses, types and scales. The map of Universal Robots'
// controllers is built in; any other controller's is a JSON file that the laboratory names:
//
//   {"joints": 6, "registers": {
//     "joint-1": {"address": 100, "type": "float32", "words": "high-first", "table": "holding", "scale": 0.0174533},
//     ..., "standing": {"address": 3, "type": "bit", "table": "discrete"}}}
//
// value = raw * scale (rad, rad/s, kelvin: with "offset", added). Types: bit, uint16, int16, uint32, int32, float32,
// float64; tables: holding, input (registers), coil, discrete (bits). Names: joint-1 .. joint-N (needed), turn-I (whole
// turns to be taken off, as UR's), speed-I, temperature-I, powered, standing, protective-stop, emergency-stop,
// remote-control, mode; and for motion target-I, speed-limit-I, acceleration-limit-I, command, done, stop. A motion is
// handed over by writing a new number into `command` after the targets; the controller copies it to `done` once it has
// arrived.
#pragma once
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/device/devices.h"
#include "acquisition/device/modbus_client.h"

namespace gonio::acquisition {

struct Register {
  enum class Type { bit, uint16, int16, uint32, int32, float32, float64 };
  enum class Table { holding, input, coil, discrete };
  int address = 0;
  Type type = Type::uint16;
  Table table = Table::holding;
  WordOrder order = WordOrder::high_first;
  double scale = 1, offset = 0;
};
struct RegisterMap {
  int joints = 6;
  std::map<std::string, Register> registers;
  const Register* find(const std::string& name, int joint = 0) const;  // joint 0: the name as it is
};

// Universal Robots, all series: 258 mode, 260 power, 261 protective stop, 262 emergency stop; 270-275 angles as
// magnitudes in mrad, 320-325 whole turns to be taken off (angle - 2 pi where 1), 280-285 speeds in mrad/s, 300-305
// temperatures in degrees Celsius; 16 bits, two's complement, addresses from 0.
const RegisterMap& ur_register_map();
// Error(data) at `place`: no JSON, a name or type that is none, a joint without a register, addresses outside 0 ..
// 65535.
RegisterMap read_register_map(const std::string& path, const std::string& place);

struct RegisterReading {
  std::vector<double> joints_rad, speed_rad_per_s, temperature_K;  // the last two empty where the map has none
  std::optional<bool> powered, standing, protective_stop, emergency_stop, remote_control;
  std::optional<int> mode;
};
RegisterReading read_registers(ModbusClient& device, const RegisterMap& map);
double read_register(ModbusClient& device, const Register& which);
void write_register(ModbusClient& device, const Register& which, double value);
double resolution(const Register& which);  // of its scaled value; 0 for floating point

// A robot that has nothing but registers.
std::unique_ptr<RobotDevice> make_register_robot(const ModbusAddress& address, const RegisterMap& map, double stall_s,
                                                 const std::string& place);

}  // namespace gonio::acquisition
