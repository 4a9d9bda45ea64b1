// The numbers of a camera that a fit moves, and the models that say which of the lens terms exist.
#pragma once
#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "camera/lens_terms.h"
#include "manifest/sections/forward.h"

namespace gonio::camera {

struct Intrinsics {  // of a perspective or fisheye camera; pixels, pixel centres at integers
  double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
  std::array<double, distortion_terms> distortion{};  // in the order of distortion_names
  bool operator==(const Intrinsics&) const = default;
};

// A set of places in distortion_names.
class TermSet {
 public:
  constexpr TermSet() = default;
  constexpr TermSet(std::initializer_list<std::size_t> terms) {
    for (const std::size_t t : terms) has_[t] = true;
  }
  constexpr bool has(std::size_t term) const { return has_[term]; }
  constexpr void add(std::size_t term) { has_[term] = true; }
  constexpr bool includes(const TermSet& other) const {
    for (std::size_t t = 0; t < distortion_terms; ++t) {
      if (other.has_[t] && !has_[t]) return false;
    }
    return true;
  }

 private:
  std::array<bool, distortion_terms> has_{};
};

// A model may have other terms than those it is calibrated with: a manifest may give a thin prism k4, and a fisheye
// decentring. orthographic stands apart: it has px_per_m instead of focal lengths, and no lens.
struct CameraModelInfo {
  std::string_view name;
  TermSet terms;     // that a camera section may give
  TermSet fitted;    // that calibration frees
  double fisheye;    // the term's value where the section does not give it
  bool perspective;  // has focal lengths
  std::string_view sentence;
};
const CameraModelInfo& camera_model_info(const std::string& name, const std::string& place);  // Error(data) for others
std::size_t distortion_index(const std::string& name, const std::string& place);              // Error(data) for others

// Models that a board can calibrate, simplest first.
std::vector<std::string> calibrated_models();

// `model` where it has all `terms`, else the simplest model that has these and all of `model`'s fitted ones.
std::string model_with(const std::string& model, const TermSet& terms);

// Error(data) at `place`, the camera's own (".../cameras/c"), for missing or impossible values and for distortion terms
// that the model lacks (unless they are zero).
Intrinsics intrinsics_of(const manifest::Camera& camera, const std::string& place);
// Values only: fx_px .. cy_px, and of the distortion what the model is calibrated with or what is not at its preset.
void store(const Intrinsics& intrinsics, manifest::Camera& camera);

// A new camera `name` in the document: a pinhole whose principal point is the picture's middle.
void enter_pinhole(manifest::Document& document, const std::string& name, int width_px, int height_px, double focal_px);

// The filters over the pixels of the camera `name`, as its section says; none where the document has no such camera.
std::string mosaic_of(const manifest::Document& document, const std::string& name);
// Its columns and rows; zero where the document has no such camera or does not say.
std::array<int, 2> picture_size_px(const manifest::Document& document, const std::string& name);

}  // namespace gonio::camera
