// reassemble: pieces that were scanned elsewhere, back into the photographed scene (lib/reassembly).
#include <filesystem>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/progress.h"
#include "cli/common_options.h"
#include "reassembly/specimen.h"
#include "tools/reassemble/work.h"

namespace gonio::tools::reassemble {
namespace {

bool specimen_asked(const cli::Invocation& call) {
  return call.given("specimen");
}

void check(cli::Invocation& call) {
  const Asked a = asked(call);
  if (call.out.empty())
    throw Error(Exit::usage, "--out", "is missing: meshes and tables need a folder", "give --out DIR");
  if (specimen_asked(call)) return;
  const auto known_surface = [&](const std::string& name, const char* option) {
    if (!name.empty() && !manifest::has_entry(call.document, "surfaces", name))
      throw Error(Exit::usage, option, "\"" + name + "\" is not in surfaces of " + call.document.name,
                  "describe it there: {\"surfaces\": {\"" + name + "\": {\"model\": \"diffuse\", ...}}}");
  };
  known_surface(a.marker_surface, "--marker-surface");
  for (const std::string& surface : a.label_surfaces) known_surface(surface, "--label-surface");
  if (!a.background.empty() && !a.labels) known_surface(a.background_surface, "--background-surface");
  for (const AskedPiece& piece : a.pieces)
    if (!std::filesystem::is_regular_file(piece.file))
      throw Error(Exit::no_input, piece.file, "is not there", "give the manifest that ct-mesh-clean wrote");
  if (call.given("html")) check_writable(call.text("html"));
}

Exit run(cli::Invocation& call) {
  if (specimen_asked(call)) {
    call.document = reassembly::specimen(call.out, {.seed = call.seed});
    return Exit::done;
  }
  Work work(call, asked(call));
  take_pieces(work);
  see(work);
  take_background(work);
  put(work);
  check_frames(work);
  settle(work);
  press(work);
  label(work);
  enter_markers(work);
  write_file(call.given("html") ? std::filesystem::path(call.text("html")) : call.output_path("report.html"),
             page(work));
  for (const std::string& complaint : work.complaints) log(LogLevel::error, complaint);
  return work.complaints.empty() ? Exit::done : Exit::quality;
}

}  // namespace

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "reassemble",
      .sentence = "scanned pieces back into the photographed scene, by their markers",
      .synopsis = {"[OPTION]... --piece [NAME=]FILE... --out DIR [-i FILE | manifest.json]",
                   "--specimen bowl --out DIR"},
      .options = options(),
      .operands = {{.name = "MANIFEST",
                    .type = cli::Type::input_file,
                    .help = "Manifest with cameras and photographs; ends in .json."}},
      .standalone = {"specimen"},
      .takes_out = true,
      .takes_seed = true,
      .sections_read = {"images", "cameras", "objects", "markers", "meshes", "surfaces", "lights", "frames"},
      .sections_written = {"objects", "markers", "placements", "meshes", "surfaces", "volumes", "tables", "files"},
      .files = {{"markers.csv", "sightings of the pieces' markers: the table of model markers that explain reads"},
                {"NAME.ply", "a piece whose scale was fitted"},
                {"background.ply", "the background as it gave way"},
                {"background-SURFACE.ply", "--labels: its faces of one surface"},
                {"IMAGE-labels.png", "--labels: what each pixel shows"},
                {"IMAGE-confidence.png", "--labels: how sure that is"},
                {"report.html", "the page, where --html names no other place"}},
      .exits = {{Exit::quality,
                 "a piece could not be placed, or less surely than --max-error; what could be is written"}},
      .references = {"Stets et al., Scene reassembly after multimodal digitization and pipeline evaluation using "
                     "photorealistic rendering, Applied Optics 56(27), 2017.",
                     "Sampson, Fitting conic sections to very scattered data, CGIP 18, 1982",
                     "Umeyama, Least-squares estimation of transformation parameters between two point patterns, "
                     "PAMI 13(4), 1991"},
      .see_also = {"ct-mesh-clean(1)", "handeye(1)", "render(1)", "scene(1)", "compare(1)", "explain(1)",
                   "gonio-manifest(5)"},
      .check = check,
      .run = run};
  return program;
}

}  // namespace gonio::tools::reassemble
