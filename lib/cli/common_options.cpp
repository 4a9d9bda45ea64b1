#include "cli/common_options.h"

#include <cctype>

namespace gonio::cli {

Option report_option() {
  return {.name = "html", .type = Type::output_file, .help = "Write the report: one page that needs no network."};
}

std::vector<Option> common_options(const Program& program) {
  std::vector<Option> all;
  const auto add = [&all](Option o) { all.push_back(std::move(o)); };
  if (program.reads != Reads::none)
    add({.name = "input",
         .type = Type::input_file,
         .help = "Manifest to read; - is standard input.",
         .metavar = "FILE",
         .letter = 'i'});
  if (program.writes_manifest)
    add({.name = "output",
         .type = Type::output_file,
         .help = "Where the manifest goes instead of standard output; written whole or not at all.",
         .metavar = "FILE",
         .letter = 'o'});
  if (program.takes_out)
    add({.name = "out",
         .type = Type::folder,
         .help = "Folder for the files that are written; made where it is missing.",
         .metavar = "DIR"});
  if (program.reads != Reads::none)
    add({.name = "allow-outside", .type = Type::flag, .help = "Let the manifest name files outside its own folder."});
  if (program.takes_out) add({.name = "force", .type = Type::flag, .help = "Replace files that exist."});
  if (program.takes_resume)
    add({.name = "resume",
         .type = Type::flag,
         .help = "Keep files that an earlier, identical call has finished; make only the rest.",
         .conflicts = {"force"}});
  if (program.takes_seed)
    add({.name = "seed",
         .type = Type::integer,
         .help = "Of the random numbers; the same seed gives the same bytes.",
         .metavar = "N",
         .preset = "1",
         .lower = 0});
  if (program.writes_manifest)
    add({.name = "stamp",
         .type = Type::flag,
         .help = "Record time and host beside the provenance; without it, same inputs give the same bytes."});
  add({.name = "depfile",
       .type = Type::output_file,
       .help = "Write the files that were read as a make rule.",
       .metavar = "FILE"});
  add({.name = "threads",
       .type = Type::integer,
       .help = "Threads to use; 0: all there are. Results do not depend on it.",
       .metavar = "N",
       .preset = "0",
       .lower = 0,
       .upper = 4096});
  add({.name = "progress",
       .type = Type::choice,
       .help = "A bar with the time to go: auto shows it on a terminal only.",
       .preset = "auto",
       .choices = {"auto", "always", "never"}});
  add({.name = "log-level",
       .type = Type::choice,
       .help = "What to say on standard error.",
       .preset = "info",
       .choices = {"quiet", "error", "warning", "info", "debug"}});
  add({.name = "check", .type = Type::flag, .help = "Validate options and inputs, run nothing."});
  add({.name = "describe", .type = Type::flag, .help = "Print this program's description as JSON and end."});
  add({.name = "help", .type = Type::flag, .help = "Print this help and end.", .letter = 'h'});
  add({.name = "version", .type = Type::flag, .help = "Print the version and end."});
  return all;
}

std::string option_text(const std::string& name) {
  return std::isupper(static_cast<unsigned char>(name.front())) ? name : "--" + name;
}

std::string metavar_of(const Option& o) {
  if (!o.metavar.empty()) return o.metavar;
  switch (o.type) {
    case Type::flag: return "";
    case Type::integer: return "N";
    case Type::number: return "X";
    case Type::quantity:
      switch (o.dimension) {
        case Dimension::length: return "LENGTH";
        case Dimension::angle: return "ANGLE";
        case Dimension::time: return "TIME";
        case Dimension::ratio: return "RATIO";
        default: return "X";
      }
    case Type::choice: {
      std::string out;
      for (const auto& c : o.choices) out += (out.empty() ? "" : "|") + c;
      return out;
    }
    case Type::input_file:
    case Type::output_file: return "FILE";
    case Type::folder: return "DIR";
    case Type::text: return "TEXT";
  }
  return "";
}

}  // namespace gonio::cli
