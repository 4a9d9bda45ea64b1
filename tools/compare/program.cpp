// compare: a rendering against the photograph that it claims to predict, pixel by pixel.
#include "base/atomic_file.h"
#include "base/progress.h"
#include "base/text.h"
#include "cli/common_options.h"
#include "io/picture.h"
#include "metric/difference_pictures.h"
#include "metric/entries.h"
#include "tools/compare/colours.h"
#include "tools/compare/page.h"

namespace gonio::tools::compare {
namespace {

using namespace gonio::metric;
using cli::Type;

cli::Program describe() {
  cli::Program p;
  p.name = "compare";
  p.sentence = "compare renderings with photographs pixel by pixel";
  p.synopsis = {"[OPTION]... [manifest.json]", "--reference PHOTO --rendered PICTURE [--mask MASK] [OPTION]..."};
  p.operands = {
      {.name = "MANIFEST", .type = Type::input_file, .help = "Manifest with images and renderings; ends in .json."}};
  p.options = {
      {.name = "reference",
       .type = Type::input_file,
       .help = "Photograph: linear EXR, or 8/16-bit with --response.",
       .needs = {"rendered"}},
      {.name = "rendered",
       .type = Type::input_file,
       .help = "Rendering of the same size; its variance channels are used where it has them.",
       .needs = {"reference"}},
      {.name = "mask",
       .type = Type::input_file,
       .help = "Pixels above half of full scale count.",
       .needs = {"reference"}},
      {.name = "response",
       .type = Type::choice,
       .help = "How the codes of 8/16-bit pictures become linear (a table: in the manifest).",
       .choices = {"linear", "srgb"},
       .needs = {"reference"}},
      {.name = "gain",
       .type = Type::number,
       .help = "Noise of the photograph: variance v / gain + read^2 of a linear value v.",
       .lower = 1e-12,
       .needs = {"reference"}},
      {.name = "read",
       .type = Type::number,
       .help = "Read noise of the photograph, linear; see --gain.",
       .preset = "0",
       .lower = 0,
       .needs = {"gain"}},
      {.name = "channels",
       .type = Type::choice,
       .help = "What to compare; colour against grey is compared as luminance.",
       .preset = "all",
       .choices = {"all", "luminance", "red", "green", "blue"}},
      colour_option(),
      {.name = "fit-exposure", .type = Type::flag, .help = "Fit one factor on each rendering before comparing."},
      {.name = "one-exposure",
       .type = Type::flag,
       .help = "Fit one factor for all renderings together.",
       .conflicts = {"fit-exposure"}},
      {.name = "exposure-scale",
       .type = Type::number,
       .help = "Multiply the renderings by this factor.",
       .preset = "1",
       .lower = 1e-12,
       .conflicts = {"fit-exposure", "one-exposure"}},
      {.name = "data-range",
       .type = Type::number,
       .help = "Range of the data for SSIM; by default 1 for 8/16-bit photographs, else their 99.9th percentile.",
       .lower = 1e-12},
      {.name = "max-rmse",
       .type = Type::number,
       .help = "Exit 1 above this RMSE, in the photograph's unit.",
       .lower = 0},
      {.name = "max-relative-rmse",
       .type = Type::quantity,
       .help = "Exit 1 above this RMSE over the photograph's root mean square.",
       .dimension = Dimension::ratio,
       .lower = 0},
      {.name = "max-log10-error", .type = Type::number, .help = "Exit 1 above this mean of log10 |difference|."},
      {.name = "max-z-rms", .type = Type::number, .help = "Exit 1 above this root mean square of z.", .lower = 0},
      {.name = "min-ssim",
       .type = Type::number,
       .help = "Exit 1 below this structural similarity.",
       .lower = -1,
       .upper = 1},
      cli::report_option()};
  p.standalone = {"reference"};
  p.takes_out = true;
  p.sections_read = {"files", "images", "renderings", "colour"};
  p.sections_written = {"comparisons", "files"};
  p.files = {{"ID-difference.exr",
              "difference.R, ...: scale x rendering - photograph, linear; z.R, ... where variances are known"},
             {"ID-positive.png, ID-negative.png", "where the rendering is too bright, and too dark: gamma 2.2"},
             {"ID-signed.png, ID-log10-error.png",
              "signed difference (red: too bright) and log10 |difference| in false colour"}};
  p.exits = {{Exit::negative, "a threshold is exceeded, or a pixel that counts is NaN or infinite"}};
  p.references = {"Wang, Bovik, Sheikh & Simoncelli, Image quality assessment, IEEE TIP 13(4), 2004",
                  "York, Evensen, Martinez & De Basabe Delgado, Unified equations for the slope, Am. J. Phys. 72, 2004",
                  "Kunsch, The jackknife and the bootstrap for general stationary observations, Ann. Stat. 17, 1989"};
  p.see_also = {"render(1)", "explain(1)", "gonio-manifest(5)"};
  return p;
}

Entry quick_entry(const cli::Invocation& call) {
  Entry e;
  e.photograph = call.text("reference");
  e.rendering = call.text("rendered");
  if (call.given("mask")) e.mask = call.text("mask");
  if (call.given("response")) {
    e.response = call.text("response");
    if (e.rendering.extension() != ".exr") e.rendering_response = e.response;
  }
  if (call.given("gain")) e.noise = manifest::Noise{call.number("gain"), call.number("read")};
  e.image = e.photograph.stem().string();
  e.photograph_place = e.photograph.string();
  e.rendering_place = e.rendering.string();
  return e;
}

std::vector<Entry> entries_of(const cli::Invocation& call) {
  if (call.given("reference")) return {quick_entry(call)};
  if (call.has_document) return in_colours(call, entries(call.document));
  throw Error(Exit::no_input, "compare", "has nothing to compare",
              "pipe a manifest in, or give --reference and --rendered");
}

std::vector<Compared> measured(const cli::Invocation& call, std::vector<Overlay> overlays) {
  std::vector<const Overlay*> all;
  for (const auto& o : overlays)
    if (o.pixels > 0) all.push_back(&o);
  MeasureOptions options;
  if (call.given("data-range")) options.data_range = call.number("data-range");
  const bool each = call.flag("fit-exposure"), one = call.flag("one-exposure") && !all.empty();
  options.exposure_scale = one ? fit_exposure(all) : Estimate{call.number("exposure-scale"), 0};
  const auto limit = [&](const char* name) {
    return call.given(name) ? std::optional(call.number(name)) : std::nullopt;
  };
  const Limits limits{limit("max-rmse"), limit("max-relative-rmse"), limit("max-log10-error"), limit("max-z-rms"),
                      limit("min-ssim")};
  std::vector<Compared> images;
  for (auto& overlay : overlays) {
    const Overlay* alone = &overlay;
    const bool fitted = each && overlay.pixels > 0;
    if (fitted) options.exposure_scale = fit_exposure({&alone, 1});
    options.exposure_fitted = fitted || one;
    const Measures m = measure(overlay, options);
    images.push_back({std::move(overlay), m, violations(m, limits)});
  }
  if (call.given("html")) write_file(call.text("html"), comparison_page(images, limits));
  return images;
}

std::map<std::string, std::string> write_pictures(cli::Invocation& call, const Compared& image) {
  const Overlay& o = image.overlay;
  const Differences d = differences(o, image.measures.exposure_scale.value);
  const DisplayTone tone = display_tone(o, d, image.measures);
  std::map<std::string, std::string> ids;
  const auto write = [&](const std::string& name, const std::string& extension, const io::Image& picture) {
    const auto path = call.output_path(file_stem(o.name) + "-" + name + extension);
    io::write_picture(path, picture);
    ids[name] = manifest::add_file(call.document, path, o.name + "-" + name);
  };
  write("difference", ".exr", difference_planes(o, d));
  write("positive", ".png", positive_part(o, d, tone.difference));
  write("negative", ".png", negative_part(o, d, tone.difference));
  write("signed", ".png", signed_map(o, d, tone.difference));
  write("log10-error", ".png", log_map(o, d, tone, image.measures.log_floor));
  return ids;
}

Exit run(cli::Invocation& call) {
  const auto list = entries_of(call);
  std::vector<Overlay> overlays;
  for (const auto& entry : list) {
    for (const auto& path : {entry.photograph, entry.rendering, entry.mask})
      if (!path.empty()) call.note_input(path);
    overlays.push_back(lay_over(entry, channels_named(call.text("channels"))));
  }
  if (call.given("reference")) call.document = document_of(list.front());
  bool passed = true;
  for (const auto& image : measured(call, std::move(overlays))) {
    auto files = call.out.empty() ? std::map<std::string, std::string>() : write_pictures(call, image);
    if (call.given("html")) files["report"] = manifest::add_file(call.document, call.text("html"), "comparison-report");
    enter(call.document, image.overlay.name, image.measures, files);
    for (const auto& violation : image.violations) log(LogLevel::error, image.overlay.name + ": " + violation);
    passed = passed && image.violations.empty();
  }
  return passed ? Exit::done : Exit::negative;
}

}  // namespace

const cli::Program& gonio_program() {
  static const cli::Program program = [] {
    cli::Program p = describe();
    p.check = [](cli::Invocation& call) { entries_of(call); };
    p.run = run;
    return p;
  }();
  return program;
}

}  // namespace gonio::tools::compare
