#include "acquisition/run/faulty_instrument.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace gonio::acquisition::testing {
namespace {

struct Room {
  Faults faults;
  Random random;
  std::shared_ptr<Book> book;
  std::map<std::string, bool> said, shines;
  std::map<std::string, double> angle;
  std::uint64_t seed = 1;

  bool strikes(double probability, const std::string& name) {
    if (probability <= 0 || random.uniform() >= probability) return false;
    ++book->injected[name];
    return true;
  }
  std::vector<std::string> shining() const {
    std::vector<std::string> names;
    for (const auto& [name, on] : shines)
      if (on) names.push_back(name);
    return names;
  }
};

class FaultyCamera : public CameraDevice {
 public:
  explicit FaultyCamera(std::shared_ptr<Room> room) : room_(std::move(room)) {}
  std::string identity() override { return "camera of a test"; }

  RawFrame take(const Shot& shot) override {
    Room& room = *room_;
    if (room.strikes(room.faults.no_frame, "no frame"))
      throw Error(Exit::unavailable, "camera", "sent no frame within 2 s");
    if (last_ && room.strikes(room.faults.old_frame, "old frame")) return *last_;
    const double exposure =
        last_ && room.strikes(room.faults.stuck_exposure, "stuck exposure") ? real_s_ : shot.exposure_s;
    if (room.strikes(room.faults.lamp_forgets, "lamp forgets"))
      for (auto& [name, on] : room.shines) room.said[name] = on = false;
    RawFrame frame = picture(exposure);
    room.book->shown[frame.samples] = {exposure, room.angle.empty() ? 0 : room.angle.begin()->second, room.shining()};
    frame.frame_id = ++count_;
    frame.chunk_frame_id = frame.frame_id;
    frame.exposure_s = exposure;
    if (last_ && room.strikes(room.faults.late_chunk, "late chunk")) {
      frame.exposure_s = real_s_;
      frame.chunk_frame_id = count_ - 1;
    }
    if (last_ && room.strikes(room.faults.silent_late_chunk, "silent late chunk")) frame.exposure_s = real_s_;
    if (room.strikes(room.faults.lost_packets, "lost packets")) frame.incomplete_packets = 3;
    real_s_ = exposure;
    last_ = frame;
    return frame;
  }

 private:
  // A ramp of light under every lamp that shines, photon noise, 12 bit.
  RawFrame picture(double exposure_s) {
    RawFrame f;
    f.width_px = 24;
    f.height_px = 16;
    f.bits = 12;
    f.pixel_format = "Mono12";
    const double angle = room_->angle.empty() ? 0 : room_->angle.begin()->second;
    Random own(static_cast<std::uint64_t>(1e9 * exposure_s), static_cast<std::uint64_t>(1e6 * (angle + 10)));
    Random& noise = room_->seed == same_noise ? own : room_->random;
    double light = 2;  // of the room
    for (const std::string& lamp : room_->shining()) light += 40000 + 500 * static_cast<double>(lamp.back());
    for (int i = 0; i < f.width_px * f.height_px; ++i) {
      const double mean = 64 + light * exposure_s * (0.3 + 0.7 * (i % f.width_px) / f.width_px);
      const double code = mean + std::sqrt(0.3 * mean) * noise.normal();
      f.samples.push_back(static_cast<std::uint16_t>(std::clamp(std::round(code), 0.0, 4095.0)));
    }
    return f;
  }
  std::shared_ptr<Room> room_;
  std::optional<RawFrame> last_;
  double real_s_ = 0;
  std::uint64_t count_ = 0;
};

class FaultyLamp : public LampDevice {
 public:
  FaultyLamp(std::shared_ptr<Room> room, std::string name) : room_(std::move(room)), name_(std::move(name)) {}
  void set(bool on) override {
    room_->said[name_] = on;
    room_->shines[name_] = on && !room_->strikes(room_->faults.dead_lamp, "dead lamp");
  }
  bool is_on() override { return room_->said[name_]; }

 private:
  std::shared_ptr<Room> room_;
  std::string name_;
};

class FaultyTable : public TurntableDevice {
 public:
  FaultyTable(std::shared_ptr<Room> room, std::string name) : room_(std::move(room)), name_(std::move(name)) {}
  double angle_rad() override { return room_->angle[name_]; }
  double turn_to(double angle) override { return room_->angle[name_] = angle; }
  void stop() override {}

 private:
  std::shared_ptr<Room> room_;
  std::string name_;
};

}  // namespace

Instrument faulty_instrument(const std::vector<std::string>& cameras, const std::vector<std::string>& lamps,
                             const std::vector<std::string>& tables, const Faults& faults, std::uint64_t seed,
                             std::shared_ptr<Book> book) {
  const auto room = std::make_shared<Room>(Room{faults, Random(seed), std::move(book), {}, {}, {}, seed});
  Instrument instrument;
  for (const auto& name : cameras) instrument.cameras[name] = std::make_unique<FaultyCamera>(room);
  for (const auto& name : lamps) {
    room->said[name] = room->shines[name] = false;
    instrument.lamps[name] = std::make_unique<FaultyLamp>(room, name);
  }
  for (const auto& name : tables) {
    room->angle[name] = 0;
    instrument.turntables[name] = std::make_unique<FaultyTable>(room, name);
  }
  return instrument;
}

}  // namespace gonio::acquisition::testing
