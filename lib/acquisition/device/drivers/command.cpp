// command:///path/program?on=--relay%201%20on&off=...: lamps, turntables and screens that a program of the user's
// works. The template is split at blanks before {deg} and {file} are filled in, and the words go to the program as they
// are: no shell reads them. Its exit status 0 says that it is done; what it prints is the answer to questions.
#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <sstream>

#include "acquisition/device/connection.h"
#include "acquisition/device/text_devices.h"
#include "base/error.h"
#include "base/text.h"

extern char** environ;

namespace gonio::acquisition::drivers {
namespace {

std::vector<std::string> words_of_command(const std::string& program, const TextLine::Command& command) {
  std::vector<std::string> words{program};
  std::istringstream text(command.text);
  for (std::string word; text >> word;) {
    if (!command.blank.empty())
      if (const auto at = word.find(command.blank); at != std::string::npos)
        word.replace(at, command.blank.size(), command.value);
    words.push_back(word);
  }
  return words;
}

class Child {
 public:
  Child(const std::vector<std::string>& words) {
    int ends[2][2];
    for (auto& pair : ends)
      if (::pipe2(pair, O_CLOEXEC) != 0) throw Lost(std::strerror(errno));
    posix_spawn_file_actions_t actions;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_adddup2(&actions, ends[0][1], 1);
    ::posix_spawn_file_actions_adddup2(&actions, ends[1][1], 2);
    std::vector<char*> arguments;
    for (const auto& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    const int wrong = ::posix_spawn(&child_, words[0].c_str(), &actions, nullptr, arguments.data(), environ);
    ::posix_spawn_file_actions_destroy(&actions);
    for (int i = 0; i < 2; ++i) {
      ::close(ends[i][1]);
      files_[i] = ends[i][0];
    }
    if (wrong == 0) return;
    child_ = -1;
    close();
    throw Lost(std::strerror(wrong));
  }
  ~Child() {
    if (child_ > 0) {
      ::kill(child_, SIGKILL);
      ::waitpid(child_, nullptr, 0);
    }
    close();
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  // Its exit status; Lost where it does not end in time. What it printed is in `out` and `err`.
  int end(Clock::time_point until) {
    while (files_[0] >= 0 || files_[1] >= 0) {
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now()).count() + 1;
      pollfd wanted[2] = {{files_[0], POLLIN, 0}, {files_[1], POLLIN, 0}};
      if (left <= 0 || ::poll(wanted, 2, static_cast<int>(left)) == 0) throw Lost("does not end in time");
      if (wanted[0].revents != 0) take(files_[0], out);
      if (wanted[1].revents != 0) take(files_[1], err);
    }
    int status = 0;
    for (;;) {
      const pid_t ended = ::waitpid(child_, &status, WNOHANG);
      if (ended == child_) break;
      if (ended < 0 && errno != EINTR) throw Lost(std::strerror(errno));
      if (Clock::now() > until) throw Lost("does not end in time");
      ::usleep(500);
    }
    child_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  std::string out, err;

 private:
  void take(int& file, std::string& text) {
    char buffer[4096];
    const ssize_t count = ::read(file, buffer, sizeof buffer);
    if (count > 0) {
      if (text.size() < 100000) text.append(buffer, static_cast<std::size_t>(count));
    } else if (count == 0 || errno != EINTR) {
      ::close(file);
      file = -1;
    }
  }
  void close() {
    for (int& file : files_)
      if (file >= 0) ::close(file);
    files_[0] = files_[1] = -1;
  }
  pid_t child_ = -1;
  int files_[2] = {-1, -1};
};

std::string without_end(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r' || text.back() == ' ')) text.pop_back();
  return text;
}

TextLine command_text_line(const Url& url, UrlQuery& query, const std::string& place) {
  if (!url.host.empty() || url.path.size() < 2)
    throw Error(Exit::usage, place, url.text + ": names no program",
                "write command:///path/of/program, with three strokes");
  const double timeout_s = query.timeout(10);
  const std::string program = url.path;
  const auto ask = [program, timeout_s, place](const TextLine::Command& command) {
    const auto words = words_of_command(program, command);
    const auto refuse = [&](const std::string& problem) {
      return Error(Exit::unavailable, place, program + " " + command.text + ": " + problem, "try it in a terminal");
    };
    try {
      Child child(words);
      const int status = child.end(after(timeout_s));
      const std::string said = without_end(child.err.substr(0, 200));
      if (status != 0) throw refuse(format("ended with %d", status) + (said.empty() ? "" : ", '" + said + "'"));
      return without_end(child.out);
    } catch (const Lost& lost) {
      throw refuse(lost.what());
    }
  };
  return {"program " + program, place, true, ask};
}

std::unique_ptr<LampDevice> command_lamp(const Url& url, const std::string& place) {
  UrlQuery query(url, place);
  return make_text_lamp(command_text_line(url, query, place), query);
}
std::unique_ptr<TurntableDevice> command_turntable(const Url& url, const std::string& place) {
  UrlQuery query(url, place);
  return make_text_turntable(command_text_line(url, query, place), query);
}
std::unique_ptr<ScreenDevice> command_screen(const Url& url, const std::string& place) {
  UrlQuery query(url, place);
  return make_text_screen(command_text_line(url, query, place), query);
}

}  // namespace

const Driver& command() {
  static const Driver its_driver = [] {
    Driver driver;
    driver.scheme = "command";
    driver.sentence =
        "command:///path/program runs a program, without a shell: a lamp's on=, off=, or state= with state-on=, "
        "state-off=; "
        "a turntable's turn={deg}, angle=, stop=, scale=1deg; a screen's show={file}, black=; timeout=10s.";
    driver.lamp = command_lamp;
    driver.turntable = command_turntable;
    driver.screen = command_screen;
    return driver;
  }();
  return its_driver;
}

}  // namespace gonio::acquisition::drivers
