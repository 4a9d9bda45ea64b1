// "laboratory": the instrument as its owner believes it to be: arms, cameras, lamps, turntables and screens, each with
// the URL that reaches it, and what stands around. What is believed is what plans and runs are made with; what is true
// shows in the pictures. Lengths m, angles rad, times s, masses kg.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "geom/dh_row.h"
#include "manifest/pose.h"

namespace gonio::manifest {

// A solid that nothing may touch: a box, a ball, a cylinder or a mesh with all that it encloses. Its frame: the middle
// of a box, ball or cylinder (whose axis is z), the file's own frame of a mesh. It stands in the world, is fixed to a
// robot's tool, or to one of its links: then it is given in base coordinates while all joints are at zero, because the
// frames of Denavit and Hartenberg are not where anybody would look for them.
struct SolidBody {
  std::string name{};
  std::vector<double> box_m{};       // full sides [x, y, z]
  std::optional<double> ball_m{};    // radius
  std::vector<double> cylinder_m{};  // [radius, length]
  std::string mesh{};                // file id: PLY or STL
  std::optional<Pose<frame::World, frame::Object>> world_from_body{};
  std::optional<Pose<frame::Tool, frame::Object>> tool_from_body{};
  std::optional<Pose<frame::Base, frame::Object>> base_from_body{};
};

struct JointLimits {  // one number a joint; left out: the model's
  std::vector<double> lower_rad{}, upper_rad{}, speed_rad_per_s{}, acceleration_rad_per_s2{};
};

// A cable that runs along an arm: how far each joint may turn to either side of where it hangs free.
struct CableSlack {
  std::vector<double> free_rad{}, slack_rad{};
};

struct LaboratoryRobot {
  std::string url{};    // "modbus://192.168.0.10:502", "sim://"
  std::string model{};  // a known arm (robot/kinematics.h), "dh" with `dh`, or "urdf" with `urdf`
  std::vector<DhRow> dh{};
  std::string urdf{};         // file id
  std::string calibration{};  // file id of a UR controller's calibration.conf
  std::string registers{};    // file id: the register map of a controller that is not a UR
  std::optional<Pose<frame::World, frame::Base>> world_from_base{};
  std::optional<JointLimits> limits{};
  std::optional<CableSlack> cable{};
  std::optional<double> payload_kg{};
  std::vector<double> payload_centre_m{};  // in the tool's frame
  std::vector<double> home_rad{};          // where a run begins and ends
  std::vector<SolidBody> carries{};        // fixed to its tool
  std::vector<SolidBody> links{};  // solids of its links instead of the model's: "link-0", "link-1", "link-1-motor"
};

struct LaboratoryCamera {
  std::string url{};    // "genicam://192.168.0.20", "folder:///data/in", "sim://"
  std::string robot{};  // that holds it; empty: it stands
  std::optional<Pose<frame::Tool, frame::Camera>> tool_from_camera{};
  std::optional<Pose<frame::World, frame::Camera>> world_from_camera{};
  std::string pixel_format{};        // "Mono8", "BayerRG12Packed", "BayerRGPolarized..." as GenICam names them
  std::vector<double> exposure_s{};  // [shortest, longest] that it can
  std::optional<double> gain_db{};
  std::string trigger{};                                         // "software" | "hardware"
  std::optional<double> codes_per_radiance_s{};                  // of a linear camera: codes for 1 W/(m^2 sr) in 1 s
  std::optional<double> white{};                                 // code at which a pixel is saturated
  std::optional<double> black_code{};                            // mean code without light; left out: 0
  std::optional<double> electrons_per_code{}, read_electrons{};  // its noise, as EMVA 1288 measures it
  std::vector<double>
      filters{};  // simulated, in colour: 3 x 3, row-major: what its r, g, b read of the scene's R, G, B
};

struct LaboratoryLamp {
  std::string url{};    // "modbus://host:502/coil/3"
  std::string robot{};  // that holds it; empty: it stands
  std::string light{};  // name in lights; empty: its own name
  std::vector<double> in_tool_m{}, in_world_m{};
  std::optional<double> settle_s{};  // from switching to a steady light
};

struct LaboratoryTurntable {
  std::string url{};
  std::optional<Pose<frame::World, frame::Object>> world_from_table{};  // at angle 0; turns about its z
  std::vector<double> range_rad{};                                      // [lower, upper]; empty: turns on and on
  std::optional<double> speed_rad_per_s{}, acceleration_rad_per_s2{};
  std::vector<std::string> carries{};  // objects
  // Objects that it deforms: while it turns once, their meshes go through their shapes. One that carries nothing is a
  // drive: nothing else turns with it.
  std::vector<std::string> deforms{};
};

struct LaboratoryScreen {
  std::string url{};
  std::string kind{};  // "lcd" | "projector"
  std::int64_t width_px = 0, height_px = 0;
  std::optional<double> pixel_m{};  // lcd
  std::optional<Pose<frame::World, frame::Object>> world_from_screen{};
  std::optional<double> settle_s{};
};

struct LaboratoryLimits {
  std::optional<double> speed_m_per_s{};        // of any tool
  std::vector<double> lower_m{}, upper_m{};     // box in the world that no tool leaves
  std::optional<double> margin_m{};             // between any two solids; left out: 0.01
  std::optional<double> smallest_singular_m{};  // metres per radian (robot/inverse); left out: 0.01
};

struct Laboratory {
  std::map<std::string, LaboratoryRobot> robots{};
  std::map<std::string, LaboratoryCamera> cameras{};  // their lenses stand in cameras
  std::map<std::string, LaboratoryLamp> lamps{};
  std::map<std::string, LaboratoryTurntable> turntables{};
  std::map<std::string, LaboratoryScreen> screens{};
  std::vector<SolidBody> obstacles{};
  std::optional<LaboratoryLimits> limits{};
};

}  // namespace gonio::manifest
