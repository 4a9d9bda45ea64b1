// Lamps and turntables behind a coil or a register of a Modbus device.
#pragma once
#include <memory>
#include <optional>
#include <string>

#include "acquisition/device/devices.h"
#include "acquisition/device/modbus_client.h"
#include "acquisition/device/register_map.h"

namespace gonio::acquisition {

struct ModbusLamp {
  int coil = 0;
  std::optional<int> answer;  // discrete input that says what the lamp does; nothing: the coil itself
  bool inverse = false;       // it is lit where the coil is 0
};
std::unique_ptr<LampDevice> make_modbus_lamp(const ModbusAddress& address, const ModbusLamp& lamp,
                                             const std::string& place);

struct ModbusTurntable {
  Register target, actual;  // scaled to radians
  std::optional<int> stop;  // coil; nothing: where it is becomes its target
  double tolerance_rad = 1e-3, stall_s = 5;
};
std::unique_ptr<TurntableDevice> make_modbus_turntable(const ModbusAddress& address, const ModbusTurntable& table,
                                                       const std::string& place);

}  // namespace gonio::acquisition
