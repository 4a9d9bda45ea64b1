// A camera that people hold in their hands, worked by its cable. Its shutter speed and its ISO are words of a list that
// the camera gives; the picture is a raw file, and says itself how it was exposed.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/device/devices.h"

namespace gonio::acquisition {

// Seconds of a shutter speed as cameras write it: "1/125", "10/1250", "0.0080s", "2", "1.3", "2\"", "0\"3". Nothing for
// "bulb", "Auto" and the like.
std::optional<double> shutter_speed_s(const std::string& words);
// Of a list; nothing where it is empty. By ratio, so that the nearest of 1/100 and 1/125 is found as well as of 10
// and 13.
std::optional<std::string> nearest_choice(const std::vector<std::string>& choices, double wanted,
                                          std::optional<double> (*number_of)(const std::string&));

// The cable: what the driver needs of gphoto2. Lost (connection.h) for whatever fails on the way.
class CameraCable {
 public:
  virtual ~CameraCable() = default;
  virtual std::string identity() = 0;
  virtual std::optional<std::string> value(const std::string& setting) = 0;  // nothing: it has no such setting
  virtual std::vector<std::string> choices(const std::string& setting) = 0;  // empty: it cannot be chosen
  virtual void choose(const std::string& setting, const std::string& choice) = 0;
  struct File {
    std::string name, bytes;
  };
  virtual void forget_files() = 0;  // that somebody else's finger made
  // Releases the shutter: the files that came of it within `patience_s`, until one is a raw file; none stays behind.
  virtual std::vector<File> shoot(double patience_s) = 0;
};

struct TetherSettings {
  std::string name;          // for people
  std::string pixel_format;  // what its raw files hold; empty: whatever it is
  std::string quality;       // the choice that writes raw files; empty: the first that says so
  double base_iso = 100;     // whose gain is 0 dB
  double timeout_s = 30;     // beyond the exposure
};
std::unique_ptr<CameraDevice> make_tethered_camera(TetherSettings settings,
                                                   std::function<std::unique_ptr<CameraCable>()> connect,
                                                   const std::string& place);

}  // namespace gonio::acquisition
