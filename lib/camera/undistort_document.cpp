#include "camera/undistort_document.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/progress.h"
#include "base/text.h"
#include "camera/calibrate_document.h"
#include "camera/mosaic.h"
#include "io/codes.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "photograph/developed.h"
#include "photograph/mask.h"
#include "photograph/mosaic.h"
#include "photograph/response.h"
#include "photograph/saturation.h"

namespace gonio::camera {
namespace {

std::string pointer_of(std::size_t index) {
  return "/images/" + std::to_string(index);
}

struct Work {
  std::string camera, place;
  std::filesystem::path path;
};

Work work_of(const manifest::Document& document, std::size_t index) {
  const manifest::ImageEntry& image = document.images[index];
  Work work;
  work.camera = camera_of_picture(document, index);
  work.place = manifest::place(document, "/cameras/" + work.camera);
  if (!document.cameras.contains(work.camera)) throw Error(Exit::data, work.place, "missing", "calibrate it first");
  if (image.file.empty())
    throw Error(Exit::data, manifest::place(document, pointer_of(index) + "/file"), "missing", "name the photograph");
  work.path = manifest::picture_path(document, index);
  return work;
}

// Are the three colours of every pixel one reading? Grey pictures are stored so, too.
bool in_triplicate(const io::Image& raw) {
  const int r = raw.channel("R"), g = raw.channel("G"), b = raw.channel("B");
  for (std::size_t i = 0; i < raw.pixels(); ++i) {
    const float* v = &raw.data[i * raw.channels.size()];
    if (v[r] != v[g] || v[g] != v[b]) return false;
  }
  return true;
}

// Pixels from one to the next behind the same filter. One reading a pixel is the mosaic itself; three colours of a
// colour mosaic were interpolated before, and Stokes planes stand for light before any filter. Three colours behind
// polarizers may be either.
int pitch_of(const io::Image& raw, const manifest::Camera& camera, const Work& work) {
  const int pitch = filter_pitch(camera.mosaic, work.place + "/mosaic");
  if (pitch == 1 || raw.channel("R") < 0 || raw.channel("G") < 0 || raw.channel("B") < 0 || in_triplicate(raw))
    return pitch;
  if (photograph::is_bayer(camera.mosaic) || raw.channel("s1.R") >= 0) return 1;
  throw Error(Exit::data, work.path.string(),
              "has three colours of a camera with polarizers: filtered light or not, it does not say",
              "give one channel Y for the mosaic, or a camera without \"mosaic\" for light before the polarizers");
}

PinholeChoice choice_of(const UndistortRequest& request, int pitch) {
  PinholeChoice choice = request.choice;
  choice.pitch = pitch;
  return choice;
}

bool is_stokes(const std::string& channel) {  // s1.R, s2.Y, ...
  return channel.size() == 4 && channel[0] == 's' && channel[1] >= '1' && channel[1] <= '3' && channel[2] == '.';
}

// Colour, what polarizers say of it, and their variances; other channels of an EXR (ids, positions) mean nothing
// between pixels. Stokes vectors are relative to the camera's x axis, whatever the lens draws where.
io::Image colour_of(const io::Image& raw, const std::string& place) {
  std::vector<std::string> names;
  for (const std::string& name : raw.channels) {
    std::string base = name.starts_with("variance.") ? name.substr(9) : name;
    if (is_stokes(base)) base = base.substr(3);
    if (base == "R" || base == "G" || base == "B" || base == "Y") names.push_back(name);
  }
  if (names.empty()) throw Error(Exit::data, place, "has neither the channels R, G, B nor Y");
  if (names.size() == raw.channels.size()) return raw;
  io::Image image(raw.width, raw.height, names);
  for (std::size_t c = 0; c < names.size(); ++c) {
    const auto from = static_cast<std::size_t>(raw.channel(names[c]));
    for (std::size_t i = 0; i < raw.pixels(); ++i)
      image.data[i * names.size() + c] = raw.data[i * raw.channels.size() + from];
  }
  return image;
}

// Is it a reading of light, and no variance or difference of such?
bool is_reading(const io::Image& image, std::size_t value) {
  const std::string& channel = image.channels[value % image.channels.size()];
  return !channel.starts_with("variance.") && !is_stokes(channel);
}

// Per pixel: no saturated sample, and counted by the image's mask.
std::vector<std::uint8_t> good_pixels(const io::Image& stored, double saturation, const std::filesystem::path& mask) {
  std::vector<std::uint8_t> good(stored.pixels(), 1);
  const std::size_t channels = stored.channels.size();
  for (std::size_t i = 0; i < stored.data.size(); ++i)
    if (stored.data[i] >= saturation && is_reading(stored, i)) good[i / channels] = 0;
  if (mask.empty()) return good;
  const std::vector<std::uint8_t> counts = photograph::read_mask_of(stored, mask, mask.string());
  for (std::size_t i = 0; i < good.size(); ++i) good[i] = good[i] && counts[i];
  return good;
}

void check_size(const io::Image& stored, const manifest::Camera& camera, const Work& work) {
  if (stored.width == camera.width_px && stored.height == camera.height_px) return;
  throw Error(Exit::data, work.path.string(),
              std::to_string(stored.width) + " x " + std::to_string(stored.height) + " pixels, its camera has " +
                  std::to_string(camera.width_px) + " x " + std::to_string(camera.height_px),
              "use the camera that took it; pictures must be neither cropped nor scaled");
}

// Where the response of an 8 or 16-bit picture is not stated it is the identity, and codes are interpolated as they
// are.
photograph::Response response_of(const manifest::Value& stated, const std::string& place, bool codes_are_written) {
  photograph::Response response(stated, place);
  if (codes_are_written) response.check_invertible(place);
  return response;
}

// Back to codes. Returns how many values lay outside what codes can hold by more than half a code.
std::size_t encode(io::Image& image, const photograph::Response& response, double half_code) {
  std::size_t outside = 0;
  for (float& v : image.data) {
    v = response.code(v);
    if (v < -half_code || v > 1 + half_code) ++outside;
  }
  return outside;
}

void write(const std::filesystem::path& path, io::Image& picture, const std::vector<std::uint8_t>& valid,
           const photograph::Response& response, int bits) {
  if (bits == 0) {
    io::write_picture(path, picture);
    return;
  }
  const std::size_t outside = encode(picture, response, photograph::half_code(bits));
  io::write_png(path, picture, bits);
  const auto invalid = static_cast<std::size_t>(std::ranges::count(valid, std::uint8_t{0}));
  if (outside > 0)
    log(LogLevel::info, path.string() + ": " + std::to_string(outside) +
                            " interpolated values lie outside the range of codes and were clipped (" +
                            std::to_string(invalid) + " pixels are invalid); --format exr keeps them");
}

int bits_for(PictureFormat format, int source_bits) {
  if (format == PictureFormat::same) return source_bits;
  return format == PictureFormat::exr ? 0 : format == PictureFormat::png8 ? 8 : 16;
}

void undistort_image(manifest::Document& document, std::size_t index, const UndistortRequest& request,
                     const std::filesystem::path& picture_path, const std::filesystem::path& mask_path, int bits) {
  const Work work = work_of(document, index);
  manifest::ImageEntry& image = document.images[index];
  const manifest::Camera& camera = document.cameras.at(work.camera);
  const std::string place = manifest::place(document, pointer_of(index));
  const int source_bits = io::code_bits(work.path);
  const io::Image raw = io::read_picture(work.path);
  const int pitch = pitch_of(raw, camera, work);
  const manifest::Camera pinhole = pinhole_for(camera, choice_of(request, pitch), work.place);
  io::Image stored = colour_of(raw, work.path.string());
  check_size(stored, camera, work);
  request.note_input(work.path);
  const auto mask = manifest::mask_path(document, index);
  if (!mask.empty()) request.note_input(mask);
  const double saturation =
      request.saturation ? *request.saturation : photograph::saturated_from(source_bits, image.saturation);
  const std::vector<std::uint8_t> good = good_pixels(stored, saturation, mask);
  const photograph::Response response = response_of(image.response, place, bits != 0);
  for (std::size_t i = 0; i < stored.data.size(); ++i)
    if (is_reading(stored, i)) stored.data[i] = response(stored.data[i]);
  const Resampling resampling{request.choice.kernel, std::max(1.0, 1 / request.choice.scale), request.limit_overshoot,
                              pitch};
  Undistorted result =
      undistort(stored, good, CameraModel(camera, work.place), CameraModel(pinhole, work.place), resampling);
  write(picture_path, result.picture, result.valid, response, bits);
  io::Image counts(result.picture.width, result.picture.height, {"Y"});
  std::ranges::transform(result.valid, counts.data.begin(), [](std::uint8_t v) { return static_cast<float>(v); });
  io::write_png(mask_path, counts, 8);
  image.camera = work.camera + "-undistorted";
  document.cameras[image.camera] = pinhole;
  image.file = manifest::add_file(document, picture_path, image.id + "-undistorted");
  image.mask = manifest::add_file(document, mask_path, image.id + "-mask");
  image.noise.reset();
  image.developed.push_back(
      {manifest::develop_step::undistort, std::string(kernel_names[static_cast<std::size_t>(request.choice.kernel)])});
  if (bits == 0) image.response = {};
  if (bits != 0 && source_bits == 0) image.response = "linear";
}

}  // namespace

std::string camera_of_picture(const manifest::Document& document, std::size_t index) {
  const std::string& given = document.images[index].camera;
  if (!given.empty()) return given;
  if (document.cameras.size() == 1) return document.cameras.begin()->first;
  throw Error(Exit::data, manifest::place(document, pointer_of(index) + "/camera"), "missing",
              "say which of the cameras took the image");
}

std::vector<std::size_t> enter_photographs(const std::vector<std::string>& paths, const std::string& camera,
                                           const manifest::Value& response, manifest::Document& document) {
  std::vector<std::size_t> entered;
  for (std::size_t k = 0; k < paths.size(); ++k) entered.push_back(document.images.size() + k);
  enter_pictures(paths, "pinhole", document);
  for (const std::size_t index : entered) {
    manifest::ImageEntry& image = document.images[index];
    image.camera = camera;
    image.board.clear();
    image.response = response;
  }
  return entered;
}

std::vector<std::size_t> images_with_pictures(const manifest::Document& document,
                                              const std::optional<std::string>& camera) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < document.images.size(); ++i) {
    const manifest::ImageEntry& image = document.images[i];
    if (!image.file.empty() && (!camera || image.camera == *camera)) found.push_back(i);
  }
  return found;
}

