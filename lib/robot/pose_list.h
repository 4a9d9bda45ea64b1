// Lists of tool poses and joint angles as robots' controllers write them. A list is read by the NAME of its convention,
// never by guess: six numbers may be a rotation vector, roll-pitch-yaw or A-B-C, and a wrong guess looks plausible.
//
// Text files, one pose per line (matrices: also four lines of four numbers, or one file per pose). Separators: comma,
// semicolon, space, tab; brackets as in `p[...]` are passed over; `#`, `%` and `//` begin comments; one header line is
// tolerated; a first field that is no number is the pose's name. Or blocks of numbers under labels, "Rotation:" and
// "Translation:", for every pose (pose_lines.h). Decimal commas are refused. Results: base_from_tool, metres, unit
// quaternions.
//
// Rounding is repaired up to stated limits (rotation matrices: largest entry of |R'R - I| <= 1e-4, by polar
// decomposition; quaternions: | |q| - 1 | <= 1e-3, divided by their length). Beyond them, left-handed rotations,
// numbers that are not finite, radians that must be degrees and metres that must be millimetres are Error(data) at
// file:line. What is merely odd is a warning. It does not say which image belongs to which pose.
#pragma once
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geom/rigid.h"

namespace gonio::robot {

enum class RotationKind { matrix, rotation_vector, quaternion_wxyz, quaternion_xyzw, euler };

struct PoseConvention {
  std::string name;     // "ur"
  std::string columns;  // "x y z rx ry rz"
  std::string meaning;  // one sentence, with the equation of the rotation
  RotationKind rotation = RotationKind::matrix;
  std::string axes;         // euler: axes in the order of the columns
  bool fixed_axes = false;  // euler: about the base's axes, R = R3 R2 R1; otherwise about the turned axes, R = R1 R2 R3
  double metres_per_length = 1;
  double radians_per_angle = 1;  // 0: the convention has no unit of its own, it must be named
};

// The named ones: matrix, quaternion-wxyz, quaternion-xyzw, rotation-vector, rpy, ur, abb, abb-euler, kuka, fanuc,
// staubli.
std::span<const PoseConvention> pose_conventions();
// One of them, or `euler-ABC` (turned axes) and `fixed-ABC` (fixed axes) for any order ABC of x, y, z without a direct
// repetition. Error(usage) at `place` that lists the names.
PoseConvention pose_convention(const std::string& name, const std::string& place);

enum class PoseDirection { base_from_tool, tool_from_base };  // what the file holds

struct PoseListFormat {
  PoseConvention convention;
  PoseDirection direction = PoseDirection::base_from_tool;
};
// All by name: convention; length "m" | "cm" | "mm" and angle "rad" | "deg" (empty: the convention's own); direction
// "base_from_tool" | "tool_from_base". Error(usage) at `place`.
PoseListFormat pose_list_format(const std::string& convention, const std::string& length, const std::string& angle,
                                const std::string& direction, const std::string& place);

struct ListedPose {
  Rigid<frame::Base, frame::Tool> base_from_tool;
  std::string place;  // "poses.txt:12", for messages
  std::string name;   // first field of the line where it is no number; of a file of its own: its stem
};
struct PoseList {
  std::vector<ListedPose> poses;
  std::vector<std::string> warnings;  // whole sentences, without the file's name
};

PoseList read_pose_list(const std::filesystem::path& path, const PoseListFormat& format);
PoseList read_pose_files(std::span<const std::filesystem::path> paths,
                         const PoseListFormat& format);  // one pose in each
PoseList parse_pose_list(std::string_view text, const std::string& file, const PoseListFormat& format);

// Rotation about axes 'x', 'y', 'z' by angles in rad, in the order of the columns.
Quaternion rotation_of_euler(const std::string& axes, bool fixed_axes, Vec3 angles_rad);

}  // namespace gonio::robot
