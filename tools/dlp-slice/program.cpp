// dlp-slice: from bodies to the grey values that a printer which cures layers by light is sent, and back (lib/print).
#include "base/atomic_file.h"
#include "base/error.h"
#include "tools/dlp-slice/work.h"

namespace gonio::tools::dlp_slice {
namespace {

using cli::Type;

void check(cli::Invocation& call) {
  check_options(call, action_of(call));
  if (call.given("layers")) layer_steps(call.text("layers"), "--layers");
  if (call.given("window")) lengths_of(call.text("window"), 4, "--window");
  if (call.given("format"))
    print::archive_format("", call.text("format"));
  else if (call.given("to"))
    print::archive_format(call.text("to"));
  for (const char* option : {"to", "html"})
    if (call.given(option)) check_writable(call.text(option));
}

void enter_totals(Work& work) {
  manifest::Print& entry = work.entry();
  entry.figures = {{"printed_layers", static_cast<double>(work.totals.layers)}, {"volume_m3", work.totals.solid_m3}};
  if (work.totals.time_s > 0) entry.figures["time_s"] = work.totals.time_s;
  if (work.totals.structured_m2 > 0) entry.figures["structured_m2"] = work.totals.structured_m2;
  if (work.totals.unreached_m3 > 0) entry.figures["unreached_m3"] = work.totals.unreached_m3;
  if (work.totals.after.voxels > 0)
    entry.figures["misfit_before_m"] = work.totals.before.rms_m(),
    entry.figures["misfit_after_m"] = work.totals.after.rms_m();
  if (!std::filesystem::is_directory(work.archive))
    entry.layers = manifest::add_file(work.call.document, work.archive, "layers");
}

void send(Work& work, Action action) {
  work.archive = work.call.given("to") ? std::filesystem::path(work.call.text("to"))
                                       : work.call.output_path(work.entry().process.contains("exposure_s")
                                                                   ? "layers.sl1s"
                                                                   : "layers.zip");  // SL1 states times
  action == Action::sample ? send_sample(work) : send_bodies(work);
  enter_totals(work);
}

Exit run(cli::Invocation& call) {
  Work work(call);
  const Action action = action_of(call);
  const std::filesystem::path html = call.given("html") ? std::filesystem::path(call.text("html"))
                                     : call.out.empty() ? std::filesystem::path()
                                                        : call.output_path("report.html");
  open_printer(work);
  if (action == Action::predict || call.flag("predict")) check_prediction(work);
  if (action == Action::slice) open_bodies(work);
  if (action == Action::slice || action == Action::sample) send(work, action);
  if (action == Action::predict) call.note_input(work.archive = call.text("sent"));
  if (action == Action::predict || call.flag("predict")) predict(work);
  if (action == Action::growth) fit_growth(work);
  const bool met = action != Action::wish || fulfil_wish(work);
  if (!html.empty()) write_file(html, page(work));
  return met ? Exit::done : Exit::quality;
}

std::vector<std::string> synopsis() {
  return {"MESH... --unit UNIT --printer FILE --out DIR [OPTION]...",
          "--calibration-sample --printer FILE --out DIR [OPTION]...",
          "--growth-from MAP --map-at X,Y --printer FILE [OPTION]...",
          "--sent LAYERS --printer FILE --out DIR [OPTION]...",
          "--wish FIGURE=VALUE --printer FILE --out DIR [OPTION]..."};
}

}  // namespace

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "dlp-slice",
      .sentence = "from bodies to the grey values of a printer that cures layers by light, and to what it will print",
      .synopsis = synopsis(),
      .options = options(),
      .operands = {{.name = "MESH",
                    .type = Type::text,
                    .help = "A mesh, PLY, STL, OBJ or 3MF, mended where it is not closed; several stand side by side.",
                    .repeat = true}},
      .takes_out = true,
      .takes_seed = true,
      .takes_resume = true,
      .sections_read = {"files", "ground_noises", "prints"},
      .sections_written = {"files", "ground_noises", "meshes", "prints", "reliefs"},
      .files = {{"layers.sl1s",
                 "what is sent to the printer, unless --to names it; layers.zip where no exposure is stated"},
                {"MESH.ply", "every mesh as it was sliced, metres"},
                {"layers.sl1s.compensated",
                 "--compensate: layers found so far, for --resume; gone once the archive is whole"},
                {"predicted.x3p, predicted.ply",
                 "--predict: the surface seen from the projector, as heights and as a mesh"},
                {"code.png", "--code: the data matrix, a pixel a cell"},
                {"report.html", "the report"}},
      .exits = {{Exit::quality, "--wish: nothing reaches the figure; the nearest was taken"}},
      .references =
          {"Luongo, Reddy, Stolpe, Aanaes, Frisvad et al., Microstructure control in 3D printing with digital light "
           "processing, Computer Graphics Forum 39, 2020.",
           "Jacobs, Rapid Prototyping & Manufacturing: Fundamentals of StereoLithography, 1992.",
           "Greene, OpenEmber: grey scale and anti-aliasing in DLP printing, Autodesk, 2016.",
           "Moffat, A theoretical investigation of focal stellar images, Astronomy & Astrophysics 3, 1969.",
           "Beck & Teboulle, A fast iterative shrinkage-thresholding algorithm, SIAM J. Imaging Sciences 2, 2009."},
      .see_also = {"relief(1)", "roughness(1)", "lobe(1)", "contrast(1)", "render(1)", "explain(1)",
                   "gonio-manifest(5)"},
      .check = check,
      .run = run};
  return program;
}

}  // namespace gonio::tools::dlp_slice
