// color-calib: from a photograph of a chart to the correction that makes colours of a camera's linear numbers
// (lib/colour).
#include "cli/program.h"

#include "base/error.h"
#include "tools/color-calib/options.h"

namespace gonio::tools::color_calib {
namespace {

using cli::Type;

void check(cli::Invocation& call) {
  if (call.flag("specimen")) {
    if (call.out.empty()) throw Error(Exit::usage, "--specimen", "has no folder to write to", "give --out DIR");
    return;
  }
  if (!call.given("PHOTOGRAPH") && !call.has_document)
    throw Error(Exit::no_input, "color-calib", "has no photograph of a chart",
                "name it, or pipe in a manifest whose images have files");
  if (call.given("PHOTOGRAPH") && call.given("image"))
    throw Error(Exit::usage, "--image", "is for manifests, and a photograph is named", "leave one of them out");
  if (!call.given("PHOTOGRAPH") && call.given("mask"))
    throw Error(Exit::usage, "--mask", "is for a photograph on the command line",
                "images of a manifest have their own");
  if (call.given("preview") && !call.text("preview").ends_with(".png"))
    throw Error(Exit::usage, "--preview", "is no PNG: " + call.text("preview"), "end the name in .png");
  request_of(call);
}

Exit run(cli::Invocation& call) {
  if (call.flag("specimen")) {
    write_specimen(call);
    return Exit::done;
  }
  const colour::ChartRequest request = request_of(call);
  call.note_input(request.photograph.picture);
  if (!request.photograph.mask.empty()) call.note_input(request.photograph.mask);
  const colour::Calibration calibration = colour::calibrate_document(call.document, request);
  const bool refused = call.given("accept") && !(calibration.held_out.mean <= call.number("accept"));
  return refused ? Exit::quality : Exit::done;
}

}  // namespace

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "color-calib",
      .sentence = "find how a camera's numbers become colours, from a photograph of a chart",
      .synopsis = {"[OPTION]... PHOTOGRAPH", "[OPTION]... [-i FILE | manifest.json]", "--specimen --out DIR"},
      .options = options(),
      .operands = {{.name = "PHOTOGRAPH",
                    .type = Type::input_file,
                    .help = "Picture of the chart, linear: OpenEXR as develop writes it, or PNG, JPEG, TIFF with "
                            "--response; else the manifest's image."}},
      .standalone = {"specimen"},
      .takes_out = true,
      .takes_seed = true,
      .sections_read = {"files", "images", "cameras"},
      .sections_written = {"colour", "tables"},
      .files = {{"chart.exr", "--specimen: the photograph"}},
      .exits = {{Exit::quality, "the mean held-out CIEDE2000 is above --accept; the correction is written"}},
      .references =
          {"Finlayson, Mackiewicz & Hurlbert, Color correction using root-polynomial regression, IEEE Trans. Image "
           "Processing 24(5), 2015.",
           "Finlayson, Gong & Fisher, Color homography: theory and applications, IEEE Trans. PAMI 41(1), 2019.",
           "Finlayson & Drew, White-point preserving color correction, Color Imaging Conference, 1997.",
           "Sharma, Wu & Dalal, The CIEDE2000 color-difference formula: implementation notes, supplementary test data, "
           "and mathematical observations, Color Research & Application 30(1), 2005.",
           "CIE 15:2018, Colorimetry, 4th edition.",
           "X-Rite, New color specifications for ColorChecker SG and Classic charts, 2016."},
      .see_also = {"develop(1)", "compare(1)", "explain(1)", "gonio-manifest(5)", "gonio-conventions(7)"},
      .check = check,
      .run = run};
  return program;
}

}  // namespace gonio::tools::color_calib
