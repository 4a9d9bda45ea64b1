// Corrections of colour in the manifest: found on a photograph of a chart, applied to others.
#pragma once
#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "colour/calibration.h"
#include "colour/chart.h"
#include "colour/correction.h"
#include "manifest/noise.h"
#include "manifest/sections/forward.h"
#include "manifest/value.h"
#include "photograph/linear_picture.h"

namespace gonio::colour {

struct ChartPhotograph {
  std::filesystem::path picture, mask;  // mask: white where pixels count; empty: all do
  manifest::Value response;             // of codes; null: not known
  std::optional<double> saturation;     // stored value from which on a pixel is clipped
  std::string place;                    // for messages
  std::string image, camera;            // id and name in the manifest; may be empty
  std::optional<double> exposure_s{};   // where the manifest states it
};

struct ChartRequest {
  ChartPhotograph photograph;
  Chart chart;
  std::optional<std::array<Vec2, 4>> corners;  // of pose_from_corners(); left out: the chart is searched for
  CalibrationRequest calibration;
  std::string name;               // in the manifest's "colour"
  std::filesystem::path preview;  // empty: none is drawn
  // Of the sensor, where it is known (metamerism.h): the bound, and what it reads of the patches; may be empty.
  std::optional<double> metamerism_de00{};
  std::vector<Rgb> sensed{};
};

// The photograph of this image of the manifest, by its id; empty: the only one with a file.
ChartPhotograph photograph_of_image(const manifest::Document& document, const std::string& id);

// Finds and reads the chart, calibrates, logs what was found, draws the preview and enters document.colour[name] and,
// where enough patches count, the table NAME-chart for explain.
Calibration calibrate_document(manifest::Document& document, const ChartRequest& request);

// What is logged of a calibration, line by line.
std::vector<std::string> words_of(const Chart& chart, const Calibration& calibration);

struct ColourRequest {
  std::string name;                 // in the manifest's "colour"
  bool keeps_level = false;         // white comes out as bright as the camera's G of it was, instead of 1
  std::vector<std::size_t> images;  // places in document.images
  std::function<std::filesystem::path(const std::string& name)> output_path;
  std::function<void(const std::filesystem::path&)> note_input;
};
// Writes ID.exr, the corrected picture with all its other channels, for every image, and points the image to it; noise
// that was stated for the pixels before is taken back. Error(data) for pictures that are not OpenEXR with R, G, B, for
// images of another camera than the correction's, and for those that say that they are corrected.
void colour_document(manifest::Document& document, const ColourRequest& request);
// The correction of that name for one of the images, whose pixels are still the camera's: Error(data) for images of
// another camera, and for those that say that they are corrected.
Correction correction_for(const manifest::Document& document, const std::string& name, std::size_t image);
// A photograph as it was read, as colours. Noise that is stated for it becomes its variance, which is corrected too.
void correct(const Correction& correction, photograph::LinearPicture& picture, std::optional<manifest::Noise>& noise,
             const std::string& place);
// The same without pixels: whether the correction and all files are there.
void check_colours(const manifest::Document& document, const ColourRequest& request);

}  // namespace gonio::colour
