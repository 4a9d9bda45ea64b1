// Camera sections to numbers and back, with the checks that make every later division safe.
#include "camera/intrinsics.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"

namespace gonio::camera {
namespace {

using L = LensTerm;

constexpr TermSet brown{L::k1, L::k2, L::p1, L::p2, L::k3};
constexpr TermSet rational{L::k1, L::k2, L::p1, L::p2, L::k3, L::k4, L::k5, L::k6};
constexpr TermSet prism{L::k1, L::k2, L::p1, L::p2, L::k3, L::s1, L::s2, L::s3, L::s4};
constexpr TermSet opencv{L::k1, L::k2, L::p1, L::p2, L::k3, L::k4, L::k5, L::k6, L::s1, L::s2, L::s3, L::s4};
constexpr TermSet kannala{L::k1, L::k2, L::k3, L::k4};
constexpr TermSet every{L::k1, L::k2, L::p1, L::p2, L::k3, L::k4, L::k5, L::k6, L::s1, L::s2, L::s3, L::s4, L::fisheye};

// Simplest first.
constexpr std::array models = {
    CameraModelInfo{"pinhole", {}, {}, 0, true, "A central projection without lens errors."},
    CameraModelInfo{"radial-tangential", brown, brown, 0, true,
                    "Brown's lens: k1 k2 k3 radial, p1 p2 tangential (decentring)."},
    CameraModelInfo{"rational", rational, rational, 0, true,
                    "radial-tangential over a denominator with k4 k5 k6, for wide lenses."},
    CameraModelInfo{"thin-prism", opencv, prism, 0, true, "radial-tangential with the thin-prism terms s1 s2 s3 s4."},
    CameraModelInfo{"fisheye", every, kannala, 1, true,
                    "Kannala and Brandt's lens: k1 k2 k3 k4 on the angle from the axis, up to and beyond 90 degrees."},
    CameraModelInfo{"orthographic", {}, {}, 0, false, "Parallel rays along +z; px_per_m pixels per metre."},
};

std::string number(double v) {
  std::string text = std::to_string(v);
  return text.find('.') == std::string::npos ? text : text.substr(0, text.find_last_not_of('0') + 1);
}

double required(const manifest::Parameter& parameter, const std::string& place) {
  if (!parameter.given()) throw Error(Exit::data, place, "missing", "give it, or calibrate the camera first");
  const double v = parameter.scalar();
  if (!std::isfinite(v)) throw Error(Exit::data, place, "not finite");
  return v;
}

double positive(const manifest::Parameter& parameter, const std::string& place) {
  const double v = required(parameter, place);
  if (v <= 0) throw Error(Exit::data, place, number(v) + " is not above 0", "focal lengths are positive pixels");
  return v;
}

}  // namespace

const CameraModelInfo& camera_model_info(const std::string& name, const std::string& place) {
  const auto found = std::ranges::find(models, std::string_view(name), &CameraModelInfo::name);
  if (found != models.end()) return *found;
  throw Error(Exit::data, place + "/model", "\"" + name + "\" is no camera model",
              "use pinhole, radial-tangential, rational, thin-prism, fisheye or orthographic");
}

std::size_t distortion_index(const std::string& name, const std::string& place) {
  const auto found = std::ranges::find(distortion_names, std::string_view(name));
  if (found != distortion_names.end()) return static_cast<std::size_t>(found - distortion_names.begin());
  throw Error(Exit::data, place, "\"" + name + "\" is no distortion term",
              "use k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4 fisheye");
}

std::vector<std::string> calibrated_models() {
  std::vector<std::string> names;
  for (const CameraModelInfo& model : models) {
    if (model.perspective) names.emplace_back(model.name);
  }
  return names;
}

std::string model_with(const std::string& name, const TermSet& terms) {
  const CameraModelInfo& present = camera_model_info(name, "cameras");
  if (!present.perspective || present.terms.includes(terms)) return name;
  for (const CameraModelInfo& model : models) {
    if (model.terms.includes(terms) && model.terms.includes(present.fitted)) return std::string(model.name);
  }
  return "fisheye";
}

Intrinsics intrinsics_of(const manifest::Camera& camera, const std::string& place) {
  const CameraModelInfo& model = camera_model_info(camera.model, place);
  if (!model.perspective) {
    throw Error(Exit::data, place + "/model", "\"" + camera.model + "\" has no focal length",
                "use a perspective model");
  }
  Intrinsics result{.fx_px = positive(camera.fx_px, place + "/fx_px"),
                    .fy_px = positive(camera.fy_px, place + "/fy_px"),
                    .cx_px = required(camera.cx_px, place + "/cx_px"),
                    .cy_px = required(camera.cy_px, place + "/cy_px")};
  result.distortion[L::fisheye] = model.fisheye;
  for (const auto& [name, parameter] : camera.distortion) {
    const std::string here = place + "/distortion/" + name;
    const std::size_t index = distortion_index(name, here);
    const double v = required(parameter, here);
    if (!model.terms.has(index) && v != 0) {
      throw Error(Exit::data, here, "model " + camera.model + " has no term " + name,
                  "use " + model_with(camera.model, {index}));
    }
    if (index == L::fisheye && !(v >= 0 && v <= 1)) {
      throw Error(Exit::data, here, number(v) + " is not within 0 and 1", "0 is perspective, 1 equidistant");
    }
    result.distortion[index] = v;
  }
  return result;
}

void store(const Intrinsics& intrinsics, manifest::Camera& camera) {
  camera.fx_px = intrinsics.fx_px;
  camera.fy_px = intrinsics.fy_px;
  camera.cx_px = intrinsics.cx_px;
  camera.cy_px = intrinsics.cy_px;
  camera.distortion.clear();
  const CameraModelInfo& model = camera_model_info(camera.model, "cameras");
  for (std::size_t i = 0; i < distortion_terms; ++i) {
    const double v = intrinsics.distortion[i], preset = i == L::fisheye ? model.fisheye : 0;
    if (model.fitted.has(i) || (model.terms.has(i) && v != preset)) {
      camera.distortion[std::string(distortion_names[i])] = v;
    }
  }
}

void enter_pinhole(manifest::Document& document, const std::string& name, int width_px, int height_px,
                   double focal_px) {
  manifest::Camera& camera = document.cameras[name];
  camera.width_px = width_px;
  camera.height_px = height_px;
  camera.fx_px = camera.fy_px = focal_px;
  camera.cx_px = (width_px - 1) / 2.0;
  camera.cy_px = (height_px - 1) / 2.0;
}

std::string mosaic_of(const manifest::Document& document, const std::string& name) {
  const manifest::Camera* camera = find_camera(document, name);
  return camera == nullptr ? "" : camera->mosaic;
}

std::array<int, 2> picture_size_px(const manifest::Document& document, const std::string& name) {
  const manifest::Camera* camera = find_camera(document, name);
  return camera == nullptr ? std::array{0, 0} : std::array{camera->width_px, camera->height_px};
}

}  // namespace gonio::camera
