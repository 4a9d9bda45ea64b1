// From argv to exit code: the frame of every program. Nothing but the manifest reaches stdout; every failure is one
// line.
#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <iostream>
#include <new>

#include "base/atomic_file.h"
#include "base/fault.h"
#include "base/hash.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "cli/common_options.h"
#include "cli/help.h"
#include "cli/invocation.h"
#include "manifest/file_paths.h"
#include "mechanism/validate.h"

namespace gonio::cli {
namespace {

namespace fs = std::filesystem;

// Writes all of `text` to stdout. A reader that went away (EPIPE) ends the program quietly with 74: the exit code
// tells.
Exit to_stdout(std::string_view text) {
  while (!text.empty()) {
    const ssize_t n = ::write(STDOUT_FILENO, text.data(), text.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) {
      if (errno != EPIPE)
        log(LogLevel::error, std::string("standard output: cannot be written: ") + std::strerror(errno));
      return Exit::io;
    }
    text.remove_prefix(static_cast<std::size_t>(n));
  }
  return Exit::done;
}

// Whoever reads it sees its end; nothing that is opened later gets its number.
void close_stdout() {
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere >= 0) ::dup2(nowhere, STDOUT_FILENO);
  if (nowhere > STDOUT_FILENO) ::close(nowhere);
}

LogLevel level_of(const std::string& word) {
  return word == "quiet"     ? LogLevel::quiet
         : word == "error"   ? LogLevel::error
         : word == "warning" ? LogLevel::warning
         : word == "info"    ? LogLevel::info
                             : LogLevel::debug;
}

// A pipe, a socket or a file: something that a manifest may come from. Terminals, /dev/null and a closed descriptor are
// not.
bool input_may_come() {
  struct stat status {};
  if (::fstat(STDIN_FILENO, &status) != 0) return false;
  return S_ISFIFO(status.st_mode) || S_ISSOCK(status.st_mode) || S_ISREG(status.st_mode);
}

// An idle pipe looks like a program that hangs; to people at a terminal it says what it waits for.
void say_that_it_waits() {
  constexpr int patience_ms = 3000;
  pollfd input{STDIN_FILENO, POLLIN, 0};
  if (::isatty(STDERR_FILENO) && ::poll(&input, 1, patience_ms) == 0)
    log(LogLevel::info, "waiting for a manifest on standard input");
}

// The manifest's name on this command line: -i, an operand that ends in .json (which then is no operand any more), or
// "-".
std::string manifest_source(Invocation& call) {
  const Program& program = *call.state->program;
  if (program.reads == Reads::none) return {};
  if (call.given("input")) return call.text("input");
  for (const Option& operand : program.operands) {
    auto& texts = call.state->arguments[operand.name].texts;
    const auto found = std::ranges::find_if(texts, [](const std::string& t) { return t.ends_with(".json"); });
    if (found == texts.end()) continue;
    std::string name = *found;
    texts.erase(found);
    if (texts.empty()) call.state->arguments[operand.name].given = false;
    return name;
  }
  // Where a manifest is required, repeated operands say what else to read (poses), not what to work on.
  const bool operands = std::ranges::any_of(program.operands, [&](const Option& o) {
    return call.given(o.name) && o.type != Type::choice && !(program.reads == Reads::required && o.repeat);
  });
  const bool standalone = std::ranges::any_of(program.standalone, [&](const std::string& o) { return call.given(o); });
  if (operands || standalone) return {};
  if (input_may_come()) return "-";
  if (program.reads == Reads::required)
    throw Error(Exit::no_input, program.name, "has no manifest to read",
                "pipe one in, or name it: " + program.name + " scene.json");
  return {};
}

void read_manifest(Invocation& call) {
  const std::string source = manifest_source(call);
  if (source.empty()) return;
  if (source == "-") say_that_it_waits();
  const manifest::ReadOptions options{.allow_outside = call.flag("allow-outside")};
  try {
    call.document = manifest::read_document(source, options);
  } catch (const Error& e) {
    // An empty standard input (cron) is no manifest; only a program that needs one minds.
    if (source == "-" && e.code() == Exit::no_input && call.state->program->reads == Reads::optional) return;
    throw;
  }
  mechanism::validate_uses(call.document);
  call.has_document = true;
}

void apply_common(Invocation& call) {
  const Program& program = *call.state->program;
  set_log_level(level_of(call.text("log-level")));
  const std::string& progress = call.text("progress");
  set_progress_mode(progress == "auto"     ? ProgressMode::automatic
                    : progress == "always" ? ProgressMode::always
                                           : ProgressMode::never);
  set_threads(static_cast<int>(call.integer("threads")));
  if (program.takes_seed) call.seed = static_cast<std::uint64_t>(call.integer("seed"));
  if (program.takes_out) {
    if (call.given("out")) call.out = call.text("out");
    call.force = call.flag("force");
  }
  if (program.takes_resume) call.resume = call.flag("resume");
}

const std::vector<std::string>& options_without_effect() {
  static const std::vector<std::string> names{"input",     "output", "out",    "depfile",       "threads", "progress",
                                              "log-level", "force",  "resume", "allow-outside", "check",   "stamp"};
  return names;
}

void record(Invocation& call, const std::string& input_id) {
  manifest::Step step;
  step.program = call.state->program->name;
  step.version = GONIO_VERSION;
  step.input_id = input_id;
  for (const Option& o : call.state->options) {
    const Argument& a = call.state->arguments[o.name];
    // Files are known by their content, not by their names.
    if (!a.given || o.type == Type::input_file || o.type == Type::output_file || o.type == Type::folder) continue;
    if (std::ranges::find(options_without_effect(), o.name) != options_without_effect().end()) continue;
    step.options[o.name] = o.type == Type::flag  ? manifest::Value(true)
                           : a.texts.size() == 1 ? manifest::Value(a.texts[0])
                                                 : manifest::Value(a.texts);
  }
  for (const auto& path : call.state->inputs) step.input_hashes.push_back(sha256_of_file(path));
  if (call.flag("stamp")) {
    const std::time_t now = std::time(nullptr);
    std::tm utc{};
    ::gmtime_r(&now, &utc);
    char text[32] = "", host[256] = "";
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
    ::gethostname(host, sizeof host - 1);
    step.time = text;
    step.host = host;
  }
  manifest::record_step(call.document, step);
}

// What is known to fail before any work is done: --out below something that is no folder, a depfile about nothing.
void check_places(const Invocation& call) {
  std::error_code ignored;
  fs::path folder = fs::absolute(call.out.empty() ? fs::path(".") : call.out);
  while (!fs::exists(folder, ignored) && folder.has_relative_path()) folder = folder.parent_path();
  if (!call.out.empty() && !fs::is_directory(folder, ignored))
    throw Error(Exit::cannot_create, "--out", folder.string() + " is no folder", "choose another place");
  const bool to_file = call.state->program->writes_manifest && call.given("output") && call.text("output") != "-";
  if (call.given("depfile") && !to_file && call.out.empty())
    throw Error(Exit::usage, "--depfile", "nothing is written to a file that could depend on anything",
                "give -o FILE or --out DIR");
}

// The folder of --out, and those above it that it needs. A run that ends in a refusal leaves none of them behind,
// unless something was written there.
class NewFolders {
 public:
  explicit NewFolders(const fs::path& out) {
    if (out.empty()) return;
    std::error_code ignored;
    for (fs::path at = fs::absolute(out).lexically_normal(); !fs::exists(at, ignored); at = at.parent_path())
      if (at.has_filename()) made_.push_back(at);
  }
  ~NewFolders() {
    std::error_code failure;
    for (const fs::path& at : made_)  // the innermost first; remove() takes nothing that is not empty
      if (!fs::remove(at, failure) || failure) return;
  }
  NewFolders(const NewFolders&) = delete;
  NewFolders& operator=(const NewFolders&) = delete;
  void keep() { made_.clear(); }

