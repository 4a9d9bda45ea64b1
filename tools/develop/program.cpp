// develop: raw frames as radiance (merge.h), photographs as a camera without lens errors would have taken them
// (undistort.h), a camera's numbers as colours (colour.h), what a sensor adds to the light (characterize.h), and how
// codes of a camera that is not linear depend on it (response.h).
#include "cli/program.h"

#include "base/error.h"
#include "tools/develop/characterize.h"
#include "tools/develop/colour.h"
#include "tools/develop/merge.h"
#include "tools/develop/response.h"
#include "tools/develop/undistort.h"

namespace gonio::tools::develop {
namespace {

using cli::Type;

void check(cli::Invocation& call) {
  if (call.resume && !call.flag("merge"))
    throw Error(Exit::usage, "--resume", "goes on with a batch of --merge, and with nothing else",
                "leave it out; --force replaces files");
  if (call.flag("merge")) return check_merge(call);
  if (call.flag("undistort")) return check_undistort(call);
  if (call.given("colour")) return check_colour(call);
  if (call.flag("characterize")) return check_characterize(call);
  if (call.flag("find-response")) return check_response(call);
  throw Error(Exit::usage, "develop", "has nothing to do",
              "say what: --merge, --undistort, --colour, --characterize or --find-response");
}

Exit run(cli::Invocation& call) {
  if (call.flag("characterize")) return characterize(call);
  if (call.flag("find-response")) return find_response(call);
  return call.flag("merge") ? merge(call) : call.flag("undistort") ? undistort(call) : colour(call);
}

std::vector<cli::Option> options() {
  std::vector<cli::Option> all = merge_options(), more = undistort_options();
  all.insert(all.end(), more.begin(), more.end());
  more = colour_options();
  all.insert(all.end(), more.begin(), more.end());
  more = characterize_options();
  all.insert(all.end(), more.begin(), more.end());
  more = response_options();
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

}  // namespace

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "develop",
      .sentence =
          "make radiance out of raw frames, colours out of radiance, take the lens distortion out of photographs, and "
          "find a sensor's noise and a camera's response",
      .synopsis = {"--merge --out DIR [OPTION]... PHOTOGRAPH...", "--merge --out DIR [OPTION]... [recordings.json]",
                   "--undistort --out DIR [OPTION]... [recordings.json]",
                   "--undistort --out DIR [OPTION]... -i camera.json PHOTOGRAPH...",
                   "--colour NAME --out DIR [recordings.json]", "--colour NAME --out DIR -i colour.json PHOTOGRAPH...",
                   "--characterize --out DIR [OPTION]... --dark FILE --dark FILE... PHOTOGRAPH...",
                   "--characterize --out DIR [OPTION]... [recordings.json]",
                   "--find-response --out DIR [OPTION]... PHOTOGRAPH...",
                   "--find-response --out DIR [OPTION]... [recordings.json]"},
      .options = options(),
      .operands =
          {{.name = "PHOTOGRAPH",
            .type = Type::input_file,
            .help = "EXR, PNG, JPEG or TIFF files by the manifest's camera, or raw frames: files of cameras (DNG, CR2, "
                    "NEF, ARW, ...), PNG, TIFF or EXR of one channel; else all images with a file.",
            .repeat = true}},
      .takes_out = true,
      .takes_resume = true,
      .sections_read = {"files", "cameras", "images", "colour"},
      .sections_written = {"files", "cameras", "images"},
      .files =
          {{"VIEW.exr",
            "radiance in codes per second (behind polarizers Y, s1.Y, s2.Y), its variance (variance.*), and the "
            "shortest and longest exposure, s, that each pixel is from (exposure.shortest, exposure.longest; 0: none); "
            "its header says what made it"},
           {"VIEW-mask.png", "white where the sample and one of each filter beside it can be trusted"},
           {"sensor.html, sensor.csv", "the sensor's figures as a report and as a table"},
           {"linearity.csv", "of a sensor that is not linear: codes above black, linear codes, their uncertainty"},
           {"response.csv, response-times.csv",
            "the camera's response, and exposure times as exposures and stated times say together"},
           {"ID.exr, ID.png", "the picture of the pinhole camera; with --colour the picture in colours"},
           {"ID-mask.png",
            "white where every sample of the kernel lies in the picture, is finite, not saturated and "
            "counted by the image's own mask"}},
      .references =
          {"EMVA Standard 1288, release 4.0, 2021.",
           "Debevec & Malik, Recovering high dynamic range radiance maps from photographs, SIGGRAPH 1997.",
           "Tobin, Estimation of relationships for limited dependent variables, Econometrica 26(1), 1958.",
           "Malvar, He & Cutler, High-quality linear interpolation for demosaicing of Bayer-patterned color images, "
           "ICASSP 2004.",
           "Ratliff, LaCasse & Tyo, Interpolation strategies for reducing IFOV artifacts in microgrid polarimeter "
           "imagery, Optics Express 17(11), 2009.",
           "Keys, Cubic convolution interpolation for digital image processing, IEEE Trans. ASSP 29(6), 1981.",
           "Mitchell & Netravali, Reconstruction filters in computer graphics, SIGGRAPH 1988.",
           "Duchon, Lanczos filtering in one and two dimensions, J. Applied Meteorology 18(8), 1979."},
      .see_also = {"calib-charuco(1)", "color-calib(1)", "camera-export(1)", "gonio-conventions(7)",
                   "gonio-manifest(5)"},
      .check = check,
      .run = run};
  return program;
}

}  // namespace gonio::tools::develop
