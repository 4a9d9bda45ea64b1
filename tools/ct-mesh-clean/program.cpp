// ct-mesh-clean: from a CT volume to a mesh that can be rendered as glass (lib/volume,
// lib/mesh/{carve,clean,verdict}.h).
#include <functional>
#include <utility>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/progress.h"
#include "base/text.h"
#include "base/usage.h"
#include "tools/ct-mesh-clean/work.h"

namespace gonio::tools::ct_mesh_clean {
namespace {

bool specimen_asked(const cli::Invocation& call) {
  return call.given("specimen");
}

void check(cli::Invocation& call) {
  asked(call);
  if (specimen_asked(call) && call.out.empty())
    throw Error(Exit::usage, "--specimen", "has no folder to write to", "give --out DIR");
  if (!specimen_asked(call) && call.out.empty() && (call.given("VOLUME") || !call.document.volumes.empty()))
    throw Error(Exit::usage, "--out", "is missing: the mesh needs a folder", "give --out DIR");
  for (const char* option : {"html", "csv"})
    if (call.given(option)) check_writable(call.text(option));
}

std::string csv_of(const Work& work) {
  std::string csv = "step,figure,value\n";
  for (const manifest::VolumeStep& s : work.steps)
    for (const auto& [name, value] : s.figures) csv += s.name + "," + name + "," + shortest_text(value) + "\n";
  return csv;
}

// What a step costs, for who asks with --log-level debug.
void timed(const char* step, const std::function<void()>& body) {
  const Usage before = usage_so_far();
  body();
  log(LogLevel::debug, std::string(step) + ": " + usage_since(before));
}

Exit run(cli::Invocation& call) {
  if (specimen_asked(call)) {
    write_specimen(call);
    return Exit::done;
  }
  Work work(call, asked(call));
  choose(work);
  const std::filesystem::path html = call.given("html") ? std::filesystem::path(call.text("html"))
                                     : call.out.empty() ? std::filesystem::path()
                                                        : call.output_path("report.html");
  work.with_page = !html.empty();
  constexpr std::pair<const char*, void (*)(Work&)> steps[] = {
      {"open", open},       {"look", look},     {"correct", correct},      {"cut", cut},     {"select", select},
      {"contour", contour}, {"refine", refine}, {"markers", find_markers}, {"carve", carve}, {"clean", clean},
      {"judge", judge},     {"draw", draw},     {"enter", enter}};
  for (const auto& [name, take] : steps) timed(name, [&] { take(work); });
  if (call.given("csv")) write_file(call.text("csv"), csv_of(work));
  if (!html.empty()) timed("page", [&] { write_file(html, page(work)); });
  return work.missed ? Exit::quality : Exit::done;
}

std::vector<std::string> synopsis() {
  return {"[OPTION]... VOLUME [-i FILE]", "[OPTION]... [-i FILE | manifest.json]", "--specimen ornament --out DIR"};
}

}  // namespace

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "ct-mesh-clean",
      .sentence = "from a CT volume to a closed mesh whose refraction can be trusted",
      .synopsis = synopsis(),
      .options = options(),
      .operands = {{.name = "VOLUME",
                    .type = cli::Type::text,
                    .help = "The volume: a file, or a folder of slices. Default: the manifest's."}},
      .standalone = {"specimen"},
      .takes_out = true,
      .takes_seed = true,
      .sections_read = {"files", "meshes", "surfaces", "objects", "volumes", "markers"},
      .sections_written = {"files", "meshes", "surfaces", "objects", "volumes", "markers"},
      .files = {{"NAME.ply", "the mesh, metres, normals at its vertices"},
                {"NAME-markers.ply", "the markers' surface"},
                {"NAME-slices-*.png", "slices with the contour drawn over them"},
                {"ornament.nrrd", "--specimen: the volume"},
                {"report.html", "the report"}},
      .exits = {{Exit::quality, "the mesh is not sound, or a limit is missed"}},
      .references = {"Ju, Losasso, Schaefer & Warren, Dual contouring of Hermite data, SIGGRAPH 2002.",
                     "Ju & Udeshi, Intersection-free contouring on an octree grid, Pacific Graphics 2006.",
                     "Garland & Heckbert, Surface simplification using quadric error metrics, SIGGRAPH 1997.",
                     "Kobbelt, sqrt(3)-subdivision, SIGGRAPH 2000.",
                     "Taubin, A signal processing approach to fair surface design, SIGGRAPH 1995.",
                     "Stets et al., Scene reassembly after multimodal digitization and pipeline evaluation using "
                     "photorealistic rendering, Applied Optics 56, 2017."},
      .see_also = {"render(1)", "scene(1)", "explain(1)", "gonio-manifest(5)"},
      .check = check,
      .run = run};
  return program;
}

}  // namespace gonio::tools::ct_mesh_clean
