// See gige_camera.h. Control: GigE Vision 1.2, sections 13 to 18; stream: sections 23 to 26.
#include "acquisition/desk/gige_camera.h"

#include <arpa/inet.h>
#include <arv.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <optional>
#include <span>
#include <thread>

#include "acquisition/desk/gige_packets.h"
#include "acquisition/desk/network_bytes.h"
#include "base/error.h"
#include "base/progress.h"
#include "base/text.h"

namespace gonio::acquisition::desk {
namespace {

constexpr int gvcp_port = 3956;
// Bootstrap registers, and those of gige_description.cpp.
constexpr std::uint32_t at_maker = 0x48, at_model = 0x68, at_heartbeat = 0x938, at_privilege = 0xa00;
constexpr std::uint32_t at_stream_port = 0xd00, at_packet_size = 0xd04, at_stream_address = 0xd18;
constexpr std::uint32_t at_exposure = 0x440, at_gain = 0x448, at_temperature = 0x450, at_chunks = 0x460;
constexpr std::uint32_t at_payload = 0x420;
constexpr std::size_t packet_overhead = 36;  // IP, UDP and GVSP heads

std::uint32_t u16_at(const std::uint8_t* bytes) {
  return bytes[0] * 256U + bytes[1];
}
std::uint32_t u32_at(const std::uint8_t* bytes) {
  return u16_at(bytes) << 16U | u16_at(bytes + 2);
}

int bound_socket(const std::string& address, int port) {
  const int file = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in here{};
  here.sin_family = AF_INET;
  here.sin_port = htons(static_cast<std::uint16_t>(port));
  ::inet_pton(AF_INET, address.c_str(), &here.sin_addr);
  if (file >= 0 && ::bind(file, reinterpret_cast<const sockaddr*>(&here), sizeof here) == 0) return file;
  if (file >= 0) ::close(file);
  return -1;
}

}  // namespace

struct GigeCamera::Camera {
  struct Asked {  // of one frame, as the fill function found the registers
    std::uint64_t frame_id = 0, timestamp_ns = 0;
    Shot shot;
    GigeFormat format;
  };

  Camera(GigeSettings wanted, Expose exposing, Faults& kinds)
      : settings(std::move(wanted)), expose(std::move(exposing)), faults(kinds) {
    formats = gige_formats(settings.format.mosaic);
    try {
      open_sockets();
      set_up();
    } catch (...) {
      close_all();
      throw;
    }
    control_thread = std::thread([this] { control(); });
    frame_thread = std::thread([this] { take_frames(); });
  }
  ~Camera() {
    ending = true;
    triggered.notify_all();
    if (control_thread.joinable()) control_thread.join();
    if (frame_thread.joinable()) frame_thread.join();
    close_all();
  }
  void close_all() {
    if (registers != nullptr) g_object_unref(registers);
    for (const int file : {control_socket, stream_socket})
      if (file >= 0) ::close(file);
  }

  void open_sockets() {
    std::string address = settings.address.empty() ? "127.0.0.2" : settings.address;
    control_socket = bound_socket(address, gvcp_port);
    for (int n = 3; control_socket < 0 && settings.address.empty() && n < 255; ++n)
      control_socket = bound_socket(address = "127.0.0." + std::to_string(n), gvcp_port);
    if (control_socket < 0)
      throw Error(Exit::unavailable, "camera " + settings.name, address + ":" + std::to_string(gvcp_port) + " is taken",
                  "end the program that serves a camera there");
    settings.address = address;
    stream_socket = bound_socket(address, 0);
  }

