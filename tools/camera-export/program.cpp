// camera-export: calibrated cameras as files of other programs (camera/export/formats.h).
#include "cli/program.h"

#include <iostream>

#include "base/atomic_file.h"
#include "base/error.h"
#include "camera/export/formats.h"

namespace gonio::tools::camera_export {
namespace {

using cli::Type;

std::vector<std::string> format_names() {
  std::vector<std::string> names;
  for (const camera::ExportFormat& format : camera::export_formats()) names.emplace_back(format.name);
  return names;
}

std::vector<std::pair<std::string, std::string>> written_files() {
  std::vector<std::pair<std::string, std::string>> files;
  for (const camera::ExportFormat& format : camera::export_formats())
    files.emplace_back(std::string(format.name), std::string(format.sentence));
  return files;
}

std::vector<camera::ExportedFile> exported(const cli::Invocation& call) {
  if (!call.has_document)
    throw Error(Exit::no_input, "camera-export", "has no manifest to read",
                "pipe one in, or name it: camera-export --to opencv camera.json");
  if (!call.given("to")) throw Error(Exit::usage, "--to", "is missing", "name the program to write for: --to opencv");
  return camera::export_cameras(call.document, {.format = call.text("to"),
                                                .cameras = call.texts("camera"),
                                                .images = call.texts("image"),
                                                .board_frame = call.text("frame") == "board",
                                                .undistorted = call.flag("undistorted")});
}

Exit run(cli::Invocation& call) {
  const auto files = exported(call);
  if (call.out.empty()) {
    if (files.size() != 1)
      throw Error(Exit::usage, "--out", "is missing, and there are " + std::to_string(files.size()) + " files to write",
                  "name a folder, or choose one with --camera or --image");
    call.writes_document = false;
    std::cout << files.front().content << std::flush;
    return Exit::done;
  }
  std::vector<std::filesystem::path> paths;  // asked for before the first is written
  for (const auto& file : files) paths.push_back(call.output_path(file.name));
  for (std::size_t i = 0; i < files.size(); ++i) write_file(paths[i], files[i].content);
  return Exit::done;
}

}  // namespace

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "camera-export",
      .sentence = "write calibrated cameras and their poses for other programs",
      .synopsis = {"--to FORMAT [OPTION]... [camera.json]"},
      .options = {{.name = "to", .type = Type::choice, .help = "Program to write for.", .choices = format_names()},
                  {.name = "camera",
                   .type = Type::text,
                   .help = "Write this camera only; may be repeated.",
                   .metavar = "NAME",
                   .repeat = true},
                  {.name = "image",
                   .type = Type::text,
                   .help = "Write the pose of this image only; may be repeated.",
                   .metavar = "ID",
                   .repeat = true},
                  {.name = "frame",
                   .type = Type::choice,
                   .help = "Frame of the poses: world_from_camera of the images, or the board that they show.",
                   .preset = "world",
                   .choices = {"world", "board"}},
                  {.name = "undistorted",
                   .type = Type::flag,
                   .help = "Leave the lens away: the pictures have been undistorted into the same focal lengths and "
                           "principal point."}},
      .operands = {{.name = "MANIFEST", .type = Type::input_file, .help = "Manifest with cameras; ends in .json."}},
      .takes_out = true,
      .sections_read = {"cameras", "images", "files"},
      .files = written_files(),
      .references = {"Bradski, The OpenCV library, Dr. Dobb's Journal of Software Tools, 2000.",
                     "Schoenberger & Frahm, Structure-from-motion revisited, CVPR 2016.",
                     "Pharr, Jakob & Humphreys, Physically based rendering, 4th edition, 2023."},
      .see_also = {"calib-charuco(1)", "develop(1)", "gonio-conventions(7)", "gonio-manifest(5)"},
      .check = [](cli::Invocation& call) { exported(call); },
      .run = run};
  return program;
}

}  // namespace gonio::tools::camera_export
