// The exit table and the one line in which every error is said.
#include "base/error.h"

#include <array>
#include <utility>

namespace gonio {
namespace {

constexpr std::array table = {
    ExitMeaning{Exit::done, "done", "The work is done."},
    ExitMeaning{Exit::negative, "negative", "The program ran properly, and the answer is negative."},
    ExitMeaning{Exit::quality, "quality", "The outputs are written, but a quality gate failed."},
    ExitMeaning{Exit::usage, "usage", "The command line is wrong."},
    ExitMeaning{Exit::data, "data", "An input is malformed or impossible."},
    ExitMeaning{Exit::no_input, "no-input", "An input is missing or unreadable."},
    ExitMeaning{Exit::unavailable, "unavailable", "A device or service does not answer."},
    ExitMeaning{Exit::internal, "internal", "A fault of the program itself; please report it."},
    ExitMeaning{Exit::cannot_create, "cannot-create", "An output cannot be created."},
    ExitMeaning{Exit::io, "io", "Reading or writing failed midway, for example because the disk is full."},
    ExitMeaning{Exit::try_again, "try-again", "Interrupted or busy: the same call may succeed."},
};

std::string line(const std::string& place, const std::string& problem, const std::string& remedy) {
  std::string text = place.empty() ? problem : place + ": " + problem;
  if (!remedy.empty()) text += "; " + remedy;
  // Names come from files that others wrote: whatever they hold, this stays one line and moves no cursor.
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  return text;
}

}  // namespace

std::span<const ExitMeaning> exit_table() {
  return table;
}

Error::Error(Exit code, std::string place, std::string problem, std::string remedy)
    : std::runtime_error(line(place, problem, remedy)),
      code_(code),
      place_(std::move(place)),
      problem_(std::move(problem)),
      remedy_(std::move(remedy)) {}

}  // namespace gonio
