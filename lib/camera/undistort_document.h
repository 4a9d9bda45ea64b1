// The manifest's photographs through undistort(): pictures and masks on disk, a pinhole camera in the manifest.
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "camera/undistort.h"
#include "manifest/sections/forward.h"
#include "manifest/value.h"

namespace gonio::camera {

enum class PictureFormat { same, exr, png8, png16 };  // same: EXR from EXR, else PNG with the source's number of bits

struct UndistortRequest {
  PinholeChoice choice;
  bool limit_overshoot = false;
  PictureFormat format = PictureFormat::same;
  std::optional<double> saturation;  // stored values from here on are saturated; left out: the highest code, EXR never
  std::vector<std::size_t> images;   // places in document.images
  std::function<std::filesystem::path(const std::string& name)> output_path;
  std::function<void(const std::filesystem::path&)> note_input;
};

// The camera of an image: as it says, else the only one. Error(data) where neither is there.
std::string camera_of_picture(const manifest::Document& document, std::size_t index);
// Photographs by `camera` become images of the manifest; `response` null: not known. Their places in document.images.
std::vector<std::size_t> enter_photographs(const std::vector<std::string>& paths, const std::string& camera,
                                           const manifest::Value& response, manifest::Document& document);
// Places of the images that have a file; where a camera is named, of its own alone.
std::vector<std::size_t> images_with_pictures(const manifest::Document& document,
                                              const std::optional<std::string>& camera);

// Images with a file that is there, whose camera has a lens: what undistort_document() would do, without the pixels.
void check_undistortion(const manifest::Document& document, const UndistortRequest& request);

// Writes ID.exr or ID.png and ID-mask.png for every image, points the image to them and to the camera
// CAMERA-undistorted, and takes back what no longer holds: `noise`, because neighbours are no more independent.
void undistort_document(manifest::Document& document, const UndistortRequest& request);

}  // namespace gonio::camera
