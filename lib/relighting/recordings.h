// The recordings that a manifest names, ready to be compared with a simulation: linear pictures, which of their pixels
// count, their noise, and from which view and under which lights each was taken.
//
// A view is one camera in one pose; images that share it share everything that geometry decides. Pixel values are
// linear in radiance, in whatever unit the recording has. Integer files (PNG, JPEG) lose their saturated pixels: they
// say only "at least".
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "camera/camera_model.h"
#include "geom/rigid.h"
#include "io/image.h"
#include "manifest/noise.h"
#include "manifest/parameter.h"
#include "manifest/sections/forward.h"

namespace gonio::relighting {

struct View {
  std::string camera;  // key in the manifest's cameras
  camera::CameraModel model;
  Rigid<frame::World, frame::Camera> world_from_camera;
  bool operator==(const View&) const = default;
};

struct Recording {
  std::string id;
  std::size_t entry = 0;  // place in document.images
  std::size_t view = 0;
  std::vector<std::size_t> lights;   // that were on: places in Recordings::lights
  io::Image picture;                 // linear, channels R, G, B
  bool grey = false;                 // these are one reading
  Rgb mean;                          // of all finite pixels of the picture
  std::vector<std::uint8_t> counts;  // one per pixel: 1 where the pixel may be used
  manifest::Noise noise;             // variance of a linear value v: v / gain + read^2 (gain 0: no shot noise)
  std::vector<float> variance;       // of picture.data, where its file states it and the manifest no noise; else empty
  manifest::Parameter gain;          // factor on the simulated radiance
  std::optional<double> exposure_s, time_s, temperature_K;
};

struct Recordings {
  std::vector<View> views;
  std::vector<std::string> lights;  // keys in the manifest's lights, sorted: those that were on in any
  std::vector<Recording> images;
  double first_time_s = 0, last_time_s = 0;  // of those that state one
};

// Objects, and images of them that name a file and a camera.
bool has_recordings(const manifest::Document& document);
// Keys in the manifest's lights: those that were on in an image whose weight is not zero, sorted.
std::vector<std::string> lights_of_recordings(const manifest::Document& document);
// Reads the pictures and masks of all images whose weight is not zero. Error(data) with the place in the manifest where
// a size, a response or a reference does not fit.
Recordings read_recordings(const manifest::Document& document);

// A further take of an image: its values as `image` has them.
io::Image read_take(const manifest::Document& document, const Recording& image, const std::filesystem::path& path);

// One standard deviation of the noise of `image` where its picture is `value` bright.
double noise_sigma(const Recording& image, double value);
// The same at a place in its picture.data, by what the file says of that place.
double noise_sigma(const Recording& image, double value, std::size_t place);
// Mean of the counted pixels of a 5 x 5 window: a brightness that the pixel's own noise hardly moves.
Rgb local_mean(const Recording& image, int x, int y);

}  // namespace gonio::relighting
