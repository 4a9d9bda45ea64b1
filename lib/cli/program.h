// A program is described once, as data: options with types, units, ranges, defaults, conflicts; what it reads and
// writes; exit codes; references. --help, the man page's OPTIONS / EXIT STATUS / FILES, bash, zsh and fish completions,
// --describe (JSON) and --check (validate everything, run nothing) all come from this description.
//
// A program is one folder, tools/<name>: its program.cpp defines `const gonio::cli::Program& gonio_program()` inside
// `namespace gonio::tools::<name with _ for ->`; the build makes the executable and the registry of programs from the
// folder's name (cmake/rooms.cmake). Beside program.cpp stand the program's own options, call and page, in the same
// namespace. What several programs share on the command line stands here in lib/cli; no other room knows of it.
//
// Common to every program, added here and meaning the same everywhere: -i/--input, -o/--output, --out DIR,
// --depfile FILE, --seed N, --threads N, --progress WHEN, --log-level LEVEL, --force, --resume, --allow-outside,
// --check, --describe, --help, --version. Of --out, --seed and --resume a program says which it takes (takes_out, ...).
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/quantity.h"
#include "manifest/document.h"

namespace gonio::cli {

enum class Type { flag, integer, number, quantity, text, choice, input_file, output_file, folder };

struct Option {
  std::string name{};  // long name without dashes; for an operand its metavar
  Type type = Type::flag;
  std::string help{};                      // one sentence; what, unit, when to use it
  std::string metavar{};                   // "N", "FILE", ... (empty: from the type)
  std::string preset{};                    // default as the user would type it; empty: none
  Dimension dimension = Dimension::none;   // quantity
  std::optional<double> lower{}, upper{};  // in SI
  std::vector<std::string> choices{};      // choice
  bool repeat = false;                     // may be given several times; operands: takes the rest
  bool required = false;
  std::vector<std::string> conflicts{};  // long names it cannot stand with
  std::vector<std::string> needs{};      // long names that must stand beside it
  char letter = 0;                       // short form, 'i' for -i; 0: none
  std::vector<std::string> aliases{};    // former long names: understood, and listed nowhere
};

// How the manifest enters: from -i FILE, else from an operand that ends in .json, else from standard input where that
// is a pipe, a socket or a file and neither operands (repeated ones beside a required manifest apart) nor a
// `standalone` option are given; an empty one is no manifest.
// So a program that has been told what to work on never waits for a pipe that nobody writes to. none: never; required:
// its absence is an error.
enum class Reads { none, optional, required };

class Invocation;

struct Program {
  std::string name{};                   // as typed: "calib-charuco"
  std::string sentence{};               // NAME line
  std::vector<std::string> synopsis{};  // after the program's name, one form a line
  std::vector<Option> options{};
  std::vector<Option> operands{};
  Reads reads = Reads::optional;
  bool writes_manifest = true;
  std::vector<std::string> standalone{};  // options with which standard input is not read: the quick forms
  bool takes_out = false, takes_seed = false, takes_resume = false;
  std::vector<std::string> sections_read{}, sections_written{};  // of the manifest
  std::vector<std::pair<std::string, std::string>> files{};      // written below --out: pattern, meaning
  std::vector<std::pair<Exit, std::string>> exits{};             // what this program means by 1 and 2
  std::vector<std::string> references{};                         // papers
  std::vector<std::string> see_also{};
  // Validates what can be validated without doing the work; called by --check, and always before run.
  std::function<void(Invocation&)> check{};
  std::function<Exit(Invocation&)> run{};
};

// One call of a program: options parsed, typed and range-checked; the manifest read.
class Invocation {
 public:
  bool given(const std::string& option) const;  // typed by the user
  bool flag(const std::string& option) const;
  std::int64_t integer(const std::string& option) const;
  double number(const std::string& option) const;  // number or quantity, SI
  const std::string& text(const std::string& option) const;
  const std::vector<std::string>& texts(
      const std::string& option) const;  // repeated option, or operands by their metavar

  manifest::Document document;  // read; what run leaves here is written
  bool has_document = false;
  bool writes_document = true;  // run may turn it off (a drawing on stdout, a list)
  // Set by run: called once the manifest has been written, with standard output closed, so that its reader may begin;
  // its result is the program's. For programs that serve until they are interrupted.
  std::function<Exit()> afterwards{};
  std::uint64_t seed = 0;
  std::filesystem::path out;  // --out (created before run), empty where not given
  bool force = false, resume = false;
  // Path below --out for a new file. Error(cannot_create) where it exists and --force was not given (unless it is this
  // program's own unchanged output under --resume).
  std::filesystem::path output_path(const std::string& name) const;
  // Files read besides the manifest (for --depfile and provenance).
  void note_input(const std::filesystem::path& path);

  struct State;
  State* state = nullptr;  // owned by main()
};

int main(const Program& program, int argc, char** argv);

std::span<const Program* const> all_programs();  // generated; sorted by name

}  // namespace gonio::cli
