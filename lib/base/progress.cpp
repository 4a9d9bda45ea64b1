// Messages and the progress bar on stderr. A message that appears while a bar is drawn takes the bar's line, and the
// bar is drawn again below it. The time to go is the time so far times the share that is missing over the share done.
#include "base/progress.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <mutex>
#include <utility>

namespace gonio {
namespace {

using Clock = std::chrono::steady_clock;
constexpr auto redraw_interval = std::chrono::milliseconds(100);
constexpr std::string_view clear_line = "\r\x1b[K";

std::mutex terminal;  // guards everything below and the order of lines on stderr
std::string name_of_program = "gonio";
LogLevel threshold = LogLevel::warning;
ProgressMode progress_mode = ProgressMode::automatic;
std::string drawn_bar;  // as it stands on the terminal; empty where there is none

void write_stderr(std::string_view text) {
  while (!text.empty()) {
    const auto written = ::write(STDERR_FILENO, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return;  // nobody is left to be told
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

bool bars_wanted() {
  if (progress_mode != ProgressMode::automatic) return progress_mode == ProgressMode::always;
  const char* kind = std::getenv("TERM");
  return ::isatty(STDERR_FILENO) == 1 && kind != nullptr && std::string_view(kind) != "dumb" &&
         threshold != LogLevel::quiet;
}

std::string clock_time(double seconds) {
  const auto total = static_cast<long>(seconds + 0.5);
  const auto two = [](long v) { return (v < 10 ? "0" : "") + std::to_string(v); };
  const std::string minutes =
      total >= 3600 ? std::to_string(total / 3600) + ":" + two(total / 60 % 60) : std::to_string(total / 60);
  return minutes + ":" + two(total % 60);
}

}  // namespace

void set_program_name(std::string name) {
  const std::lock_guard lock(terminal);
  name_of_program = std::move(name);
}

const std::string& program_name() {
  return name_of_program;
}

void set_log_level(LogLevel level) {
  const std::lock_guard lock(terminal);
  threshold = level;
}

void log(LogLevel level, std::string_view message) {
  const std::lock_guard lock(terminal);
  if (level == LogLevel::quiet || level > threshold) return;
  std::string line = name_of_program + ": " + std::string(message) + "\n";
  if (!drawn_bar.empty()) line = std::string(clear_line) + line + drawn_bar;
  write_stderr(line);
}

void set_progress_mode(ProgressMode mode) {
  const std::lock_guard lock(terminal);
  progress_mode = mode;
}

struct Progress::State {
  std::string title;
  std::uint64_t total, before = 0;
  std::atomic<std::uint64_t> done{before};
  Clock::time_point start = Clock::now();
  std::atomic<Clock::rep> next_draw{(Clock::now() + redraw_interval).time_since_epoch().count()};

  std::string bar(Clock::time_point now) const {
    constexpr int width = 30;
    const auto part = static_cast<double>(std::min(done.load(), total));
    const double share = total == 0 ? 1.0 : part / static_cast<double>(total);
    const int filled = static_cast<int>(share * width);
    const double elapsed_s = std::chrono::duration<double>(now - start).count();
    std::string text = std::string(clear_line) + title + " [" + std::string(static_cast<std::size_t>(filled), '#') +
                       std::string(static_cast<std::size_t>(width - filled), '.') + "] " +
                       std::to_string(static_cast<int>(share * 100)) + " %";
    if (share > 0 && before == 0) text += ", " + clock_time(elapsed_s * (1 - share) / share) + " to go";
    return text;
  }
};

Progress::Progress(std::string title, std::uint64_t total) : state_(new State{std::move(title), total}) {}

Progress::Progress(std::string title, std::uint64_t total, std::uint64_t done)
    : state_(new State{std::move(title), total, done}) {
  const std::lock_guard lock(terminal);
  if (!bars_wanted()) return;
  drawn_bar = state_->bar(state_->start);
  write_stderr(drawn_bar);
}

Progress::~Progress() {
  const std::lock_guard lock(terminal);
  if (!drawn_bar.empty()) write_stderr(clear_line);
  drawn_bar.clear();
  delete state_;
}

void Progress::advance(std::uint64_t steps) {
  state_->done += steps;
  const auto now = Clock::now();
  auto due = state_->next_draw.load();
  const auto next = (now + redraw_interval).time_since_epoch().count();
  if (now.time_since_epoch().count() < due || !state_->next_draw.compare_exchange_strong(due, next)) return;
  const std::lock_guard lock(terminal);
  if (!bars_wanted()) return;
  drawn_bar = state_->bar(now);
  write_stderr(drawn_bar);
}

}  // namespace gonio
