// Camera sections to numbers and back, with the checks that make every later division safe.
#include "camera/intrinsics.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace gonio::camera {
namespace {

constexpr std::array models = {
    CameraModelInfo{"pinhole", 0, true, "A central projection without lens errors."},
    CameraModelInfo{"radial-tangential", 5, true, "Brown's lens: k1 k2 k3 radial, p1 p2 tangential (decentring)."},
    CameraModelInfo{"thin-prism", 9, true, "radial-tangential with the thin-prism terms s1 s2 s3 s4."},
    CameraModelInfo{"orthographic", 0, false, "Parallel rays along +z; px_per_m pixels per metre."},
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

std::span<const CameraModelInfo> camera_models() {
  return models;
}

const CameraModelInfo& camera_model_info(const std::string& name, const std::string& place) {
  const auto found = std::ranges::find(models, std::string_view(name), &CameraModelInfo::name);
  if (found != models.end()) return *found;
  throw Error(Exit::data, place + "/model", "\"" + name + "\" is no camera model",
              "use pinhole, radial-tangential, thin-prism or orthographic");
}

std::size_t distortion_index(const std::string& name, const std::string& place) {
  const auto found = std::ranges::find(distortion_names, std::string_view(name));
  if (found != distortion_names.end()) return static_cast<std::size_t>(found - distortion_names.begin());
  throw Error(Exit::data, place, "\"" + name + "\" is no distortion term", "use k1 k2 p1 p2 k3 s1 s2 s3 s4");
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
  for (const auto& [name, parameter] : camera.distortion) {
    const std::string here = place + "/distortion/" + name;
    const std::size_t index = distortion_index(name, here);
    const double v = required(parameter, here);
    if (index >= model.terms && v != 0) {
      throw Error(Exit::data, here, "model " + camera.model + " has no term " + name,
                  "use radial-tangential (k1 k2 p1 p2 k3) or thin-prism (s1 s2 s3 s4 on top)");
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
  const std::size_t terms = camera_model_info(camera.model, "cameras").terms;
  for (std::size_t i = 0; i < terms; ++i) {
    camera.distortion[std::string(distortion_names[i])] = intrinsics.distortion[i];
  }
}

}  // namespace gonio::camera
