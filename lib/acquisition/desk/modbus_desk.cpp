#include "acquisition/desk/modbus_desk.h"

#include <modbus/modbus.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "acquisition/desk/socket_server.h"

namespace gonio::acquisition::desk {

struct ModbusDesk::Registers {
  modbus_t* context = nullptr;
  modbus_mapping_t* map = nullptr;
  Registers() {
    context = modbus_new_tcp("127.0.0.1", 1502);  // its own socket is never opened: accepted ones are lent to it
    map = modbus_mapping_new(256, 256, 512, 16);
    modbus_set_slave(context, MODBUS_TCP_SLAVE);
    modbus_set_indication_timeout(context, 1, 0);
    modbus_set_response_timeout(context, 0, 1000);  // it waits so long before it refuses an address
  }
  ~Registers() {
    modbus_mapping_free(map);
    modbus_free(context);
  }
};

ModbusDesk::ModbusDesk(Faults& faults, int port)
    : faults_(faults), listening_(listen_on_loopback(port)), registers_(std::make_unique<Registers>()) {
  port_ = port_of(listening_);
  thread_ = std::thread([this] { serve(); });
}

ModbusDesk::~ModbusDesk() {
  ending_ = true;
  thread_.join();
  ::close(listening_);
}

void ModbusDesk::hold_arm(TrueArm& arm) {
  const std::lock_guard<std::mutex> lock(mutex_);
  held_.push_back({[&arm](Registers& registers) {
                     const ArmSnapshot now = arm.now();
                     std::uint16_t* r = registers.map->tab_registers;
                     r[256] = 5, r[257] = 9;
                     r[258] = now.powered ? 7 : 3;
                     r[260] = now.powered, r[261] = now.protective_stop, r[262] = now.emergency_stop;
                     for (std::size_t i = 0; i < 6; ++i) {
                       const double angle = now.joints_rad.at(i);
                       r[320 + i] = angle < 0 ? 1 : 0;
                       r[270 + i] =
                           static_cast<std::uint16_t>((angle < 0 ? angle + 2 * std::numbers::pi : angle) * 1000);
                       const int speed = static_cast<int>(std::lround(now.speed_rad_per_s[i] * 1000));
                       r[280 + i] = static_cast<std::uint16_t>(speed < 0 ? 65536 + speed : speed);
                       r[300 + i] = static_cast<std::uint16_t>(std::lround(now.temperature_C[i]));
                       const int tool = static_cast<int>(std::lround(now.tool[i] * (i < 3 ? 10000 : 1000)));
                       r[400 + i] = static_cast<std::uint16_t>(tool < 0 ? 65536 + tool : tool);
                     }
                   },
                   {}});
}

void ModbusDesk::hold_lamp(int coil, TrueLamps& lamps, int lamp) {
  const std::lock_guard<std::mutex> lock(mutex_);
  held_.push_back(
      {[coil, &lamps, lamp](Registers& registers) { registers.map->tab_input_bits[coil] = lamps.lit(lamp); },
       [this, coil, &lamps, lamp](Registers& registers, int function, int address) {
         if ((function != 5 && function != 15) || address != coil) return;
         const bool on = registers.map->tab_bits[coil] != 0;
         lamps.set(lamp, on && !faults_.strikes(Fault::lamp_dark));
       }});
}

void ModbusDesk::hold_turntable(int first, TrueTurntable& table, double one_rad) {
  const std::lock_guard<std::mutex> lock(mutex_);
  held_.push_back(
      {[first, &table, one_rad](Registers& registers) {
         const auto raw = static_cast<std::int64_t>(std::lround(table.angle_rad() / one_rad));
         registers.map->tab_registers[first + 2] = static_cast<std::uint16_t>(raw / 65536 - (raw % 65536 < 0));
         registers.map->tab_registers[first + 3] = static_cast<std::uint16_t>(raw % 65536 + (raw % 65536 < 0) * 65536);
       },
       [first, &table, one_rad](Registers& registers, int function, int address) {
         if ((function != 6 && function != 16) || address != first) return;
         std::int64_t raw = registers.map->tab_registers[first] * 65536 + registers.map->tab_registers[first + 1];
         if (raw >= 65536ll * 32768) raw -= 65536ll * 65536;
         table.turn_to(static_cast<double>(raw) * one_rad);
       }});
}

// One request of this peer; false where it has gone.
bool ModbusDesk::answer(int socket) {
  std::array<std::uint8_t, MODBUS_TCP_MAX_ADU_LENGTH> request{};
  modbus_set_socket(registers_->context, socket);
  const int length = modbus_receive(registers_->context, request.data());
  if (length < 0) return false;
  if (length == 0) return true;
  if (faults_.strikes(Fault::modbus_reset)) {
    const linger at_once{1, 0};
    ::setsockopt(socket, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
    return false;
  }
  if (faults_.strikes(Fault::modbus_dropped)) return true;
  if (faults_.strikes(Fault::modbus_late)) std::this_thread::sleep_for(std::chrono::duration<double>(faults_.late_s));
  const auto refuse = [&](unsigned code) {
    return modbus_reply_exception(registers_->context, request.data(), code) >= 0;
  };
  if (faults_.strikes(Fault::modbus_exception)) return refuse(MODBUS_EXCEPTION_SLAVE_OR_SERVER_FAILURE);
  if (faults_.strikes(Fault::modbus_busy)) return refuse(MODBUS_EXCEPTION_SLAVE_OR_SERVER_BUSY);
  if (faults_.strikes(Fault::modbus_acknowledge)) return refuse(MODBUS_EXCEPTION_ACKNOWLEDGE);
  if (faults_.strikes(Fault::modbus_gateway)) return refuse(MODBUS_EXCEPTION_GATEWAY_TARGET);
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const auto& held : held_) held.show(*registers_);
  const bool sent = modbus_reply(registers_->context, request.data(), length, registers_->map) >= 0;
  // Head of 7 bytes, function, address.
  for (const auto& held : held_)
    if (held.written) held.written(*registers_, request[7], request[8] * 256 + request[9]);
  return sent;
}

void ModbusDesk::serve() {
  std::vector<pollfd> files{{listening_, POLLIN, 0}};
  while (!ending_) {
    if (::poll(files.data(), files.size(), 10) <= 0) continue;
    for (std::size_t i = files.size(); i-- > 1;) {
      if (files[i].revents == 0 || answer(files[i].fd)) continue;
      ::close(files[i].fd);
      files.erase(files.begin() + static_cast<std::ptrdiff_t>(i));
    }
    if (files[0].revents == 0) continue;
    const int file = ::accept4(listening_, nullptr, nullptr, SOCK_CLOEXEC);
    const int yes = 1;
    if (file >= 0) ::setsockopt(file, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    if (file >= 0) files.push_back({file, POLLIN, 0});
  }
  for (std::size_t i = 1; i < files.size(); ++i) ::close(files[i].fd);
}

}  // namespace gonio::acquisition::desk
