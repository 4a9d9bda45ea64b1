// See pose_list.h.
#include "robot/pose_list.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "base/atomic_file.h"
#include "base/error.h"
#include "robot/pose_lines.h"

namespace gonio::robot {
namespace {

constexpr double rotation_limit = 1e-4, quaternion_limit = 1e-3, farthest_m = 20, smallest_reach_m = 0.02;
constexpr std::size_t many = 5;  // poses from which a missing spread is remarkable

std::string text_of(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", value);
  return text.data();
}

[[noreturn]] void wrong_count(const NumberLine& line, const std::string& wanted) {
  throw Error(Exit::data, line.place,
              std::to_string(line.numbers.size()) + " numbers where " + wanted + " are expected",
              "name the convention that the file has");
}

double determinant(const Mat3& r) {
  return dot({r(0, 0), r(1, 0), r(2, 0)}, cross({r(0, 1), r(1, 1), r(2, 1)}, {r(0, 2), r(1, 2), r(2, 2)}));
}

// The nearest rotation (polar decomposition) by the iteration R <- R (3 I - R'R) / 2, which squares the error each time
// (Bjorck & Bowie 1971).
Quaternion nearest_rotation(Mat3 r, const std::string& place) {
  if (determinant(r) < 0)
    throw Error(Exit::data, place, "the rotation is left-handed (determinant " + text_of(determinant(r)) + ")",
                "one axis is mirrored; export a right-handed frame");
  for (int round = 0; round < 4; ++round) {
    const Mat3 square = transposed(r) * r;
    Mat3 half;
    double worst = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const double unit = i == j ? 1 : 0;
        worst = std::max(worst, std::abs(square(i, j) - unit));
        half(i, j) = 1.5 * unit - 0.5 * square(i, j);
      }
    if (round == 0 && !(worst <= rotation_limit))
      throw Error(Exit::data, place, "the rotation is not orthonormal (|R'R - I| = " + text_of(worst) + ", limit 1e-4)",
                  "export more digits, or name the convention that the file has");
    r = r * half;
  }
  return quaternion_of(r);
}

Rigid<frame::Base, frame::Tool> of_matrix(const std::array<double, 16>& m, double length, const std::string& place) {
  const bool last = m[12] == 0 && m[13] == 0 && m[14] == 0 && std::abs(m[15] - 1) < 1e-9;
  const bool column_major = m[3] == 0 && m[7] == 0 && m[11] == 0 && std::abs(m[15] - 1) < 1e-9;
  if (!last)
    throw Error(Exit::data, place, "the fourth row is not 0 0 0 1",
                column_major ? "the matrix is column-major: write it row by row" : "write [R t; 0 0 0 1] row by row");
  const Mat3 r{{m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]}};
  return {nearest_rotation(r, place), Vec3{m[3], m[7], m[11]} * length};
}

Quaternion of_quaternion(double w, double x, double y, double z, const std::string& place) {
  const double length = std::sqrt(w * w + x * x + y * y + z * z);
  if (!(std::abs(length - 1) <= quaternion_limit))
    throw Error(Exit::data, place, "the quaternion is not of unit length (" + text_of(length) + ", limit 1 +- 1e-3)",
                "name the convention that the file has");
  return normalized({w, x, y, z});
}

void must_be_radians(double angle, double factor, const std::string& place) {
  if (factor == 1 && std::abs(angle) > 2 * pi + 1e-6)
    throw Error(Exit::data, place, "an angle of " + text_of(angle) + " rad is more than a full turn",
                "degrees? then name deg");
}

Quaternion rotation_of(const PoseConvention& c, const std::vector<double>& n, const std::string& place) {
  const Vec3 angles = n.size() >= 6 ? Vec3{n[3], n[4], n[5]} : Vec3{};
  switch (c.rotation) {
    case RotationKind::quaternion_wxyz: return of_quaternion(n[3], n[4], n[5], n[6], place);
    case RotationKind::quaternion_xyzw: return of_quaternion(n[6], n[3], n[4], n[5], place);
    case RotationKind::rotation_vector:
      must_be_radians(norm(angles), c.radians_per_angle, place);
      return quaternion_of_rotation_vector(angles * c.radians_per_angle);
    case RotationKind::euler:
      for (int i = 0; i < 3; ++i) must_be_radians(angles[i], c.radians_per_angle, place);
      return rotation_of_euler(c.axes, c.fixed_axes, angles * c.radians_per_angle);
    case RotationKind::matrix: break;
  }
  throw Error(Exit::internal, place, "a matrix has no columns");
}

bool is_quaternion(const PoseConvention& c) {
  return c.rotation == RotationKind::quaternion_wxyz || c.rotation == RotationKind::quaternion_xyzw;
}

