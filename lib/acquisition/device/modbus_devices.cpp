#include "acquisition/device/modbus_devices.h"

#include <atomic>
#include <cmath>
#include <thread>

#include "acquisition/device/connection.h"
#include "base/error.h"
#include "base/text.h"

namespace gonio::acquisition {
namespace {

class CoilLamp : public LampDevice {
 public:
  CoilLamp(const ModbusAddress& address, const ModbusLamp& lamp, const std::string& place)
      : device_(address, place), lamp_(lamp), host_(address.host), place_(place), patience_s_(address.timeout_s) {}

  void set(bool on) override {
    device_.write_bit(lamp_.coil, on != lamp_.inverse);
    const auto until = after(patience_s_);
    while (is_on() != on) {
      if (Clock::now() >= until)
        throw Error(Exit::unavailable, place_,
                    format("lamp at coil %d of %s stays %s after it was switched %s", lamp_.coil, host_.c_str(),
                           on ? "off" : "on", on ? "on" : "off"),
                    "look at the lamp, its supply and its relay");
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }
  bool is_on() override {
    const bool bit = lamp_.answer ? device_.bits(BitTable::discrete, *lamp_.answer, 1).at(0)
                                  : device_.bits(BitTable::coil, lamp_.coil, 1).at(0);
    return bit != lamp_.inverse;
  }
  bool answers() const override { return lamp_.answer.has_value(); }

 private:
  ModbusClient device_;
  ModbusLamp lamp_;
  std::string host_, place_;
  double patience_s_;
};

class RegisterTurntable : public TurntableDevice {
 public:
  RegisterTurntable(const ModbusAddress& address, const ModbusTurntable& table, const std::string& place)
      : device_(address, place), table_(table), host_(address.host), place_(place) {
    table_.tolerance_rad = std::max(table_.tolerance_rad, resolution(table_.actual) + resolution(table_.target));
  }

  double angle_rad() override {
    const double angle = read_register(device_, table_.actual);
    if (!std::isfinite(angle)) throw unavailable("its angle is no number");
    return angle;
  }
  // It stands where two readings in a row agree.
  double turn_to(double angle_rad) override {
    const int stops_before = stops_;
    write_register(device_, table_.target, angle_rad);
    const double kept = read_register(device_, table_.target);
    if (!(std::abs(kept - angle_rad) <= resolution(table_.target) + 1e-6 * std::abs(angle_rad)))
      throw unavailable(format("keeps %g rad as its target, sent was %g", kept, angle_rad));
    double last = this->angle_rad();
    for (auto moved = Clock::now();;) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      const double now = this->angle_rad();
      if (stops_ != stops_before) throw unavailable("was stopped on request");
      if (now == last && std::abs(now - angle_rad) <= table_.tolerance_rad) return now;
      if (now != last) moved = Clock::now();
      last = now;
      if (Clock::now() > moved + std::chrono::duration<double>(table_.stall_s)) {
        stop();
        throw unavailable(
            format("stands at %.6f rad instead of %.6f (limit %g)", now, angle_rad, table_.tolerance_rad));
      }
    }
  }
  void stop() override {
    ++stops_;
    if (table_.stop)
      device_.write_bit(*table_.stop, true);
    else
      write_register(device_, table_.target, angle_rad());
    double last = angle_rad();
    for (const auto until = after(table_.stall_s);;) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      const double now = angle_rad();
      if (std::abs(now - last) <= 0) return;
      last = now;
      if (Clock::now() > until) throw unavailable("does not come to a stand");
    }
  }

 private:
  Error unavailable(const std::string& problem) const {
    return Error(Exit::unavailable, place_, "turntable at " + host_ + ": " + problem,
                 "look at the turntable and at scale and type in its URL");
  }
  ModbusClient device_;
  ModbusTurntable table_;
  std::string host_, place_;
  std::atomic<int> stops_{0};
};

}  // namespace

std::unique_ptr<LampDevice> make_modbus_lamp(const ModbusAddress& address, const ModbusLamp& lamp,
                                             const std::string& place) {
  return std::make_unique<CoilLamp>(address, lamp, place);
}

std::unique_ptr<TurntableDevice> make_modbus_turntable(const ModbusAddress& address, const ModbusTurntable& table,
                                                       const std::string& place) {
  return std::make_unique<RegisterTurntable>(address, table, place);
}

}  // namespace gonio::acquisition
