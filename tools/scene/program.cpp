// scene: scenes for and from other renderers, and what is wrong with them (scene/exchange/exchange.h, scene/checks.h).
#include "cli/program.h"

#include <algorithm>
#include <iostream>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/progress.h"
#include "scene/checks.h"
#include "scene/exchange/exchange.h"

namespace gonio::tools::scene {
namespace {

using cli::Type;
namespace scenes = gonio::scene;

std::vector<std::string> format_names() {
  std::vector<std::string> names;
  for (const scenes::Exchange* exchange : scenes::all_exchanges()) names.emplace_back(exchange->name());
  return names;
}

std::vector<std::pair<std::string, std::string>> written_files() {
  std::vector<std::pair<std::string, std::string>> files;
  for (const scenes::Exchange* exchange : scenes::all_exchanges())
    files.emplace_back("export --to " + std::string(exchange->name()), std::string(exchange->sentence()));
  files.emplace_back("import", "meshes as PLY and pictures as EXR, which the manifest names");
  return files;
}

scenes::Reading reading_of(cli::Invocation& call) {
  scenes::Reading reading;
  reading.on_file = [&call](const std::filesystem::path& path) { call.note_input(path); };
  reading.allow_open = call.flag("allow-open");
  return reading;
}

void write_files(cli::Invocation& call, const std::vector<scenes::ExchangedFile>& files) {
  std::vector<std::filesystem::path> paths;  // asked for before the first is written
  for (const auto& file : files) paths.push_back(call.output_path(file.name));
  for (std::size_t i = 0; i < files.size(); ++i) {
    make_folder(paths[i].parent_path());
    write_file(paths[i], files[i].content);
  }
}

// One line for each thing that did not come through; --strict makes them count.
Exit tell(const cli::Invocation& call, const std::vector<scenes::Loss>& losses, const std::string& place,
          const std::string& there) {
  for (const scenes::Loss& loss : losses)
    log(LogLevel::warning,
        place + loss.pointer + ": " + there + " has no counterpart of " + loss.what + "; instead: " + loss.instead);
  return !losses.empty() && call.flag("strict") ? Exit::quality : Exit::done;
}

Exit export_to(cli::Invocation& call) {
  const scenes::Exchange& exchange = *scenes::find_exchange(call.text("to"));
  const scenes::Exported exported =
      scenes::export_scene(scenes::build_scene(call.document, reading_of(call)), exchange);
  write_files(call, exported.files);
  return tell(call, exported.losses, manifest::place(call.document, ""), std::string(exchange.name()));
}

// On standard output, one line for each thing that is wrong or risky.
Exit check_it(cli::Invocation& call) {
  call.writes_document = false;
  std::vector<std::string> lines;
  const auto tell_once = [&lines](std::string line) {
    if (std::ranges::find(lines, line) == lines.end()) lines.push_back(std::move(line));
  };
  scenes::Reading reading = reading_of(call);
  reading.allow_open = true;  // open meshes are found, among the others
  reading.on_warning = tell_once;
  for (const scenes::Finding& f : scenes::check_scene(scenes::build_scene(call.document, reading)))
    tell_once(manifest::place(call.document, f.pointer) + ": " + f.what + ": " + f.consequence);
  for (const std::string& line : lines) std::cout << line << "\n";
  std::cout << std::flush;
  return lines.empty() ? Exit::done : Exit::negative;
}

Exit import_from(cli::Invocation& call) {
  const std::filesystem::path path = call.texts("FILE").front();
  call.note_input(path);
  scenes::Imported imported = scenes::importer_of(path).read(path);
  write_files(call, imported.files);
  call.document = std::move(imported.document);
  for (const auto& file : imported.files) manifest::add_file(call.document, call.out / file.name, file.name);
  return tell(call, imported.losses, path.string() + "#", "gonio");
}

void check(cli::Invocation& call) {
  const std::string& command = call.text("COMMAND");
  if (command == "import") {
    if (call.texts("FILE").empty())
      throw Error(Exit::usage, "import", "has no file to read", "name one: scene import model.gltf --out DIR");
    scenes::importer_of(call.texts("FILE").front());
  } else if (!call.texts("FILE").empty()) {
    throw Error(Exit::usage, call.texts("FILE").front(), "is no manifest by its name",
                "give a file that ends in .json, or use -i");
  } else if (!call.has_document) {
    throw Error(Exit::no_input, "scene", "has no manifest to read", "name it: scene " + command + " scene.json");
  }
  if (command == "export" && !call.given("to"))
    throw Error(Exit::usage, "--to", "is missing", "name the program to write for: --to blender");
  if (command != "check" && call.out.empty())
    throw Error(Exit::usage, "--out", "is missing", "name the folder for the files");
}

Exit run(cli::Invocation& call) {
  const std::string& command = call.text("COMMAND");
  return command == "export" ? export_to(call) : command == "import" ? import_from(call) : check_it(call);
}

}  // namespace

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "scene",
      .sentence = "hand scenes to other renderers, take theirs, and say what is wrong with one",
      .synopsis = {"export --to FORMAT --out DIR [OPTION]... [scene.json]", "import FILE --out DIR [OPTION]...",
                   "check [OPTION]... [scene.json]"},
      .options = {{.name = "to", .type = Type::choice, .help = "Program to write for.", .choices = format_names()},
                  {.name = "strict",
                   .type = Type::flag,
                   .help = "End with status 2 where something did not come through."},
                  {.name = "allow-open",
                   .type = Type::flag,
                   .help = "Take meshes with holes as the boundaries of glass and other media all the same."}},
      .operands = {{.name = "COMMAND",
                    .type = Type::choice,
                    .help = "What to do.",
                    .preset = "check",
                    .choices = {"check", "export", "import"}},
                   {.name = "FILE",
                    .type = Type::input_file,
                    .help = "check, export: the manifest; import: the file to read.",
                    .repeat = true}},
      .takes_out = true,
      .sections_read = {"cameras", "files", "environments", "images", "lights", "mechanisms", "meshes", "objects",
                        "surfaces"},
      .sections_written = {"cameras", "files", "images", "lights", "meshes", "objects", "surfaces"},
      .files = written_files(),
      .exits = {{Exit::negative, "check found something"},
                {Exit::quality, "with --strict: written, but something did not come through"}},
      .references = {"Pharr, Jakob & Humphreys, Physically based rendering, 4th edition, 2023.",
                     "Khronos Group, glTF 2.0 specification, 2021."},
      .see_also = {"render(1)", "camera-export(1)", "gonio-conventions(7)", "gonio-manifest(5)"},
      .check = check,
      .run = run};
  return program;
}

}  // namespace gonio::tools::scene