// Joins four lines of four numbers into one of sixteen.
std::vector<NumberLine> matrix_lines(const std::vector<NumberLine>& lines) {
  std::vector<NumberLine> joined;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const NumberLine& line = lines[i];
    if (line.numbers.size() == 16) {
      joined.push_back(line);
      continue;
    }
    if (line.numbers.size() != 4) wrong_count(line, "16 (or four lines of 4)");
    joined.push_back(line);
    for (std::size_t k = i + 1; k < i + 4; ++k) {
      if (k >= lines.size())
        throw Error(Exit::data, line.place, "the matrix that begins here has fewer than four rows");
      if (lines[k].numbers.size() != 4) wrong_count(lines[k], "4");
      joined.back().numbers.insert(joined.back().numbers.end(), lines[k].numbers.begin(), lines[k].numbers.end());
    }
    i += 3;
  }
  return joined;
}

// A block's label may state a unit of length: that of the convention, or --pose-length.
void check_length(const NumberLine& line, const PoseConvention& c) {
  const double stated = line.length == "mm" ? 1e-3 : line.length == "cm" ? 1e-2 : 1;
  if (!line.length.empty() && std::abs(stated / c.metres_per_length - 1) > 1e-9)
    throw Error(Exit::data, line.place, "its translation is stated in " + line.length + ", and another unit is asked for",
                "name that unit: --pose-length " + line.length);
}

ListedPose pose_of(const NumberLine& line, const PoseListFormat& format) {
  const PoseConvention& c = format.convention;
  check_length(line, c);
  ListedPose listed{{}, line.place, line.name};
  Rigid<frame::Base, frame::Tool>& pose = listed.base_from_tool;
  if (c.rotation == RotationKind::matrix) {
    std::array<double, 16> m{};
    std::copy_n(line.numbers.begin(), 16, m.begin());
    pose = of_matrix(m, c.metres_per_length, line.place);
  } else {
    if (line.numbers.size() != (is_quaternion(c) ? 7u : 6u))
      wrong_count(line, std::string(is_quaternion(c) ? "7" : "6") + " (" + c.columns + ")");
    pose.rotation = rotation_of(c, line.numbers, line.place);
    pose.translation_m = Vec3{line.numbers[0], line.numbers[1], line.numbers[2]} * c.metres_per_length;
  }
  if (!(norm(pose.translation_m) <= farthest_m))
    throw Error(Exit::data, line.place,
                "the tool is " + text_of(norm(pose.translation_m)) + " m from the base (limit 20 m)",
                c.metres_per_length == 1 ? "millimetres? then name mm" : "name the unit that the file has");
  if (format.direction == PoseDirection::tool_from_base) {
    const auto turned = inverse(pose);
    pose = {turned.rotation, turned.translation_m};
  }
  return listed;
}

// What is possible, but odd. `angles`: those of all lines, in the file's unit.
std::vector<std::string> remarks(const PoseList& list, const PoseConvention& c, const std::vector<double>& angles) {
  std::vector<std::string> warnings;
  if (list.poses.size() < many) return warnings;
  double farthest = 0;
  for (const ListedPose& p : list.poses) farthest = std::max(farthest, norm(p.base_from_tool.translation_m));
  if (c.metres_per_length < 1 && farthest < smallest_reach_m)
    warnings.push_back("all poses lie within " + text_of(farthest * 1e3) +
                       " mm of the base: metres read as millimetres?");
  const double largest = angles.empty() ? 0 : *std::ranges::max_element(angles);
  if (c.radians_per_angle != 1 && !angles.empty() && largest <= 2 * pi)
    warnings.push_back("no angle exceeds " + text_of(largest) + " degrees: radians read as degrees?");
  return warnings;
}

PoseList poses_of(const std::vector<NumberLine>& lines, const PoseListFormat& format, const std::string& file) {
  PoseList list;
  std::vector<double> angles;
  const bool matrices = format.convention.rotation == RotationKind::matrix;
  for (const NumberLine& line : matrices ? matrix_lines(lines) : lines) {
    list.poses.push_back(pose_of(line, format));
    if (matrices || is_quaternion(format.convention)) continue;
    for (std::size_t i = 3; i < 6; ++i) angles.push_back(std::abs(line.numbers[i]));
  }
  if (list.poses.empty()) throw Error(Exit::data, file, "no pose in it");
  list.warnings = remarks(list, format.convention, angles);
  return list;
}

}  // namespace

PoseList parse_pose_list(std::string_view text, const std::string& file, const PoseListFormat& format) {
  return poses_of(pose_lines(text, file), format, file);
}

PoseList read_pose_list(const std::filesystem::path& path, const PoseListFormat& format) {
  return parse_pose_list(read_file(path), path.string(), format);
}

PoseList read_pose_files(std::span<const std::filesystem::path> paths, const PoseListFormat& format) {
  PoseList all;
  for (const std::filesystem::path& path : paths) {
    PoseList one = read_pose_list(path, format);
    if (one.poses.size() != 1)
      throw Error(Exit::data, path.string(), std::to_string(one.poses.size()) + " poses where one is expected");
    one.poses[0].name = path.stem().string();
    all.poses.push_back(std::move(one.poses[0]));
  }
  return all;
}

}  // namespace gonio::robot
