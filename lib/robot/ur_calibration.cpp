// See ur_calibration.h. The file: lines `key = [ v, v, ... ]` or `key = v`, sections in brackets, comments behind `#`.
#include "robot/ur_calibration.h"

#include <charconv>
#include <cmath>
#include <map>

#include "base/atomic_file.h"
#include "base/error.h"
#include "manifest/document.h"
#include "manifest/sections/robot.h"

namespace gonio::robot {
namespace {

std::string trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return "";
  return std::string(text.substr(first, text.find_last_not_of(" \t\r") - first + 1));
}

struct Line {
  std::string value, place;
};

std::map<std::string, Line> lines_of(std::string_view text, const std::string& file) {
  std::map<std::string, Line> lines;
  for (int number = 1; !text.empty(); ++number) {
    const auto end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    line = line.substr(0, line.find('#'));
    const auto equals = line.find('=');
    if (equals == std::string_view::npos) continue;
    lines[trimmed(line.substr(0, equals))] = {trimmed(line.substr(equals + 1)), file + ":" + std::to_string(number)};
  }
  return lines;
}

double number(const std::string& text, const std::string& place) {
  double value = 0;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end.ec != std::errc{} || end.ptr != text.data() + text.size() || !std::isfinite(value))
    throw Error(Exit::data, place, "\"" + text + "\" is no finite number");
  return value;
}

std::array<double, 6> six(const std::map<std::string, Line>& lines, const std::string& key, const std::string& file) {
  const auto found = lines.find(key);
  if (found == lines.end())
    throw Error(Exit::data, file, key + " is missing", "give the controller's calibration.conf");
  const auto& [value, place] = found->second;
  if (!value.starts_with('[') || !value.ends_with(']')) throw Error(Exit::data, place, key + " is no list in brackets");
  std::array<double, 6> numbers{};
  std::size_t count = 0;
  std::string_view rest = std::string_view(value).substr(1, value.size() - 2);
  while (true) {
    const auto comma = rest.find(',');
    const double n = number(trimmed(rest.substr(0, comma)), place);
    if (count < 6) numbers[count] = n;
    ++count;
    if (comma == std::string_view::npos) break;
    rest.remove_prefix(comma + 1);
  }
  if (count != 6)
    throw Error(Exit::data, place, key + " has " + std::to_string(count) + " numbers where 6 are expected");
  return numbers;
}

}  // namespace

UrCalibration parse_ur_calibration(std::string_view text, const std::string& file) {
  const std::map<std::string, Line> lines = lines_of(text, file);
  UrCalibration calibration{six(lines, "delta_theta", file), six(lines, "delta_a", file), six(lines, "delta_d", file),
                            six(lines, "delta_alpha", file)};
  if (const auto status = lines.find("calibration_status"); status != lines.end()) {
    calibration.status = static_cast<int>(number(status->second.value, status->second.place));
    if (calibration.status == 0)
      throw Error(Exit::data, status->second.place, "the arm was never calibrated (calibration_status 0)",
                  "leave the calibration out, or take it from the controller's backup");
  }
  return calibration;
}

UrCalibration read_ur_calibration(const std::filesystem::path& path) {
  return parse_ur_calibration(read_file(path), path.filename().string());
}

Arm calibrated(const Arm& nominal, const UrCalibration& calibration, const std::string& place) {
  if (nominal.links.size() != 6)
    throw Error(Exit::data, place, "has " + std::to_string(nominal.links.size()) + " joints, its calibration is for 6");
  Arm arm = nominal;
  for (std::size_t i = 0; i < 6; ++i) {
    arm.links[i].theta_rad += calibration.delta_theta_rad[i];
    arm.links[i].a_m += calibration.delta_a_m[i];
    arm.links[i].d_m += calibration.delta_d_m[i];
    arm.links[i].alpha_rad += calibration.delta_alpha_rad[i];
  }
  arm.source += ", calibration.conf";
  return arm;
}

Arm arm_of(const manifest::Document& document, const std::string& robot) {
  const std::string pointer = "/robots/" + robot, place = manifest::place(document, pointer);
  const auto found = document.robots.find(robot);
  if (found == document.robots.end())
    throw Error(Exit::data, place, "is not described", "give its model, or its rows as dh");
  return arm_of(document, found->second, pointer);
}

Arm arm_of(const manifest::Document& document, const manifest::Robot& section, const std::string& pointer) {
  const std::string place = manifest::place(document, pointer);
  Arm arm;
  if (!section.dh.empty())
    arm = {section.model, section.dh, "the manifest"};
  else if (section.model == "dh")
    throw Error(Exit::data, place, "has the model dh and no rows", "give its rows as dh");
  else
    arm = known_arm(section.model, place + "/model");
  if (section.calibration.empty()) return arm;
  return calibrated(
      arm, read_ur_calibration(manifest::resolve(document, section.calibration, pointer + "/calibration")), place);
}

}  // namespace gonio::robot