  void set_up() {
    const std::string description = gige_description(formats);
    const int file = ::memfd_create("description.xml", MFD_CLOEXEC);  // aravis reads it from a file alone
    if (file < 0 || ::write(file, description.data(), description.size()) < 0)
      throw Error(Exit::io, "camera " + settings.name, "no memory for its description");
    const std::string path = "/proc/self/fd/" + std::to_string(file);
    registers = arv_fake_camera_new_full(settings.name.substr(0, 15).c_str(), path.c_str());
    ::close(file);
    arv_fake_camera_set_fill_pattern(registers, note, this);
    for (const auto& [at, words] : {std::pair{at_maker, "gonio"}, {at_model, "simulated camera"}})
      arv_fake_camera_write_memory(registers, at, static_cast<std::uint32_t>(std::strlen(words) + 1), words);
    in_addr here{};
    ::inet_pton(AF_INET, settings.address.c_str(), &here);
    arv_fake_camera_write_memory(registers, 0x24, sizeof here, &here);
    for (const std::uint32_t at : {ARV_FAKE_CAMERA_REGISTER_WIDTH, ARV_FAKE_CAMERA_REGISTER_SENSOR_WIDTH})
      write(at, static_cast<std::uint32_t>(settings.width_px));
    for (const std::uint32_t at : {ARV_FAKE_CAMERA_REGISTER_HEIGHT, ARV_FAKE_CAMERA_REGISTER_SENSOR_HEIGHT})
      write(at, static_cast<std::uint32_t>(settings.height_px));
    const auto found = std::ranges::find_if(formats, [this](const GigeFormat& format) {
      const auto parsed = parse_pixel_format(format.name);
      return parsed && parsed->bits == settings.format.bits && parsed->packing == settings.format.packing;
    });
    if (found == formats.end()) {
      std::string names;
      for (const GigeFormat& format : formats) names += (names.empty() ? "" : ", ") + format.name;
      throw Error(Exit::data, "camera " + settings.name, settings.format.unpacked() + " cannot be served",
                  "its pixel_format may be " + names);
    }
    write(ARV_FAKE_CAMERA_REGISTER_PIXEL_FORMAT, found->number);
    write(at_packet_size, 8000);
    write_real(at_exposure, 10000);
    tidy();
  }

  std::uint32_t read(std::uint32_t at) const {
    std::uint32_t value = 0;
    arv_fake_camera_read_register(registers, at, &value);
    return value;
  }
  void write(std::uint32_t at, std::uint32_t value) { arv_fake_camera_write_register(registers, at, value); }
  double read_real(std::uint32_t at) const {
    const std::uint64_t bits = static_cast<std::uint64_t>(read(at)) << 32U | read(at + 4);
    double value = 0;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }
  void write_real(std::uint32_t at, double value) {
    const std::string bytes = NetworkBytes().real(value).all();
    arv_fake_camera_write_memory(registers, at, 8, bytes.data());
  }
  bool acquires() const { return read(at_privilege) != 0 && arv_fake_camera_get_acquisition_status(registers) != 0; }

  // After registers were written: exposure and gain as the sensor counts them, what follows from the pixel format.
  void tidy() {
    const double us = std::clamp(std::round(read_real(at_exposure)), 1.0, 3.6e9);
    const double centibels = std::clamp(std::round(read_real(at_gain) * 100), 0.0, 4800.0);
    write_real(at_exposure, us);
    write_real(at_gain, centibels / 100);
    write(ARV_FAKE_CAMERA_REGISTER_EXPOSURE_TIME_US, static_cast<std::uint32_t>(us));
    write(ARV_FAKE_CAMERA_REGISTER_GAIN_RAW, static_cast<std::uint32_t>(centibels));
    const std::size_t pixels = arv_fake_camera_get_payload(registers);
    write(at_payload, static_cast<std::uint32_t>(pixels + (read(at_chunks) != 0 ? gige_chunk_bytes : 0)));
    if (arv_fake_camera_check_and_acknowledge_software_trigger(registers) && acquires() &&
        !faults.strikes(Fault::trigger_lost))
      ++triggers;
    if (!acquires()) triggers = 0;
    triggered.notify_all();
  }

  // aravis's fill function: called with the registers held, and done at once. The picture is rendered afterwards.
  static void note(ArvBuffer* buffer, void* data, guint32 exposure_us, guint32 centibels, ArvPixelFormat number) {
    auto& camera = *static_cast<Camera*>(data);
    camera.asked.frame_id = arv_buffer_get_frame_id(buffer);
    camera.asked.timestamp_ns = arv_buffer_get_timestamp(buffer);
    camera.asked.shot = {exposure_us / 1e6, centibels / 100.0};
    for (const GigeFormat& format : camera.formats)
      if (format.number == static_cast<std::uint32_t>(number)) camera.asked.format = format;
  }

  void control();
  std::string answer(const std::uint8_t* request, std::size_t length, const sockaddr_in& from);
  std::string answer_write(std::uint32_t what, const std::uint8_t* data, std::size_t length, bool may);
  bool holds(const sockaddr_in& from);

  void take_frames();
  bool wait_for_frame();
  void send_frame(const Asked& frame, const RawFrame& picture, const GigeFigures& figures);
  void send_packets(const std::vector<std::string>& packets, const sockaddr_in& to);

