// See laboratories.h. Where arms stand was searched for: places from which most of a hemisphere of 0.4 m is reached.
#include "acquisition/laboratories.h"

#include <cmath>

#include "base/text.h"
#include "geom/rigid.h"

namespace gonio::tests {
namespace {

// A pose that turns about z by `yaw` and stands at a point.
std::string standing(const char* key, double x, double y, double z, double yaw = 0) {
  return format(R"("%s": {"rotation": [%.17g, 0, 0, %.17g], "translation_m": [%g, %g, %g]})", key, std::cos(yaw / 2),
                std::sin(yaw / 2), x, y, z);
}

std::string box(const char* name, double x, double y, double z, double sx, double sy, double sz,
                const char* key = "world_from_body") {
  return format(R"({"name": "%s", "box_m": [%g, %g, %g], )", name, sx, sy, sz) + standing(key, x, y, z) + "}";
}

std::string cylinder(const char* name, double x, double y, double z, double radius, double length,
                     const char* key = "world_from_body") {
  return format(R"({"name": "%s", "cylinder_m": [%g, %g], )", name, radius, length) + standing(key, x, y, z) + "}";
}

// Optics on a flange: a body of 6 x 6 x 9 cm that begins at the flange, its lens looking along the tool's z.
std::string camera_body(double x = 0) {
  return box("camera", x, 0, 0.046, 0.06, 0.06, 0.09, "tool_from_body");
}

std::string held_camera(const char* arm, double x = 0) {
  return format(R"({"url": "sim://", "robot": "%s", )", arm) + standing("tool_from_camera", x, 0, 0.1) + "}";
}

const char* cable() {
  return R"("cable": {"free_rad": [0, -1.5708, 0, -1.5708, 0, 0], "slack_rad": [3.5, 2.8, 2.8, 3.5, 4.5, 4.5]})";
}

std::string arc_lamps(std::string& obstacles) {
  std::string lamps;
  for (int i = 1; i <= 11; ++i) {
    const double angle = i * pi / 12, y = std::cos(angle), z = std::sin(angle);
    lamps += format(R"(%s"lamp-%d": {"url": "sim://", "in_world_m": [-0.35, %.4f, %.4f], "settle_s": 0.05})",
                    i > 1 ? ", " : "", i, y, z);
    obstacles += ", " + format(R"({"name": "lamp-%d", "ball_m": 0.05, )", i) +
                 standing("world_from_body", -0.35, 1.05 * y, 1.05 * z) + "}";
  }
  return lamps;
}

}  // namespace

std::string two_ur5_text() {
  return R"({"gonio": 1, "laboratory": {"robots": {
    "camera-arm": {"url": "sim://", "model": "ur5", )" +
         std::string(cable()) + ", " + standing("world_from_base", 0.38, 0, 0.1, pi) + R"(,
      "home_rad": [0, -1.9, 1.9, -1.6, -1.5708, 0], "carries": [)" +
         camera_body() + R"(]},
    "light-arm": {"url": "sim://", "model": "ur5", )" +
         cable() + ", " + standing("world_from_base", -0.42, 0, 0.1) + R"(,
      "home_rad": [0, -1.9, 1.9, -1.6, -1.5708, 0],
      "carries": [)" +
         cylinder("led", 0, 0, 0.026, 0.02, 0.05, "tool_from_body") + R"(]}},
    "cameras": {"eye": )" +
         held_camera("camera-arm") + R"(},
    "lamps": {"led": {"url": "sim://", "robot": "light-arm", "in_tool_m": [0, 0, 0.052], "settle_s": 0.02}},
    "obstacles": [)" +
         cylinder("pedestal", 0, 0, -0.165, 0.06, 0.17) + ", " + cylinder("object", 0, 0, -0.03, 0.05, 0.1) + ", " +
         cylinder("camera-column", 0.38, 0, -0.085, 0.08, 0.33) + ", " +
         cylinder("light-column", -0.42, 0, -0.085, 0.08, 0.33) + ", " + box("table", 0, 0, -0.275, 1.8, 1.2, 0.05) +
         R"(],
    "limits": {"speed_m_per_s": 0.5, "lower_m": [-1.2, -1.2, -0.25], "upper_m": [1.2, 1.2, 1.3], "margin_m": 0.01}}})";
}

std::string abb_and_arc_text() {
  std::string obstacles =
      cylinder("pedestal", 0, 0, -0.42, 0.15, 0.74) + ", " + cylinder("sample", 0, 0, -0.025, 0.05, 0.05);
  const std::string lamps = arc_lamps(obstacles);
  return R"({"gonio": 1, "laboratory": {"robots": {
    "arm": {"url": "sim://", "model": "abb-irb-1600", )" +
         standing("world_from_base", 0.85, 0, -0.4, pi) + R"(,
      "home_rad": [0, -0.3, 0.2, 0, 1.2, 0],
      "carries": [)" +
         box("scanner", 0, 0, 0.056, 0.3, 0.1, 0.1, "tool_from_body") + R"(]}},
    "cameras": {"left": )" +
         held_camera("arm", -0.12) + R"(, "right": )" + held_camera("arm", 0.12) + R"(},
    "lamps": {)" +
         lamps + R"(},
    "obstacles": [)" +
         obstacles + ", " + box("plinth", 0.85, 0, -0.61, 0.6, 0.45, 0.38) + ", " +
         box("floor", 0, 0, -0.83, 4, 3, 0.05) + R"(],
    "limits": {"speed_m_per_s": 0.5, "margin_m": 0.01}}})";
}

std::string ur3_and_turntable_text() {
  return R"({"gonio": 1, "laboratory": {"robots": {
    "arm": {"url": "sim://", "model": "ur3", )" +
         standing("world_from_base", 0.27, 0, 0.05, pi) + R"(,
      "home_rad": [0, -1.9, 1.9, -1.6, -1.5708, 0], "carries": [)" +
         camera_body() + R"(]}},
    "cameras": {"moving": )" +
         held_camera("arm") + R"(,
      "standing": {"url": "sim://", "world_from_camera": {"rotation": [0, 0.70710678118654757, 0.70710678118654757, 0],
        "translation_m": [0, -0.02, 0.9]}}},
    "turntables": {"turntable": {"url": "sim://", )" +
         standing("world_from_table", 0, 0, -0.05) + R"(,
      "speed_rad_per_s": 0.5, "acceleration_rad_per_s2": 1}},
    "screens": {"lcd": {"url": "sim://", "kind": "lcd", "width_px": 1920, "height_px": 1080, "pixel_m": 0.000311,
      "world_from_screen": {"rotation": [0.5, 0.5, 0.5, 0.5], "translation_m": [-0.48, 0, 0.2]}}},
    "obstacles": [)" +
         cylinder("turntable", 0, 0, -0.1, 0.1, 0.1) + ", " + cylinder("object", 0, 0, -0.01, 0.03, 0.06) + ", " +
         box("lcd", -0.52, 0, 0.2, 0.06, 0.62, 0.36) + ", " + box("table", 0, 0, -0.175, 1.6, 1.2, 0.05) + R"(],
    "limits": {"speed_m_per_s": 0.25, "margin_m": 0.008}}})";
}

manifest::Document laboratory_document(const std::string& text) {
  return manifest::parse_document(text, "laboratory.json", ".");
}

}  // namespace gonio::tests
