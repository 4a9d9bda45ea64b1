// The devices of a laboratory, opened.
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "acquisition/device/devices.h"
#include "manifest/sections/forward.h"

namespace gonio::acquisition {

struct Instrument {
  std::map<std::string, std::unique_ptr<RobotDevice>> robots;
  std::map<std::string, std::unique_ptr<CameraDevice>> cameras;
  std::map<std::string, std::unique_ptr<LampDevice>> lamps;
  std::map<std::string, std::unique_ptr<TurntableDevice>> turntables;
  std::map<std::string, std::unique_ptr<ScreenDevice>> screens;
  // Where time is simulated: seconds since the instrument began. Else the host's clock counts.
  std::function<double()> clock_s;
};

// By the URLs of the section "laboratory"; nothing moves. Error(data) where a device has none, Error(unavailable) where
// one does not answer.
Instrument open_instrument(const manifest::Document& document);
std::vector<std::string> urls_of(const manifest::Document& document);

// Asks every arm, turntable and lamp how it is, before a run begins; lamps that only take commands are switched off.
// Error(unavailable) for one that does not answer.
void ask_all(Instrument& instrument);

// Turns turntables to these angles. Error(unavailable) for one that then stands more than 1e-3 rad away.
void turn_tables(Instrument& instrument, const std::map<std::string, double>& angles_rad);

// Does any URL reach something outside this program and this computer's loopback? Then nothing moves without --go.
bool is_real(const manifest::Document& document);

// What each device answered, one line each, for people: "robot left (modbus://...): stands, remote control, 31 deg C".
// A device that does not answer is a line, too, and `all_well` becomes false.
std::vector<std::string> inspect(const manifest::Document& document, bool* all_well);

}  // namespace gonio::acquisition
