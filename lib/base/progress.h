// Progress and messages: both go to stderr; stdout carries the manifest and nothing else.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace gonio {

enum class LogLevel { quiet, error, warning, info, debug };
void set_program_name(std::string name);  // prefix of every line
const std::string& program_name();
void set_log_level(LogLevel level);
void log(LogLevel level, std::string_view message);  // "NAME: message" on stderr where `level` is switched on

enum class ProgressMode { automatic, always, never };  // automatic: a bar on a terminal, nothing in cron
void set_progress_mode(ProgressMode mode);

// A bar with the share done and the time to go. Thread-safe; drawn at most ten times a second; cleared when destroyed.
class Progress {
 public:
  Progress(std::string title, std::uint64_t total);
  // One long step of several, `done` of which others have taken: drawn at once, without a time to go.
  Progress(std::string title, std::uint64_t total, std::uint64_t done);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void advance(std::uint64_t steps = 1);

 private:
  struct State;
  State* state_;
};

}  // namespace gonio