  GigeSettings settings;
  Expose expose;
  Faults& faults;
  std::vector<GigeFormat> formats;
  int control_socket = -1, stream_socket = -1;
  ArvFakeCamera* registers = nullptr;
  std::mutex mutex;  // of all that follows, and of the registers
  std::condition_variable triggered;
  int triggers = 0;
  Asked asked;
  std::optional<sockaddr_in> controller;
  std::chrono::steady_clock::time_point heard{};
  std::optional<GigeFigures> before;  // of the frame before; the frames' thread's alone
  std::atomic<bool> ending{false};
  std::thread control_thread, frame_thread;
};

// Who wrote the privilege holds the camera until it gives it back or falls silent.
bool GigeCamera::Camera::holds(const sockaddr_in& from) {
  const auto now = std::chrono::steady_clock::now();
  if (controller && now - heard > std::chrono::milliseconds(read(at_heartbeat))) {
    controller.reset();
    write(at_privilege, 0);
    write(ARV_FAKE_CAMERA_REGISTER_ACQUISITION, 0);
  }
  const bool same =
      controller && controller->sin_port == from.sin_port && controller->sin_addr.s_addr == from.sin_addr.s_addr;
  if (same) heard = now;
  return same || !controller;
}

std::string GigeCamera::Camera::answer_write(std::uint32_t what, const std::uint8_t* data, std::size_t length,
                                             bool may) {
  const bool memory = what == 0x86;
  if (may && memory && length > 4)
    arv_fake_camera_write_memory(registers, u32_at(data), static_cast<std::uint32_t>(length - 4), data + 4);
  for (std::size_t i = 0; may && !memory && i + 8 <= length; i += 8) write(u32_at(data + i), u32_at(data + i + 4));
  if (may) tidy();
  return NetworkBytes().u16(0).u16(memory ? 0U : static_cast<std::uint32_t>(length / 8)).all();
}

// Head: 0x42, flags, command, length, number; answered by status, command + 1, length, number.
std::string GigeCamera::Camera::answer(const std::uint8_t* request, std::size_t length, const sockaddr_in& from) {
  if (length < 8 || request[0] != 0x42 || u16_at(request + 4) + 8 > length) return {};
  const std::uint32_t what = u16_at(request + 2);
  const std::uint8_t* data = request + 8;
  const std::size_t size = u16_at(request + 4);
  const std::lock_guard<std::mutex> lock(mutex);
  const bool may = holds(from);
  std::string body;
  if (what == 0x02) {
    body.resize(0xf8);
    arv_fake_camera_read_memory(registers, 0, 0xf8, body.data());
  } else if (what == 0x80) {
    NetworkBytes values;
    for (std::size_t i = 0; i + 4 <= size; i += 4) values.u32(read(u32_at(data + i)));
    body = values.all();
  } else if (what == 0x84 && size >= 8 && u16_at(data + 6) > 0 && u16_at(data + 6) <= 536) {
    const std::uint32_t count = u16_at(data + 6);
    body.resize(4 + count);
    std::copy(data, data + 4, body.begin());
    arv_fake_camera_read_memory(registers, u32_at(data), count, body.data() + 4);
  } else if (what == 0x82 || (what == 0x86 && size >= 4)) {
    body = answer_write(what, data, size, may);
    if (may && !controller && read(at_privilege) != 0) controller = from, heard = std::chrono::steady_clock::now();
    if (may && controller && read(at_privilege) == 0) controller.reset();
  } else {
    return {};  // PACKETRESEND and what else it does not know
  }
  const bool denied = (what == 0x82 || what == 0x86) && !may;
  NetworkBytes whole;
  whole.u16(denied ? 0x8006 : 0).u16(what + 1).u16(static_cast<std::uint32_t>(body.size())).u16(u16_at(request + 6));
  return whole.text(body).all();
}

void GigeCamera::Camera::control() {
  std::vector<std::uint8_t> request(2048), answered;
  sockaddr_in asked_by{};
  std::string reply;
  while (!ending) {
    pollfd wanted{control_socket, POLLIN, 0};
    if (::poll(&wanted, 1, 20) <= 0) continue;
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const ssize_t length = ::recvfrom(control_socket, request.data(), request.size(), MSG_DONTWAIT,
                                      reinterpret_cast<sockaddr*>(&from), &size);
    if (length <= 0) continue;
    // Who heard no answer asks again under the same number: it is answered again, and not done twice. A trigger would
    // send a second frame, which the next shot would take for its own.
    const std::span<const std::uint8_t> now(request.data(), static_cast<std::size_t>(length));
    const bool again = std::ranges::equal(now, answered) && from.sin_port == asked_by.sin_port &&
                       from.sin_addr.s_addr == asked_by.sin_addr.s_addr;
    if (!again) reply = answer(now.data(), now.size(), from);
    answered.assign(now.begin(), now.end()), asked_by = from;
    if (reply.empty() || faults.strikes(Fault::gige_dropped)) continue;
    ::sendto(control_socket, reply.data(), reply.size(), 0, reinterpret_cast<const sockaddr*>(&from), size);
  }
}

// Until a trigger, or a camera that runs freely, asks for a frame; notes what is asked. False: nothing yet.
bool GigeCamera::Camera::wait_for_frame() {
  std::unique_lock<std::mutex> lock(mutex);
  const auto wanted = [this] {
    if (ending || !acquires()) return ending.load();
    return triggers > 0 || arv_fake_camera_is_in_free_running_mode(registers) != 0;
  };
  if (!triggered.wait_for(lock, std::chrono::milliseconds(50), wanted) || ending) return false;
  triggers = std::max(0, triggers - 1);
  ArvBuffer* buffer = arv_buffer_new_allocate(arv_fake_camera_get_payload(registers));
  arv_fake_camera_fill_buffer(registers, buffer, nullptr);
  g_object_unref(buffer);
  return true;
}

void GigeCamera::Camera::take_frames() {
  while (!ending) {
    if (!wait_for_frame()) continue;
    Asked frame = asked;
    if (before && faults.strikes(Fault::stuck_exposure)) frame.shot.exposure_s = before->exposure_us / 1e6;
    RawFrame picture;
    try {
      picture = expose(frame.shot, parse_pixel_format(frame.format.name).value());
    } catch (const std::exception& e) {
      log(LogLevel::warning, "camera " + settings.name + ": " + e.what());
      continue;  // no frame comes, and the client says so
    }
    const GigeFigures now{std::round(frame.shot.exposure_s * 1e6), frame.shot.gain_db.value_or(0), frame.frame_id};
    {
      const std::lock_guard<std::mutex> lock(mutex);
      write_real(at_temperature, picture.temperature_K.value_or(293.15) - 273.15);
    }
    const bool late = before && faults.strikes(Fault::chunk_late);
    send_frame(frame, picture, late ? *before : now);
    before = now;
  }
}

void GigeCamera::Camera::send_frame(const Asked& frame, const RawFrame& picture, const GigeFigures& figures) {
  sockaddr_in to{};
  std::size_t most = 0;
  bool chunks = false;
  {
    const std::lock_guard<std::mutex> lock(mutex);
    if (!acquires()) return;
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(read(at_stream_port)));
    to.sin_addr.s_addr = htonl(read(at_stream_address));
    most = std::max<std::size_t>(read(at_packet_size) & 0xffffU, 576) - packet_overhead;
    chunks = read(at_chunks) != 0;
    if (read(ARV_FAKE_CAMERA_REGISTER_ACQUISITION_MODE) == 2) write(ARV_FAKE_CAMERA_REGISTER_ACQUISITION, 0);
  }
  auto packets = packets_of({frame.frame_id, frame.timestamp_ns, frame.format.number, picture.width_px,
                             picture.height_px, pack(picture.samples, parse_pixel_format(frame.format.name).value())},
                            chunks ? std::optional(figures) : std::nullopt, most);
  if (faults.strikes(Fault::frame_dropped))
    packets.erase(packets.begin() + static_cast<std::ptrdiff_t>(faults.share(Fault::frame_dropped) *
                                                                static_cast<double>(packets.size())));
  if (faults.strikes(Fault::frame_reordered) && packets.size() > 3)
    std::swap(packets[1], packets[1 + static_cast<std::size_t>(faults.share(Fault::frame_reordered) *
                                                               static_cast<double>(packets.size() - 2))]);
  send_packets(packets, to);
}

// A receiver's queue holds some 200 kB: it is given time to empty it.
void GigeCamera::Camera::send_packets(const std::vector<std::string>& packets, const sockaddr_in& to) {
  std::size_t sent = 0;
  for (const auto& packet : packets) {
    ::sendto(stream_socket, packet.data(), packet.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
    sent += packet.size();
    if (sent < 48000) continue;
    std::this_thread::sleep_for(std::chrono::milliseconds(3));
    sent = 0;
  }
}

GigeCamera::GigeCamera(const GigeSettings& settings, Expose expose, Faults& faults)
    : camera_(std::make_unique<Camera>(settings, std::move(expose), faults)) {}
GigeCamera::~GigeCamera() = default;
const std::string& GigeCamera::address() const {
  return camera_->settings.address;
}

}  // namespace gonio::acquisition::desk
