// structured-light: what a projector shows, and points from what cameras saw of it (lib/scan).
#include "cli/program.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/memory.h"
#include "base/progress.h"
#include "base/text.h"
#include "scan/scan_document.h"
#include "scan/triangulate.h"
#include "tools/structured-light/options.h"
#include "tools/structured-light/pattern.h"

namespace gonio::tools::structured_light {
namespace {

using cli::Type;

constexpr double most_chi_square = 9;  // three standard deviations, in the middle of all points

std::string projection_of(const cli::Invocation& call) {
  const auto& all = names_in(call.document, "projections");
  if (call.given("name") || all.size() != 1) {
    if (std::ranges::find(all, call.text("name")) != all.end()) return call.text("name");
    throw Error(Exit::data, call.document.name + "#/projections",
                all.empty() ? "has none" : "has no " + call.text("name") + " among " + std::to_string(all.size()),
                "--pattern writes one; --name says which");
  }
  return all.front();
}

scan::ScanRequest request_of(cli::Invocation& call) {
  scan::ScanRequest request;
  request.projection = projection_of(call);
  request.cameras = call.texts("camera");
  if (call.given("projector")) request.projector = call.text("projector");
  const auto known = names_in(call.document, "cameras");
  for (const std::string& name : request.cameras)
    if (std::ranges::find(known, name) == known.end())
      throw Error(Exit::usage, "--camera", name + " is none of the manifest's cameras",
                  "calib-charuco calibrates them");
  if (!request.projector.empty() && std::ranges::find(known, request.projector) == known.end())
    throw Error(Exit::usage, "--projector", request.projector + " is none of the manifest's cameras",
                "a projector is calibrated as a camera of the rig");
  const std::size_t devices = request.cameras.size() + (request.projector.empty() ? 0 : 1);
  if (request.cameras.empty() || devices < 2 || devices > scan::most_devices)
    throw Error(Exit::usage, "--camera", "is given " + std::to_string(request.cameras.size()) + " times",
                format("two to %zu cameras, --camera left --camera right, or one and more with --projector",
                       scan::most_devices));
  request.least_reflected = call.number("least-light");
  request.least_difference = call.number("least-difference");
  request.least_share = call.number("least-share"), request.least_sigmas = call.number("least-sigmas");
  request.least_direct = call.number("least-direct"), request.motion = !call.flag("keep-moved");
  request.indirect = !call.flag("keep-indirect"), request.codes = call.flag("codes");
  if (call.given("shape")) request.shape = call.text("shape");
  if (call.given("radius")) request.radius_m = call.number("radius");
  if ((request.shape == "sphere") != (request.radius_m > 0))
    throw Error(Exit::usage, "--radius", "belongs to --shape sphere",
                "give both, or neither: --shape sphere --radius 25mm");
  if (call.given("html")) request.page = call.text("html");
  request.output_path = [&call](const std::string& name) { return call.output_path(name); };
  request.note_input = [&call](const std::filesystem::path& path) { call.note_input(path); };
  return request;
}

void check(cli::Invocation& call) {
  if (call.given("pattern")) return check_pattern(call);
  if (!call.has_document)
    throw Error(Exit::usage, "manifest", "is missing", "-i rig.json: the calibrated cameras and what was shown");
  if (call.out.empty()) throw Error(Exit::usage, "--out", "is missing", "say where the cloud goes: --out scan");
  const scan::ScanRequest request = request_of(call);
  if (call.given("PICTURE")) {
    call.document.allow_outside = true;  // what the user names may lie anywhere
    scan::enter_photographs(call.texts("PICTURE"), request.projection, request.cameras, call.text("response"),
                            call.document);
  }
  scan::check_scan(call.document, request);
}

Exit run(cli::Invocation& call) {
  if (call.given("pattern")) return write_pattern(call);
  keep_freed_memory();
  const scan::ScanSummary made = scan::scan_document(call.document, request_of(call));
  if (made.fewest_points == 0) return Exit::negative;
  if (made.epipolar_chi_square <= most_chi_square) return Exit::done;
  log(LogLevel::warning,
      format("what should meet misses by %.2g times its noise: the rig, a lens or the projector's size is "
             "not as stated; calibrate them again, or see where it is (--codes)",
             std::sqrt(made.epipolar_chi_square)));
  return Exit::quality;
}

}  // namespace

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "structured-light",
      .sentence = "points with their own error from patterns that a projector shows",
      .synopsis = {"--pattern gray|line-shift|cosine --size WIDTHxHEIGHT --out DIR [OPTION]... [manifest.json]",
                   "--camera NAME --camera NAME... --out DIR [OPTION]... -i rig.json [PICTURE]...",
                   "--camera NAME... --projector NAME --out DIR [OPTION]... -i rig.json [PICTURE]..."},
      .options = options(),
      .operands = {{.name = "PICTURE",
                    .type = Type::text,
                    .help =
                        "Photographs of one view, all frames in their order, each of the camera that its name or its "
                        "folder's says; else the manifest's images with a projection.",
                    .repeat = true}},
      .standalone = {"pattern"},
      .takes_out = true,
      .sections_read = {"files", "cameras", "rigs", "images", "projections"},
      .sections_written = {"files", "images", "projections", "clouds"},
      .files =
          {{"NAME-000.png", "what the projector shows, frame by frame"},
           {"VIEW.ply",
            "points with sigma, covariance, reprojection_px, pixel_x, pixel_y (of the first camera, or of the one that "
            "`camera` counts), reflected (what the projector's white adds there) and, of colour pictures, red, green "
            "and blue of that, linear"},
           {"VIEW-CAMERA-codes.exr",
            "column, row, sigma.column, sigma.row: the projector's pixel; reflected; refusal: " + refusals()}},
      .exits = {{Exit::negative, "a view has no point"},
                {Exit::quality,
                 "cameras, or a projector's columns and rows, contradict each other by more than three times "
                 "their noise"}},
      .references =
          {"Inokuchi, Sato & Matsuda, Range imaging system for 3-D object recognition, ICPR 1984.",
           "Guehring, Dense 3D surface acquisition by structured light using off-the-shelf components, SPIE 4309, "
           "2001.",
           "Xu & Aliaga, Robust pixel classification for 3D modeling with structured light, Graphics Interface 2007.",
           "Srinivasan, Liu & Halioua, Automated phase-measuring profilometry of 3-D diffuse objects, Applied "
           "Optics 23, 1984.",
           "Gupta & Nayar, Micro phase shifting, CVPR 2012.",
           "Hartley & Sturm, Triangulation, Computer Vision and Image Understanding 68, 1997."},
      .see_also = {"calib-charuco(1)", "acquire(1)", "vdi2634(1)", "cloud-mesh(1)", "gonio-conventions(7)",
                   "gonio-manifest(5)"},
      .check = check,
      .run = run};
  return program;
}

}  // namespace gonio::tools::structured_light
