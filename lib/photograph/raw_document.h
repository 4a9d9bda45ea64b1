// Raw frames through develop_view(): pictures and masks on disk, images in the manifest.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "manifest/sections/forward.h"
#include "photograph/raw_view.h"

namespace gonio::photograph {

struct RawRequest {
  std::vector<RawView> views;
  std::vector<std::vector<std::size_t>> images;  // of each view, places in document.images; empty: views are new images
  std::vector<std::size_t> spent;                // further places that go: dark frames
  RawRecipe recipe;
  std::string camera;  // of new images; empty: not known
  std::function<std::filesystem::path(const std::string& name)> output_path;
  std::function<void(const std::filesystem::path&)> note_input;
  bool resume = false;  // pictures that an earlier, identical call finished stay as they are
  // For planes and decoded frames of all views that are made at the same time; of one view, what it needs.
  std::size_t memory_bytes = std::size_t{4} << 30;
};

// Exposure times say how much light there was where the aperture stayed: Error(data) where an image of a view states
// another f_number than the view's first image.
void refuse_other_aperture(const manifest::Document& document, std::size_t first, std::size_t image);

// Views of the manifest's images with a file, by camera: images of one `group` are exposures of one view, others stand
// alone; Error(data) for images that say that they are developed. Images that are `dark` become `dark_frames`. Fills
// `views`, `images` and, of the recipe where it does not say so already, black and full scale by the images' response
// (a straight line above black) and saturation, the mosaic by the camera, and the noise where all images state the
// same. Error(data) where a response bends, or images differ.
void views_of_images(const manifest::Document& document, const std::string& camera, RawRequest& request,
                     std::vector<std::filesystem::path>& dark_frames);

// Writes VIEW.exr and VIEW-mask.png for every view, and puts one image for each into the manifest, in the place of
// those that it is made of: linear, in codes per second, with variance, and with the gain from radiance to these where
// all its images state theirs. Light before polarizers is of a camera of its own, NAME-stokes, which has no mosaic.
// What each view's exposures said is logged.
// Views are made side by side, as many as memory allows. Error(try_again) where a signal ended it: pictures that are
// there are whole, and a call with `resume` makes the rest; files and manifest are the same as without interruption.
void develop_raw(manifest::Document& document, const RawRequest& request);

}  // namespace gonio::photograph
