// Errors and exit codes: the one table that every program, man page and test reads.
//
// A program ends with one line on stderr that names the place, the value, the limit and the remedy:
//   handeye: rig.json#/poses/3: rotation is not orthonormal (|R'R - I| = 3e-2, limit 1e-6); re-export with 7 digits
// `place` is a file, a file with a JSON pointer (file#/a/b), or an option (--spp).
#pragma once
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace gonio {

// 0-2 say how the work went; from 64 on the numbers and meanings of sysexits.h.
enum class Exit : int {
  done = 0,           // the work is done
  negative = 1,       // ran properly, and the answer is negative
  quality = 2,        // written, but a quality gate failed
  usage = 64,         // the command line is wrong
  data = 65,          // an input is malformed or impossible
  no_input = 66,      // an input is missing or unreadable
  unavailable = 69,   // a device or service does not answer
  internal = 70,      // a fault of the program itself
  cannot_create = 73, // an output cannot be created
  io = 74,            // reading or writing failed midway (disk full, ...)
  try_again = 75,     // interrupted or busy: the same call may succeed
};

struct ExitMeaning {
  Exit code;
  std::string_view name;
  std::string_view meaning;
};
std::span<const ExitMeaning> exit_table();

class Error : public std::runtime_error {
 public:
  // what() is "PLACE: PROBLEM; REMEDY" (the remedy left out where empty).
  Error(Exit code, std::string place, std::string problem, std::string remedy = {});
  Exit code() const { return code_; }
  const std::string& place() const { return place_; }
  const std::string& problem() const { return problem_; }
  const std::string& remedy() const { return remedy_; }

 private:
  Exit code_;
  std::string place_, problem_, remedy_;
};

}  // namespace gonio
