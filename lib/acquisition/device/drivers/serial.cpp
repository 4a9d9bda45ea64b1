// serial:///dev/ttyUSB0?baud=9600&on=L1&off=L0&answer=OK: lamps and turntables by lines of text. A line's answer has no
// number that would tie it to its question: after one that was late, all that comes is thrown away until the line is
// silent for as long as an answer may take.
#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <mutex>

#include "acquisition/device/connection.h"
#include "acquisition/device/text_devices.h"
#include "base/error.h"
#include "base/text.h"

namespace gonio::acquisition::drivers {
namespace {

constexpr std::pair<int, speed_t> baud_codes[] = {
    {1200, B1200},   {2400, B2400},     {4800, B4800},     {9600, B9600},     {19200, B19200},  {38400, B38400},
    {57600, B57600}, {115200, B115200}, {230400, B230400}, {460800, B460800}, {921600, B921600}};

struct SerialSettings {
  std::string path, end = "\n";
  int baud = 9600;
  bool silent = false;  // only questions are answered
  double timeout_s = 2;
};

class SerialLine {
 public:
  SerialLine(const SerialSettings& settings, std::string place) : settings_(settings), place_(std::move(place)) {}
  ~SerialLine() { close(); }
  SerialLine(const SerialLine&) = delete;
  SerialLine& operator=(const SerialLine&) = delete;

  std::string ask(const TextLine::Command& command) {
    const std::lock_guard<std::mutex> lock(one_at_a_time_);
    if (file_ < 0) open();
    if (late_) wait_for_silence();
    ::tcflush(file_, TCIFLUSH);
    std::string text = command.text;
    if (!command.blank.empty())
      if (const auto at = text.find(command.blank); at != std::string::npos)
        text.replace(at, command.blank.size(), command.value);
    write_all(text + settings_.end);
    return settings_.silent && !command.question ? std::string() : read_line(text);
  }

 private:
  [[noreturn]] void fail(const std::string& problem, const std::string& remedy) {
    close();
    throw Error(Exit::unavailable, place_, "serial line " + settings_.path + ": " + problem, remedy);
  }
  void close() {
    if (file_ >= 0) ::close(file_);
    file_ = -1;
  }
  void open() {
    file_ = ::open(settings_.path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (file_ < 0) fail(std::strerror(errno), "is it plugged in, and may you use it (group dialout)?");
    termios line{};
    if (::tcgetattr(file_, &line) != 0) fail("is no serial line", "name a device as /dev/ttyUSB0");
    ::cfmakeraw(&line);
    line.c_cflag |= CLOCAL | CREAD;
    for (const auto& [baud, code] : baud_codes)
      if (baud == settings_.baud) ::cfsetspeed(&line, code);
    if (::tcsetattr(file_, TCSANOW, &line) != 0) fail(std::strerror(errno), "does it know this baud rate?");
  }
  bool wait(short events, Clock::time_point until) {
    pollfd wanted{file_, events, 0};
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now()).count() + 1;
    return left > 0 && ::poll(&wanted, 1, static_cast<int>(left)) > 0;
  }
  void wait_for_silence() {
    char buffer[256];
    const auto give_up = after(10 * settings_.timeout_s);
    while (wait(POLLIN, after(settings_.timeout_s))) {
      if (::read(file_, buffer, sizeof buffer) <= 0 || Clock::now() > give_up)
        fail("does not become silent", "switch the device off and on");
    }
    late_ = false;
  }
  void write_all(std::string_view text) {
    const auto until = after(settings_.timeout_s);
    while (!text.empty()) {
      if (!wait(POLLOUT, until)) fail("takes no text", "check its cable");
      const ssize_t count = ::write(file_, text.data(), text.size());
      if (count < 0 && errno != EAGAIN && errno != EINTR) fail(std::strerror(errno), "check its cable");
      if (count > 0) text.remove_prefix(static_cast<std::size_t>(count));
    }
  }
  std::string read_line(const std::string& command) {
    const auto until = after(settings_.timeout_s);
    std::string text;
    for (;;) {
      if (!wait(POLLIN, until)) {
        late_ = true;
        throw Error(Exit::unavailable, place_,
                    "serial line " + settings_.path + ": no answer to '" + command + "' within " +
                        shortest_text(settings_.timeout_s) + " s",
                    "check baud= and end=, or write silent=yes where commands have no answer");
      }
      char c = 0;
      const ssize_t count = ::read(file_, &c, 1);
      if (count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR)) fail("is gone", "check its cable");
      if (count != 1) continue;
      if (c == settings_.end.back()) break;
      if (c != '\r' && c != '\n') text += c;
      if (text.size() > 1000) fail("an answer without an end", "check baud= and end=");
    }
    return text;
  }

  SerialSettings settings_;
  std::string place_;
  std::mutex one_at_a_time_;
  int file_ = -1;
  bool late_ = false;
};

TextLine serial_text_line(const Url& url, UrlQuery& query, const std::string& place) {
  if (!url.host.empty() || url.path.size() < 2)
    throw Error(Exit::usage, place, url.text + ": names no device", "write serial:///dev/ttyUSB0, with three strokes");
  SerialSettings settings;
  settings.path = url.path;
  settings.baud = query.integer("baud", 9600, 1200, 921600);
  bool known = false;
  for (const auto& [baud, code] : baud_codes) known = known || baud == settings.baud;
  if (!known)
    throw Error(Exit::usage, place, url.text + ": no line runs at " + std::to_string(settings.baud) + " baud",
                "as 9600, 19200, 115200");
  settings.end = query.text("end", "\n");
  if (settings.end.empty()) throw Error(Exit::usage, place, url.text + ": end is empty", "as end=%0D%0A");
  settings.silent = query.flag("silent", false);
  settings.timeout_s = query.timeout();
  const auto line = std::make_shared<SerialLine>(settings, place);
  return {"serial line " + url.path, place, false,
          [line](const TextLine::Command& command) { return line->ask(command); }};
}

std::unique_ptr<LampDevice> serial_lamp(const Url& url, const std::string& place) {
  UrlQuery query(url, place);
  return make_text_lamp(serial_text_line(url, query, place), query);
}
std::unique_ptr<TurntableDevice> serial_turntable(const Url& url, const std::string& place) {
  UrlQuery query(url, place);
  return make_text_turntable(serial_text_line(url, query, place), query);
}

}  // namespace

const Driver& serial() {
  static const Driver its_driver = [] {
    Driver driver;
    driver.scheme = "serial";
    driver.sentence =
        "serial:///dev/ttyUSB0?baud=9600 sends lines of text: a lamp's on=, off= and answer=, or state=, state-on=, "
        "state-off=; a turntable's turn=G0%20A{deg}, angle=, stop=, scale=1deg; end=%0A ends a line, silent=yes says "
        "that "
        "only questions are answered.";
    driver.lamp = serial_lamp;
    driver.turntable = serial_turntable;
    return driver;
  }();
  return its_driver;
}

}  // namespace gonio::acquisition::drivers
