// The page calibration.html: the verdict, the camera's numbers, where it predicts well, whether halves agree,
// residuals, views, and what to photograph next. And the files beside it: maps as EXR, pictures as PNG.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "camera/quality/quality.h"
#include "manifest/sections/forward.h"

namespace gonio::tools::calib_charuco {

std::string calibration_page(const camera::CameraResult& camera, const camera::Quality& quality);

// Writes the maps, the coverage and the page to `path_of(NAME)` and enters them in the document's files and the
// camera's quality. `suffix` keeps several cameras apart ("-left").
void write_quality(const camera::CameraResult& camera, const camera::Quality& quality,
                   const std::function<std::filesystem::path(const std::string&)>& path_of, const std::string& suffix,
                   manifest::Document& document);

// Arrows over an image, as an inline drawing: lengths in pixels times `scale`. NaN: none.
std::string arrows(int width_px, int height_px, const std::vector<Vec2>& at, const std::vector<Vec2>& arrow_px,
                   double scale);
// One, two or five times a power of ten that draws the typical (95th percentile) arrow a twentieth of the image long.
double arrow_scale(int width_px, const std::vector<Vec2>& arrow_px);

}  // namespace gonio::tools::calib_charuco
