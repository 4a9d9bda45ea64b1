// Lamps, turntables and screens by lines of text: on a serial line (a pseudo-terminal with a device at its other end),
// and by programs.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <stdlib.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <thread>

#include "base/error.h"
#include "data.h"
#include "desk_world.h"

using namespace gonio;
using namespace gonio::acquisition;

namespace {

// Answers every line by what the handler says; nothing where that is "-".
class SerialDevice {
 public:
  explicit SerialDevice(std::function<std::string(const std::string&)> handler) : handler_(std::move(handler)) {
    file_ = ::posix_openpt(O_RDWR | O_NOCTTY);
    if (file_ < 0 || ::grantpt(file_) != 0 || ::unlockpt(file_) != 0) throw std::runtime_error("no pseudo-terminal");
    char name[200];
    if (::ptsname_r(file_, name, sizeof name) != 0) throw std::runtime_error("no pseudo-terminal");
    path_ = name;
    kept_ = ::open(name, O_RDWR | O_NOCTTY);  // so that the line outlives its clients
    thread_ = std::thread([this] { serve(); });
  }
  ~SerialDevice() {
    ending_ = true;
    thread_.join();
    ::close(kept_);
    ::close(file_);
  }
  const std::string& path() const { return path_; }
  void say(const std::string& text) {
    EXPECT_EQ(::write(file_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }

 private:
  void serve() {
    std::string line;
    while (!ending_) {
      pollfd wanted{file_, POLLIN, 0};
      char c = 0;
      if (::poll(&wanted, 1, 5) <= 0 || ::read(file_, &c, 1) != 1) continue;
      if (c != '\n') {
        line += c;
        continue;
      }
      if (const std::string answer = handler_(line); answer != "-") say(answer + "\r\n");
      line.clear();
    }
  }
  std::function<std::string(const std::string&)> handler_;
  int file_ = -1, kept_ = -1;
  std::string path_;
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

std::string problem_of_text(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Exit::unavailable);
    return error.what();
  }
  return "no error";
}

TEST(DeviceText, ALampOnASerialLine) {
  std::atomic<bool> lit{false}, dark{false};
  SerialDevice device([&](const std::string& line) -> std::string {
    if (line == "LAMP 1" || line == "LAMP 0") {
      lit = line.back() == '1' && !dark;
      return "OK";
    }
    return line == "LAMP?" ? (lit ? "lit" : "dark") : "what?";
  });
  const std::string url = "serial://" + device.path() + "?on=LAMP%201&off=LAMP%200&answer=OK";
  const auto lamp = open_lamp(url, "here");
  EXPECT_THAT(problem_of_text([&] { lamp->is_on(); }), testing::HasSubstr("nobody has switched the lamp yet"));
  lamp->set(true);
  EXPECT_TRUE(lit && lamp->is_on());
  lamp->set(false);
  EXPECT_FALSE(lit || lamp->is_on());
  const auto asked = open_lamp(url + "&state=LAMP?&state-on=lit&state-off=dark", "here");
  asked->set(true);
  EXPECT_TRUE(lit && asked->is_on());
  asked->set(false);
  dark = true;
  EXPECT_THAT(problem_of_text([&] { asked->set(true); }), testing::HasSubstr("lamp stays off after it was switched"));
  const auto wrong = open_lamp("serial://" + device.path() + "?on=L&off=M&answer=OK", "here");
  EXPECT_THAT(problem_of_text([&] { wrong->set(true); }), testing::HasSubstr("answered 'what?' instead of 'OK'"));
  EXPECT_THAT(problem_of_text([&] { wrong->is_on(); }), testing::HasSubstr("nobody has switched"));
}

// The answer to a question that was given up on is not taken for that to the next.
TEST(DeviceText, ALateAnswerIsNotTheNextOnes) {
  std::atomic<int> asked{0};
  SerialDevice* line = nullptr;
  SerialDevice device([&](const std::string& text) -> std::string {
    if (text != "STATE") return "-";
    if (++asked > 1) return "0";
    return "-";
  });
  line = &device;
  const auto lamp = open_lamp("serial://" + device.path() + "?on=1&off=0&state=STATE&silent=yes&timeout=30ms", "here");
  EXPECT_THAT(problem_of_text([&] { lamp->is_on(); }), testing::HasSubstr("no answer to 'STATE' within 0.03 s"));
  line->say("1\r\n");  // now it comes
  EXPECT_FALSE(lamp->is_on());
}

TEST(DeviceText, ATurntableOnASerialLine) {
  std::atomic<int> steps{0}, target{0};
  SerialDevice device([&](const std::string& line) -> std::string {
    if (line.rfind("GO ", 0) == 0) {
      target = static_cast<int>(std::lround(std::atof(line.c_str() + 3) * 100));
      return "ok";
    }
    if (line == "HALT") {
      target = steps.load();
      return "ok";
    }
    if (line != "POS") return "error";
    const int left = target - steps;
    steps += left > 500 ? 500 : left < -500 ? -500 : left;
    return std::to_string(steps);
  });
  const auto table = open_turntable(
      "serial://" + device.path() + "?turn=GO%20{deg}&angle=POS&stop=HALT&scale=0.01deg&stall=2s", "here");
  EXPECT_NEAR(table->turn_to(0.5), 0.5, 1e-3);
  EXPECT_NEAR(steps, 0.5 * 18000 / M_PI, 1);
  EXPECT_NEAR(table->turn_to(-1), -1, 1e-3);
  table->stop();
  EXPECT_NEAR(table->angle_rad(), -1, 1e-3);
  const auto broken = open_turntable("serial://" + device.path() + "?turn=GO%20{deg}&angle=WHERE&stop=HALT", "here");
  EXPECT_THAT(problem_of_text([&] { broken->angle_rad(); }), testing::HasSubstr("says that its angle is 'error'"));
}

TEST(DeviceText, NoSuchLine) {
  const auto lamp = open_lamp("serial:///nowhere/ttyUSB7?on=1&off=0&answer=OK", "here");
  EXPECT_THAT(problem_of_text([&] { lamp->set(true); }),
              testing::HasSubstr("/nowhere/ttyUSB7: No such file or directory"));
  const auto plain = open_lamp("serial:///dev/null?on=1&off=0&answer=OK", "here");
  EXPECT_THAT(problem_of_text([&] { plain->set(true); }), testing::HasSubstr("is no serial line"));
}

std::string script_in(const tests::ScratchFolder& folder, const char* name, const std::string& text) {
  const std::string path = (folder / name).string();
  std::ofstream(path) << "#!/bin/sh\n" << text;
  std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  return path;
}

std::string content_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(DeviceText, ALampByAProgram) {
  tests::ScratchFolder folder;
  const std::string path = script_in(folder, "relay",
                                     "cd " + folder.path().string() +
                                         "\ncase $1 in\n on|off) echo $1 > state;;\n ask) cat state;;\n"
                                         " *) echo no such word >&2; exit 3;;\nesac\n");
  const auto lamp = open_lamp("command://" + path + "?on=on&off=off&state=ask&state-on=on&state-off=off", "here");
  lamp->set(true);
  EXPECT_TRUE(lamp->is_on());
  lamp->set(false);
  EXPECT_FALSE(lamp->is_on());
  const auto wrong = open_lamp("command://" + path + "?on=burn&off=off", "here");
  EXPECT_THAT(problem_of_text([&] { wrong->set(true); }), testing::HasSubstr("burn: ended with 3, 'no such word'"));
  EXPECT_THAT(problem_of_text([&] { open_lamp("command:///nowhere/relay?on=1&off=0", "here")->set(true); }),
              testing::HasSubstr("No such file or directory"));
  const std::string slow = script_in(folder, "slow", "exec sleep 60\n");
  EXPECT_THAT(problem_of_text([&] { open_lamp("command://" + slow + "?on=1&off=0&timeout=30ms", "here")->set(true); }),
              testing::HasSubstr("does not end in time"));
}

// What is filled in stays one word, whatever it holds: nothing of it is run.
TEST(DeviceText, NoShellReadsWhatIsFilledIn) {
  tests::ScratchFolder folder;
  const std::string path = script_in(folder, "screen", "printf '%s|' \"$@\" > " + (folder / "shown").string() + "\n");
  const auto screen = open_screen("command://" + path + "?show=--full%20{file}%20$HOME&black=--none", "here");
  screen->show("a b; touch " + (folder / "made").string() + " $(touch " + (folder / "made").string() + ") '\"*.png");
  EXPECT_EQ(content_of(folder / "shown"), "--full|a b; touch " + (folder / "made").string() + " $(touch " +
                                              (folder / "made").string() + ") '\"*.png|$HOME|");
  EXPECT_FALSE(std::filesystem::exists(folder / "made"));
  screen->show("");
  EXPECT_EQ(content_of(folder / "shown"), "--none|");
}

TEST(DeviceText, ATurntableByAProgram) {
  tests::ScratchFolder folder;
  const std::string path = script_in(
      folder, "turn",
      "cd " + folder.path().string() + "\ncase $1 in\n to) echo $2 > angle;;\n at) cat angle;;\n halt) ;;\nesac\n");
  const auto table = open_turntable("command://" + path + "?turn=to%20{deg}&angle=at&stop=halt", "here");
  EXPECT_NEAR(table->turn_to(0.25), 0.25, 1e-6);
  EXPECT_NEAR(table->angle_rad(), 0.25, 1e-6);
}

}  // namespace