 private:
  std::vector<fs::path> made_;
};

// Can everything be written? What lies below --out is asked after that folder was made, the rest before.
void prepare_places(const Invocation& call) {
  const auto below_out = [&call](const fs::path& path) {
    return !call.out.empty() && manifest::lies_within(path, call.out);
  };
  for (const bool below : {false, true}) {
    if (below && !call.out.empty()) make_folder(call.out);
    for (const char* option : {"output", "depfile"})
      if ((option != std::string_view("output") || call.state->program->writes_manifest) && call.given(option) &&
          call.text(option) != "-" && below_out(call.text(option)) == below)
        check_writable(call.text(option));
  }
}

void write_depfile(const Invocation& call) {
  const auto escaped = [](const fs::path& p) {
    std::string out;
    for (const char c : p.string())
      out += c == ' ' || c == '#' ? std::string("\\") + c : c == '$' ? std::string("$$") : std::string(1, c);
    return out;
  };
  std::string text =
      call.state->program->writes_manifest && call.given("output") ? escaped(call.text("output")) : std::string();
  for (const auto& path : call.state->outputs) text += (text.empty() ? "" : " ") + escaped(path);
  text += ":";
  if (call.has_document && call.document.name != "standard input") text += " " + escaped(call.document.name);
  for (const auto& path : call.state->inputs) text += " " + escaped(path);
  write_file(call.text("depfile"), text + "\n");
}

Exit deliver(Invocation& call, Exit result, const std::string& input_id) {
  throw_if_interrupted();
  if (call.given("depfile")) write_depfile(call);
  if (!call.state->program->writes_manifest || !call.writes_document) return result;
  record(call, input_id);
  if (call.given("output") && call.text("output") != "-") {
    const fs::path path = call.text("output");
    write_file(path, manifest::print_document(call.document, path.parent_path()));
    return result;
  }
  const Exit written = to_stdout(manifest::print_document(call.document, "."));
  return written == Exit::done ? result : written;
}

Exit run(const Program& program, int argc, char** argv) {
  Invocation call;
  Invocation::State state;
  call.state = &state;
  state.program = &program;
  state.options = program.options;
  for (const auto& o : common_options(program)) state.options.push_back(o);
  parse_arguments(state, argc, argv);
  if (call.flag("help")) return to_stdout(help_text(program));
  if (call.flag("version")) return to_stdout(program.name + " (gonio) " GONIO_VERSION "\n");
  if (call.flag("describe")) return to_stdout(manifest::print_json(describe(program)) + "\n");
  apply_common(call);
  check_places(call);
  read_manifest(call);
  const std::string input_id = call.has_document ? manifest::content_id(call.document) : std::string();
  if (program.check) program.check(call);
  if (call.flag("check")) return Exit::done;
  NewFolders made(call.out);
  prepare_places(call);
  const Exit result = program.run(call);
  const Exit delivered = deliver(call, result, input_id);
  made.keep();
  if (!call.afterwards || delivered != result) return delivered;
  close_stdout();
  return call.afterwards();
}

}  // namespace

int main(const Program& program, int argc, char** argv) {
  set_program_name(program.name);
  install_signal_handlers();
  install_fault_handlers();
  Exit code = Exit::internal;
  try {
    code = run(program, argc, argv);
  } catch (const Error& e) {
    log(LogLevel::error, e.what());
    code = e.code();
  } catch (const std::bad_alloc&) {
    log(LogLevel::error, "not enough memory; use a smaller picture, mesh or number of threads");
    code = Exit::internal;
  } catch (const std::exception& e) {
    std::string what = e.what();
    std::ranges::replace(what, '\n', ' ');
    log(LogLevel::error, "internal fault: " + what + "; please report it with the call that led to it");
    code = Exit::internal;
  }
  return static_cast<int>(code);
}

}  // namespace gonio::cli
