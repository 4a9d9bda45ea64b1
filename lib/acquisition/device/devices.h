// What an instrument is made of, one small interface a kind. A driver is one file in device/drivers, chosen by the
// scheme of its URL; the build gathers them. Every call says what it found, never what it hopes: a motion is over when
// the state that was read back says so. All calls block, none for ever: a device that falls silent is given up after
// the `timeout` of its URL. Error(unavailable) says which device, what it answered and what to look at. No driver moves
// anything that it was not told to move, and one that gives up on a motion stops it first.
#pragma once
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geom/rigid.h"

namespace gonio::acquisition {

using Clock = std::chrono::steady_clock;

// "modbus://host:502/coil/3?unit=1": scheme, host, port, path, query. %41 is A, in host, path and query; a plus is a
// plus. Error(usage) at `place` for what is none: no scheme, a port outside 1 .. 65535, a key that is given twice,
// blanks, user names and fragments.
struct Url {
  std::string text, scheme, host, path;
  std::optional<int> port;
  std::map<std::string, std::string> query;
};
Url parse_url(const std::string& text, const std::string& place);
// The same with one more key in its query: what the laboratory holds beside the URL (`registers`, the path of a
// register map). Error(usage) where the key is there.
std::string with_query(const std::string& url, const std::string& key, const std::string& value,
                       const std::string& place);

struct RobotState {
  double time_s = 0;               // controller's clock
  std::vector<double> joints_rad;  // actual, turns counted
  std::vector<double> speed_rad_per_s, temperature_K;
  std::optional<Rigid<frame::Base, frame::Tool>> base_from_tool;  // as the controller says
  bool powered = false, standing = false, protective_stop = false, emergency_stop = false;
  bool remote_control = false;  // the controller does not say that it obeys its pendant alone
  std::string mode;             // the controller's own word
};
class RobotDevice {
 public:
  virtual ~RobotDevice() = default;
  virtual RobotState state() = 0;
  // Along straight lines in joint space through `way` (the first is where it stands, within 1e-3 rad), each joint
  // within the speeds and accelerations given; it stands for a moment at each. Returns once the arm stands at the last
  // within 1e-4 rad, or stops it and throws: protective stop, joint that did not arrive, connection lost. `speeds`,
  // `accelerations`: one a joint, above 0.
  virtual RobotState move(std::span<const std::vector<double>> way, std::span<const double> speeds,
                          std::span<const double> accelerations) = 0;
  virtual void stop() = 0;  // at once, also from another thread; returns when it stands
};

// Pixels as the sensor wrote them.
struct RawFrame {
  int width_px = 0, height_px = 0, bits = 8;                                // used bits of each sample
  std::string pixel_format;                                                 // unpacked: "Mono12", "BayerRG8", ...
  std::vector<std::uint16_t> samples;                                       // row by row
  std::uint64_t frame_id = 0;                                               // the camera's count
  std::optional<double> camera_time_s, exposure_s, gain_db, temperature_K;  // as the camera says of this very frame
  std::optional<std::uint64_t> chunk_frame_id;  // of the frame that those figures belong to, where the camera says
  std::int64_t incomplete_packets = 0;          // that never came; there may be no samples then
};
struct Shot {  // what is asked for
  double exposure_s = 0;
  std::optional<double> gain_db;
};
class CameraDevice {
 public:
  virtual ~CameraDevice() = default;
  virtual std::string identity() = 0;  // maker, model, serial number
  // One frame whose exposure began after the call. Error(unavailable) where none came in time.
  virtual RawFrame take(const Shot& shot) = 0;
};

class LampDevice {
 public:
  virtual ~LampDevice() = default;
  virtual void set(bool on) = 0;  // returns once it was read back
  virtual bool is_on() = 0;
  // Does is_on() say what the lamp does, and not what it was told?
  virtual bool answers() const { return false; }
  // Can is_on() be asked now? Not of a lamp that only takes commands and has had none.
  virtual bool knows() const { return true; }
};
class TurntableDevice {
 public:
  virtual ~TurntableDevice() = default;
  virtual double angle_rad() = 0;
  virtual double turn_to(double angle_rad) = 0;  // returns the angle that was read back
  virtual void stop() = 0;
};
class ScreenDevice {
 public:
  virtual ~ScreenDevice() = default;
  virtual void show(const std::string& picture_path) = 0;  // empty: black
};

// One way to reach devices: lib/acquisition/device/drivers/<scheme>.cpp defines `const Driver& <scheme>()` in namespace
// gonio::acquisition::drivers. A kind that it cannot open is a null pointer.
struct Driver {
  std::string scheme;    // "modbus"
  std::string sentence;  // for the manual page: what its URL looks like, what it reaches
  std::unique_ptr<RobotDevice> (*robot)(const Url& url, const std::string& place) = nullptr;
  std::unique_ptr<CameraDevice> (*camera)(const Url& url, const std::string& place) = nullptr;
  std::vector<std::string> camera_keys{};  // of its URL, that the laboratory's entry of a camera says: see camera_url()
  std::unique_ptr<LampDevice> (*lamp)(const Url& url, const std::string& place) = nullptr;
  std::unique_ptr<TurntableDevice> (*turntable)(const Url& url, const std::string& place) = nullptr;
  std::unique_ptr<ScreenDevice> (*screen)(const Url& url, const std::string& place) = nullptr;
};
std::span<const Driver* const> all_drivers();  // by scheme; defined in a generated source

// With what the laboratory says of the camera beside its URL, where its driver has a key for it: `pixel_format`;
// `trigger`, "software" or "hardware", whose line the URL names. Error(data) where the URL says another.
std::string camera_url(const std::string& url, const std::string& pixel_format, const std::string& trigger,
                       const std::string& place);

// By scheme. Error(usage) at `place` that lists the schemes there are for this kind of device.
std::unique_ptr<RobotDevice> open_robot(const std::string& url, const std::string& place);
std::unique_ptr<CameraDevice> open_camera(const std::string& url, const std::string& place);
std::unique_ptr<LampDevice> open_lamp(const std::string& url, const std::string& place);
std::unique_ptr<TurntableDevice> open_turntable(const std::string& url, const std::string& place);
std::unique_ptr<ScreenDevice> open_screen(const std::string& url, const std::string& place);

}  // namespace gonio::acquisition
