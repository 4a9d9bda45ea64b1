// What `render` reads from and enters into the manifest's list of images.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "manifest/sections/forward.h"
#include "render/session.h"

namespace gonio::render {

// Places in document.images of the images with these ids; of all where `ids` is empty. Error(usage) for unknown ids,
// Error(data) where nothing is left.
std::vector<std::size_t> chosen_images(const manifest::Document& document, const std::vector<std::string>& ids);

// Error(data) where the image states no noise to record with.
void check_recordable(const manifest::Document& document, std::size_t image);

// `path` becomes the image's rendering, in place of an earlier one. `beside`: further files by kind; with "sums" it may
// be a share, and says of which samples.
void enter_rendering(manifest::Document& document, std::size_t image, const std::filesystem::path& path,
                     const Facts& facts, const std::vector<double>& wavelengths_m,
                     const std::map<std::string, std::filesystem::path>& beside);
// `path` becomes the image's own file, a linear recording.
void enter_recording(manifest::Document& document, std::size_t image, const std::filesystem::path& path);

// What someone who has only the recordings would write: free parameters of surfaces and lights that have two bounds are
// set to the middle between them.
void forget_free_values(manifest::Document& document);

}  // namespace gonio::render
