// See characterize.h.
#include "tools/develop/characterize.h"

#include <algorithm>
#include <set>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/progress.h"
#include "base/text.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "photograph/characterize.h"
#include "photograph/sensor_linearity.h"
#include "tools/develop/merge.h"
#include "tools/develop/sensor_page.h"

namespace gonio::tools::develop {
namespace {

using cli::Type;

// Frames, and the images of the manifest that get their sensor's noise.
struct Series {
  std::vector<std::filesystem::path> lit, dark;
  std::vector<std::optional<double>> lit_s, dark_s;
  std::vector<std::size_t> images;
  photograph::RawStated stated;
  std::vector<std::optional<double>> exposures_s() const {
    std::vector<std::optional<double>> all = lit_s;
    all.insert(all.end(), dark_s.begin(), dark_s.end());
    return all;
  }
};

// Of the manifest, with a file, by the one camera that is asked about.
std::vector<std::size_t> images_of_camera(const cli::Invocation& call, Series& series) {
  std::vector<std::size_t> images;
  std::set<std::string> cameras;
  const auto& all = call.document.images;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].file.empty() || (call.given("camera") && all[i].camera != call.text("camera"))) continue;
    images.push_back(i), cameras.insert(all[i].camera);
  }
  if (cameras.size() > 1)
    throw Error(Exit::usage, "--camera", format("is missing, and images are of %zu cameras", cameras.size()),
                "a sensor at a time");
  if (!cameras.empty() && series.stated.mosaic.empty())
    if (const auto found = call.document.cameras.find(*cameras.begin()); found != call.document.cameras.end())
      series.stated.mosaic = found->second.mosaic;
  return images;
}

void take_images(const cli::Invocation& call, Series& series) {
  for (const std::size_t i : series.images) {
    const manifest::ImageEntry& image = call.document.images[i];
    const bool dark = image.dark == true;
    (dark ? series.dark : series.lit).push_back(manifest::picture_path(call.document, i));
    (dark ? series.dark_s : series.lit_s).push_back(image.exposure_s);
  }
}

// Frames of the command line as images, where there is no manifest for the noise to stand in.
void enter_frames(cli::Invocation& call, Series& series, const photograph::SensorSeries& frames) {
  std::set<std::string> taken;
  for (std::size_t k = 0; k < frames.frames.size(); ++k) {
    const photograph::SeriesFrame& frame = frames.frames[k];
    const std::string stem = std::filesystem::path(frame.name).stem().string();
    std::string id = stem;
    for (int n = 2; !taken.insert(id).second; ++n) id = stem + "-" + std::to_string(n);
    manifest::ImageEntry image;
    image.id = id, image.file = manifest::add_file(call.document, frame.name, id);
    if (call.given("camera")) image.camera = call.text("camera");
    image.exposure_s = frame.exposure_s;
    if (frame.dark) image.dark = true;
    const double full = photograph::full_code_of(frame.name);
    if (full > 1 && series.stated.white) image.saturation = (*series.stated.white - 0.5) / full;
    if (const double black = series.stated.black.value_or(0) / full; full > 1 && black > 0) {
      image.response = manifest::Value::array();  // the sensor's own numbers, above what it reads in the dark
      image.response.push_back(manifest::Value(std::vector<double>{0, -black}));
      image.response.push_back(manifest::Value(std::vector<double>{1, 1 - black}));
    }
    series.images.push_back(call.document.images.size());
    call.document.images.push_back(std::move(image));
  }
}

Series series_of(cli::Invocation& call) {
  Series series;
  series.stated = stated(call);
  if (call.has_document) series.images = images_of_camera(call, series);
  if (call.given("PHOTOGRAPH"))
    series.lit = paths(call, "PHOTOGRAPH");
  else
    take_images(call, series);
  series.lit_s.resize(series.lit.size());
  const auto more = paths(call, "dark");
  series.dark.insert(series.dark.end(), more.begin(), more.end());
  series.dark_s.resize(series.dark.size());
  if (series.lit.empty())
    throw Error(Exit::no_input, "develop", "has no frames of even light",
                "name them, or pipe in a manifest whose images have files");
  if (series.dark.empty())
    throw Error(Exit::usage, "--dark", "is missing, and no image is dark",
                "two frames or more without light, of one exposure at least");
  return series;
}

std::string words_of(const photograph::SensorFigures& f) {
  std::string text = format("--noise-gain %.4g --read-noise %.4g in codes", f.codes.gain, f.codes.read);
  std::set<std::string> said;  // colours mostly leave out the same
  for (const auto& plane : f.planes)
    for (const std::string& left_out : plane.left_out)
      if (said.insert(left_out).second) text += "; no " + left_out;
  return text;
}

std::string words_of(const photograph::SensorLinearity& l) {
  if (!l.left_out.empty()) return "no linearity table: " + l.left_out;
  const std::string most =
      format("%.2g(%.0g) %% at code %.4g above black", 100 * l.worst, 100 * l.worst_sigma, l.worst_at);
  return l.significant() ? "not linear by up to " + most + ": linearity.csv for --merge"
                         : "linear as far as can be told, off by no more than " + most;
}

}  // namespace

std::vector<cli::Option> characterize_options() {
  return {{.name = "characterize",
           .type = Type::flag,
           .help = "Find a sensor's gain, noise and fixed pattern (EMVA 1288) in frames of even light at several "
                   "exposures and in dark frames, two or more of each.",
           .conflicts = {"merge", "undistort", "colour"}}};
}

void check_characterize(cli::Invocation& call) {
  if (call.out.empty()) throw Error(Exit::usage, "--out", "is missing", "name the folder for the report");
  if (!call.given("PHOTOGRAPH") && !call.has_document)
    throw Error(Exit::no_input, "develop", "has no frames of even light",
                "name them, or pipe in a manifest whose images have files");
  if (call.given("PHOTOGRAPH") || call.given("dark")) call.document.allow_outside = true;
  series_of(call);
}

Exit characterize(cli::Invocation& call) {
  Series series = series_of(call);
  const auto page = call.output_path("sensor.html"), csv = call.output_path("sensor.csv");
  photograph::SensorSeries frames =
      photograph::series_of_files(series.lit, series.dark, series.exposures_s(), series.stated);
  Progress progress("develop", frames.frames.size());
  frames.read = [&progress, read = frames.read](std::size_t k) {
    photograph::RawFrame frame = read(k);
    progress.advance();
    return frame;
  };
  const photograph::SeriesSums sums = photograph::sum_series(frames);
  const photograph::SensorFigures f = photograph::characterize(sums);
  const photograph::SensorLinearity linearity = photograph::sensor_linearity(sums, f);
  for (const auto& frame : frames.frames) call.note_input(frame.name);
  write_file(page, sensor_page(f));
  write_file(csv, sensor_csv(f));
  if (linearity.significant()) write_file(call.output_path("linearity.csv"), photograph::linearity_csv(linearity.rows));
  if (!call.has_document) enter_frames(call, series, frames);
  for (const std::size_t i : series.images)
    if (photograph::full_code_of(manifest::picture_path(call.document, i)) == f.full_code)
      call.document.images[i].noise = f.unit;
  log(LogLevel::info, words_of(f) + "; " + words_of(linearity));
  return Exit::done;
}

}  // namespace gonio::tools::develop
