// What was done to pictures, as their images in the manifest say it (manifest/sections/developed.h).
#pragma once
#include <cstddef>
#include <string>

#include "manifest/sections/forward.h"

namespace gonio::photograph {

// The steps in order: "black, merge, demosaic by bilinear".
std::string words_of_steps(const manifest::ImageEntry& image);

// Error(data) where the step (a name of develop_step) has been applied to the picture of this image, whether the image
// itself says so or another one with the same file. `problem`: what is wrong with it then, "has no distortion any
// more".
void refuse_second(const manifest::Document& document, std::size_t image, const std::string& step,
                   const std::string& problem, const std::string& remedy);

// Error(data) where anything has been done to it.
void refuse_developed(const manifest::Document& document, std::size_t image, const std::string& remedy);

}  // namespace gonio::photograph