void check_undistortion(const manifest::Document& document, const UndistortRequest& request) {
  if (request.images.empty())
    throw Error(Exit::data, manifest::place(document, "/images"), "has no image with a file", "name photographs");
  std::map<std::string, int> pitch_of_camera;
  for (const std::size_t index : request.images) {
    const Work work = work_of(document, index);
    const manifest::ImageEntry& image = document.images[index];
    photograph::refuse_second(document, index, manifest::develop_step::undistort, "has no lens distortion any more",
                              "give the photograph that it was made of");
    const manifest::Camera& camera = document.cameras.at(work.camera);
    const int pitch = camera.mosaic.empty() ? 1 : pitch_of(io::read_picture(work.path), camera, work);
    if (pitch_of_camera.try_emplace(work.camera, pitch).first->second != pitch)
      throw Error(Exit::data, work.path.string(),
                  pitch == 1 ? "has three colours a pixel, other pictures of its camera are mosaics"
                             : "is a mosaic, other pictures of its camera have three colours a pixel",
                  "give the two kinds cameras of their own");
    pinhole_for(camera, choice_of(request, pitch), work.place);
    const int source_bits = io::code_bits(work.path), bits = bits_for(request.format, source_bits);
    const std::string place = manifest::place(document, pointer_of(index));
    if (bits == 0 && source_bits != 0 && image.response.is_null())
      throw Error(Exit::data, place, "is an 8 or 16-bit picture whose response is not stated, and EXR is linear",
                  "state \"response\" (--response), or write codes");
    response_of(image.response, place, bits != 0);
  }
}

void undistort_document(manifest::Document& document, const UndistortRequest& request) {
  check_undistortion(document, request);
  struct Paths {
    std::filesystem::path picture, mask;
    int bits = 0;
  };
  std::vector<Paths> paths;  // asked for before the work begins: an existing file is an error at once
  for (const std::size_t index : request.images) {
    const std::string stem = file_stem(document.images[index].id);
    const int bits = bits_for(request.format, io::code_bits(work_of(document, index).path));
    paths.push_back(
        {request.output_path(stem + (bits == 0 ? ".exr" : ".png")), request.output_path(stem + "-mask.png"), bits});
  }
  Progress progress("undistort", request.images.size());
  for (std::size_t k = 0; k < request.images.size(); ++k) {
    undistort_image(document, request.images[k], request, paths[k].picture, paths[k].mask, paths[k].bits);
    progress.advance();
  }
}

}  // namespace gonio::camera
