// The Modbus servers of a simulated laboratory, on loopback through libmodbus: the registers of an arm's controller as
// Universal Robots' map says (registers are packed here by code of their own), lamps behind coils, a turntable behind
// registers.
#pragma once
#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "acquisition/desk/faults.h"
#include "acquisition/desk/true_arm.h"

namespace gonio::acquisition::desk {

// What the lamps of the laboratory truly do. Threads may ask at once.
class TrueLamps {
 public:
  void set(int lamp, bool lit) {
    const std::lock_guard<std::mutex> lock(mutex_);
    lit_[lamp] = lit;
  }
  bool lit(int lamp) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto at = lit_.find(lamp);
    return at != lit_.end() && at->second;
  }

 private:
  mutable std::mutex mutex_;
  std::map<int, bool> lit_;
};

// Turns towards its target at a steady speed, in simulated time.
class TrueTurntable {
 public:
  TrueTurntable(double speed_rad_per_s, double time_factor)
      : speed_(speed_rad_per_s * time_factor), since_(std::chrono::steady_clock::now()) {}
  double angle_rad() const;
  double target_rad() const;
  void turn_to(double angle_rad);
  void stop() { turn_to(angle_rad()); }

 private:
  double reached() const;
  mutable std::mutex mutex_;
  double speed_, from_ = 0, target_ = 0;
  std::chrono::steady_clock::time_point since_;
};

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
