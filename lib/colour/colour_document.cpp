// See colour_document.h.
#include "colour/colour_document.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/progress.h"
#include "base/text.h"
#include "colour/chart_detection.h"
#include "colour/chart_table.h"
#include "colour/preview.h"
#include "io/codes.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/colour_correction.h"
#include "manifest/sections/image.h"
#include "manifest/sections/table.h"
#include "photograph/developed.h"
#include "photograph/linear_picture.h"
#include "photograph/mask.h"
#include "photograph/noise_variance.h"

namespace gonio::colour {
namespace {

std::vector<double> list(Rgb v) {
  return {v.x, v.y, v.z};
}

std::vector<PixelState> states_of(const photograph::LinearPicture& picture, const ChartPhotograph& photograph) {
  std::vector<PixelState> states(picture.colour.pixels(), PixelState::good);
  if (!photograph.mask.empty()) {
    const auto counts = photograph::read_mask_of(picture.colour, photograph.mask, photograph.place);
    for (std::size_t i = 0; i < states.size(); ++i)
      if (counts[i] == 0) states[i] = PixelState::masked;
  }
  for (std::size_t i = 0; i < states.size(); ++i)
    if (picture.clipped[i] != 0) states[i] = PixelState::clipped;
  return states;
}

ChartPose pose_in(const io::Image& picture, const ChartRequest& request) {
  const std::string& place = request.photograph.place;
  if (!request.corners) {
    const FoundChart found = find_chart(picture, request.chart, place);
    const auto c = corners_of(found.pose);
    log(LogLevel::info,
        format("%s: %s found, corners %.0f,%.0f %.0f,%.0f %.0f,%.0f %.0f,%.0f", place.c_str(),
               request.chart.name.c_str(), c[0].x, c[0].y, c[1].x, c[1].y, c[2].x, c[2].y, c[3].x, c[3].y));
    return found.pose;
  }
  const ChartPose pose = pose_from_corners(*request.corners, "--corners");
  const double misfit = colour_misfit(picture, request.chart, pose);
  const auto c = corners_of(pose);
  for (std::size_t turn = 1; turn < 4 && std::isfinite(misfit); ++turn) {
    const ChartPose turned =
        pose_from_corners({c[turn], c[(turn + 1) % 4], c[(turn + 2) % 4], c[(turn + 3) % 4]}, "--corners");
    const double other = colour_misfit(picture, request.chart, turned);
    if (other < most_misfit_de00 && misfit > least_lead * other)
      throw Error(Exit::data, "--corners",
                  format("begin at another corner than the first patch: colours differ by %.1f dE00, and by %.1f where "
                         "the chart begins at corner %zu",
                         misfit, other, turn + 1),
                  "start there");
  }
  return pose;
}

void fill(manifest::ColourCorrection& section, const ChartRequest& request, const ChartPose& pose,
          const std::vector<PatchReading>& readings, const Calibration& found) {
  const Correction& correction = found.correction;
  section.model = name_of(correction.model()), section.matrix = correction.matrix();
  section.white = list(correction.white()), section.to = name_of(correction.target());
  section.covariance = found.covariance;
  section.fitted_de00 = found.fitted.mean, section.fitted_sd_de00 = found.fitted.deviation;
  section.fitted_most_de00 = found.fitted.most;
  section.held_out_de00 = found.held_out.mean, section.held_out_sd_de00 = found.held_out.deviation;
  section.held_out_most_de00 = found.held_out.most;
  section.metamerism_de00 = request.metamerism_de00;
  section.exposure_de00 = found.exposure_de00, section.noise_gain = found.noise_gain;
  const Rgb w = found.white;
  const auto over_white = [&](Rgb v) { return std::vector<double>{v.x / w.x, v.y / w.y, v.z / w.z}; };
  if (found.taken.offset_sigma != Rgb{}) {
    section.offset = over_white(found.taken.offset);
    section.sigma["offset"] = over_white(found.taken.offset_sigma);
  }
  if (found.taken.gradient_sigma.x > 0) {
    section.gradient = {found.taken.gradient.x, found.taken.gradient.y};
    section.sigma["gradient"] = {found.taken.gradient_sigma.x, found.taken.gradient_sigma.y};
  }
  if (found.taken.curve_sigma.x > 0) {
    section.curve = list(found.taken.curve);
    section.sigma["curve"] = list(found.taken.curve_sigma);
  }
  section.chart = request.chart.name, section.edition = request.chart.edition, section.light = request.chart.light;
  section.image = request.photograph.image, section.camera = request.photograph.camera;
  for (const Vec2 corner : corners_of(pose)) section.corners_px.insert(section.corners_px.end(), {corner.x, corner.y});
  for (std::size_t p = 0; p < readings.size(); ++p) {
    manifest::ColourPatch patch;
    patch.name = request.chart.patches[p].name, patch.reference = list(request.chart.patches[p].lab);
    patch.left_out = readings[p].left_out;
    if (patch.left_out.empty()) {
      const Mat3& c = readings[p].covariance;
      patch.read = over_white(readings[p].rgb);
      patch.sigma = over_white({std::sqrt(c(0, 0)), std::sqrt(c(1, 1)), std::sqrt(c(2, 2))});
      patch.fitted_de00 = found.patches[p].fitted, patch.held_out_de00 = found.patches[p].held_out;
    }
    section.patches.push_back(std::move(patch));
  }
  for (const Tried& tried : found.tried) {
    manifest::ColourAlternative alternative{name_of(tried.model), {}, {}, tried.refused};
    if (tried.refused.empty()) alternative.fitted_de00 = tried.fitted, alternative.held_out_de00 = tried.held_out;
    section.alternatives.push_back(std::move(alternative));
  }
}

const manifest::ColourCorrection& section_of(const manifest::Document& document, const std::string& name) {
  const auto found = document.colour.find(name);
  if (found != document.colour.end()) return found->second;
  std::string names;
  for (const auto& [other, section] : document.colour) names += (names.empty() ? "" : ", ") + other;
  throw Error(Exit::data, manifest::place(document, "/colour"), "has no \"" + name + "\"",
              names.empty() ? "run color-calib first" : "there is " + names);
}

}  // namespace

ChartPhotograph photograph_of_image(const manifest::Document& document, const std::string& id) {
  std::vector<std::size_t> shown;
  for (std::size_t i = 0; i < document.images.size(); ++i)
    if (!document.images[i].file.empty() && (id.empty() || document.images[i].id == id)) shown.push_back(i);
  if (shown.empty())
    throw Error(Exit::data, manifest::place(document, "/images"),
                id.empty() ? "have no file" : "have no \"" + id + "\" with a file", "name the chart's photograph");
  if (shown.size() > 1)
    throw Error(Exit::usage, "--image", format("is missing, and the manifest has %zu images", shown.size()),
                "say which shows the chart");
  const manifest::ImageEntry& image = document.images[shown[0]];
  return {manifest::picture_path(document, shown[0]),
          manifest::mask_path(document, shown[0]),
          image.response,
          image.saturation,
          manifest::place(document, "/images/" + std::to_string(shown[0])),
          image.id,
          image.camera,
          image.exposure_s};
}

Calibration calibrate_document(manifest::Document& document, const ChartRequest& request) {
  const ChartPhotograph& photograph = request.photograph;
  const auto picture =
      photograph::read_linear(photograph.picture, photograph.response, photograph.place, photograph.saturation);
  if (picture.colour.channels.size() != 3)
    throw Error(Exit::data, photograph.place, "has one channel, and colours need three",
                "make a picture of a raw frame with develop --merge");
  const ChartPose pose = pose_in(picture.colour, request);
  const auto readings =
      read_patches(picture.colour, states_of(picture, photograph), pose, request.chart, photograph.place);
  std::string left_out;
  for (std::size_t p = 0; p < readings.size(); ++p)
    if (!readings[p].left_out.empty())
      left_out += (left_out.empty() ? "" : ", ") + request.chart.patches[p].name + " (" + readings[p].left_out + ")";
  if (!left_out.empty()) log(LogLevel::warning, photograph.place + ": left out: " + left_out);
  const Calibration calibration = calibrate(request.chart, readings, request.calibration, photograph.place);
  for (const std::string& line : words_of(request.chart, calibration)) log(LogLevel::info, line);
  if (request.metamerism_de00)
    log(LogLevel::info, format("no correction can mend %.2f dE00 of what other materials than a chart's inks may have",
                               *request.metamerism_de00));
  if (!request.preview.empty())
    io::write_picture(request.preview, before_and_after(picture.colour, request.chart, pose, calibration));
  manifest::ColourCorrection section;
  fill(section, request, pose, readings, calibration);
  document.colour[request.name] = std::move(section);
  if (auto table = chart_table(request.chart, readings, pose, picture.colour,
                               {photograph.image, photograph.exposure_s, request.sensed}))
    document.tables[request.name + "-chart"] = std::move(*table);
  return calibration;
}

Correction correction_for(const manifest::Document& document, const std::string& name, std::size_t image) {
  const manifest::ColourCorrection& section = section_of(document, name);
  photograph::refuse_second(document, image, manifest::develop_step::colour, "is corrected already",
                            "give the picture that it was made of");
  const std::string& camera = document.images[image].camera;
  if (!section.camera.empty() && !camera.empty() && camera != section.camera)
    throw Error(Exit::data, manifest::place(document, "/images/" + std::to_string(image)),
                "is of camera \"" + camera + "\", and the correction of \"" + section.camera + "\"",
                "name the images of that camera");
  return correction_of(section, manifest::place(document, "/colour/" + name));
}

void correct(const Correction& correction, photograph::LinearPicture& picture, std::optional<manifest::Noise>& noise,
             const std::string& place) {
  if (noise) {
    picture.variance = picture.colour;
    for (float& v : picture.variance.data) v = static_cast<float>(photograph::noise_variance(*noise, v));
    noise.reset();
  }
  const bool varies = !picture.variance.data.empty();
  const std::size_t colours = picture.colour.channels.size(), all = varies ? 2 * colours : colours;
  std::vector<std::string> names = picture.colour.channels;
  if (varies)
    for (const std::string& channel : picture.colour.channels) names.push_back("variance." + channel);
  io::Image joined(picture.colour.width, picture.colour.height, names);
  const auto exchange = [&](auto&& move) {
    for (std::size_t i = 0; i < joined.pixels(); ++i)
      for (std::size_t c = 0; c < colours; ++c) {
        move(joined.data[all * i + c], picture.colour.data[colours * i + c]);
        if (varies) move(joined.data[all * i + colours + c], picture.variance.data[colours * i + c]);
      }
  };
  exchange([](float& to, float from) { to = from; });
  apply(correction, joined, place);
  exchange([](float from, float& to) { to = from; });
}

void check_colours(const manifest::Document& document, const ColourRequest& request) {
  correction_of(section_of(document, request.name), manifest::place(document, "/colour/" + request.name));
  for (const std::size_t i : request.images) {
    const std::string place = manifest::place(document, "/images/" + std::to_string(i));
    correction_for(document, request.name, i);
    if (io::code_bits(manifest::picture_path(document, i)) != 0)
      throw Error(Exit::data, place, "is a picture of codes, and colours are corrected in linear light",
                  "make OpenEXR of it with develop --merge");
  }
}

void colour_document(manifest::Document& document, const ColourRequest& request) {
  Correction correction =
      correction_of(section_of(document, request.name), manifest::place(document, "/colour/" + request.name));
  if (request.keeps_level) correction = correction.scaled(correction.white().y);
  Progress progress("develop", request.images.size());
  for (const std::size_t i : request.images) {
    manifest::ImageEntry& image = document.images[i];
    const auto from = manifest::picture_path(document, i);
    request.note_input(from);
    io::Image picture = io::read_picture(from);
    apply(correction, picture, manifest::place(document, "/images/" + std::to_string(i)));
    const auto to = request.output_path(file_stem(image.id) + ".exr");
    io::write_picture(to, picture);
    image.file = manifest::add_file(document, to, image.id + "-" + request.name);
    image.noise.reset(), image.saturation.reset();
    image.developed.push_back({manifest::develop_step::colour, request.name});
    progress.advance();
  }
}

}  // namespace gonio::colour
