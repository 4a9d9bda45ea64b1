// Built-in laboratories, one file each: specimen_<name>.cpp. All their devices are simulated; what their arms do can be
// planned, carried out and calibrated without any instrument.
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "manifest/sections/forward.h"
#include "manifest/sections/laboratory.h"

namespace gonio::acquisition {

struct SpecimenLaboratory {
  std::string name, sentence;
  // Writes what the scene needs, a board's drawing or a mesh, into `out`.
  manifest::Document (*make)(const std::filesystem::path& out);
};
std::span<const SpecimenLaboratory> specimen_laboratories();
// Error(usage) that lists the names there are.
manifest::Document specimen_laboratory(const std::string& name, const std::filesystem::path& out);

// The parts that they are built from; world coordinates, metres.
manifest::SolidBody box_body(const char* name, std::vector<double> sides_m, Vec3 middle_m);
manifest::SolidBody ball_body(const char* name, double radius_m, Vec3 middle_m);
// An arm of a known model on sim://, its base turned by `turn_rad` about the vertical.
manifest::LaboratoryRobot simulated_arm(const char* model, Vec3 base_m, double turn_rad, std::vector<double> home_rad);
// 12 bits, saturated by a radiance of 1 W/(m^2 sr) in `full_s`.
manifest::LaboratoryCamera simulated_camera(double full_s);
// A camera's housing on a flange, its lens along z, `above_m` over the flange.
void give_housing(manifest::LaboratoryRobot& robot, const char* name, std::vector<double> sides_m, double above_m = 0);

manifest::Document specimen_desk(const std::filesystem::path& out);
manifest::Document specimen_arc(const std::filesystem::path& out);
manifest::Document specimen_scanner(const std::filesystem::path& out);
manifest::Document specimen_stage(const std::filesystem::path& out);
manifest::Document specimen_studio(const std::filesystem::path& out);
manifest::Document specimen_turntable(const std::filesystem::path& out);

}  // namespace gonio::acquisition
