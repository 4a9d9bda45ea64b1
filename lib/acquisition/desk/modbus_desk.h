// The Modbus servers of a simulated laboratory, on loopback through libmodbus: the registers of an arm's controller as
// Universal Robots' map says (registers are packed here by code of their own), lamps behind coils, a turntable behind
// registers.
#pragma once
#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "acquisition/desk/faults.h"
#include "acquisition/desk/true_arm.h"
#include "acquisition/desk/true_devices.h"

namespace gonio::acquisition::desk {

class ModbusDesk {
 public:
  explicit ModbusDesk(Faults& faults, int port = 0);  // 0: any that is free
  ~ModbusDesk();
  int port() const { return port_; }
  // Before the first request:
  void hold_arm(TrueArm& arm);                           // registers 256 .. 405
  void hold_lamp(int coil, TrueLamps& lamps, int lamp);  // coil: its switch; discrete input: what it does
  void hold_turntable(int first, TrueTurntable& table,
                      double one_rad);  // target in first, first + 1; angle in the next two

 private:
  struct Registers;
  struct Held {
    std::function<void(Registers&)> show;                                // before a request is answered
    std::function<void(Registers&, int function, int address)> written;  // after one has written
  };
  void serve();
  bool answer(int socket);
  Faults& faults_;
  int port_ = 0, listening_ = -1;
  std::unique_ptr<Registers> registers_;
  std::vector<Held> held_;
  std::atomic<bool> ending_{false};
  std::mutex mutex_;
  std::thread thread_;
};

}  // namespace gonio::acquisition::desk
