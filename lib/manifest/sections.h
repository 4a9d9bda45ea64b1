// The sections of the manifest as C++ structs. Their field tables (sections.cpp, one line a field: JSON name, member,
// unit, range, sentence) yield reading, validation, writing, schemas/*.schema.json and gonio-manifest(5).
//
// Frames: `world_from_camera` takes camera coordinates to world coordinates; camera axes x right, y down, z forward.
// Units stand in the names. Pixel centres lie at integers. gonio-conventions(7) has it in full.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "geom/rigid.h"
#include "manifest/goniometry_sections.h"
#include "manifest/nrsfm_sections.h"
#include "manifest/parameter.h"
#include "manifest/relief_sections.h"
#include "manifest/value.h"

namespace gonio::manifest {

struct File {        // "files"
  std::string path;  // relative to the manifest's folder
  std::optional<std::uint64_t> bytes;
  std::string sha256;
};
struct Link {  // "frames": a rigid motion between two named frames
  std::string to, from;
  Quaternion rotation;
  Vec3 translation_m;
  std::optional<PoseSigma> sigma;
};
struct Board {                     // "boards"
  std::string kind;                // "checkerboard" | "charuco"
  std::vector<int> inner_corners;  // checkerboard: [columns, rows]
  std::vector<int> squares;        // charuco: [columns, rows]
  double square_m = 0;
  std::optional<double> marker_m;     // charuco
  std::string dictionary;             // charuco: "4X4_50", "5X5_1000", ...
  std::optional<bool> legacy_layout;  // charuco: the layout of OpenCV before 4.6; absent: found from the pictures
  Parameters warp;                    // board.warp: {"x_m", "y_m"} sag in metres (0: flat)
  Sigmas sigma;
  std::string dictionary_file;       // charuco: file id of a dictionary of the user's own
  std::optional<double> flatness_m;  // estimated peak to valley height over the corners
};
// How well a calibration predicts pixels, judged over the image and by calibrating each half of the views alone.
struct CameraQuality {
  std::optional<double> predicts_within_px;  // at 95 %, over the image at the distances below; expected of this fit
  std::vector<double> distances_m;
  std::optional<double> halves_differ_px;  // root mean square over the image of the two halves' predictions' difference
  std::optional<double> halves_expected_px;  // what their covariances expect of it
  std::optional<bool> halves_agree;
  std::optional<double> coverage;            // share of the image that corners reach, 0 .. 1
  std::vector<std::string> next;             // what to photograph next, one sentence each
  std::map<std::string, std::string> files;  // maps and pictures: "projection-sigma" -> file id
};
struct Camera {                   // "cameras"
  std::string model = "pinhole";  // camera/intrinsics.h lists them
  int width_px = 0, height_px = 0;
  Parameter fx_px, fy_px, cx_px, cy_px;  // orthographic: fx, fy are pixels per metre (px_per_m_x ...) instead
  Parameter px_per_m;                    // orthographic only
  Parameters distortion;                 // camera/lens_terms.h; left out: zero
  Sigmas sigma;
  std::optional<double> rms_px;
  Value covariance;  // {"order": [...], "values": [[...]]} or null
  std::optional<CameraQuality> quality;
  std::string mosaic{};  // filters over the pixels: "RGGB", "GRBG", "GBRG", "BGGR"; "polarizers": [90 45; 135 0]
};
struct RigMember {
  std::string camera;
  Pose<frame::Rig, frame::Camera> rig_from_camera;
};
struct Rig {  // "rigs": cameras that are held together; the first defines the frame
  std::vector<RigMember> cameras;
  std::optional<double> rms_px;
};
struct Noise {  // of a linear value v: variance v / gain + read^2
  double gain = 0, read = 0;
};
struct SeenBoard {  // one of several boards in an image
  std::string board;
  std::optional<Pose<frame::Camera, frame::Board>> camera_from_board;
  std::optional<double> rms_px, weight;
};
struct ImageEntry {  // "images"
  std::string id, file, camera;
  std::optional<Pose<frame::World, frame::Camera>> world_from_camera;  // absent: the camera sits at the world's origin
  std::vector<std::string> light;  // one name or a list; empty: every light of the scene is on
  std::optional<double> exposure_s;
  std::optional<double> time_s{}, temperature_K{};  // when it was taken, counted from any moment; of the instrument
  Value response;    // "linear" (default for EXR), "srgb", or a table [[code, linear], ...]
  std::string mask;  // file id: pixels > 0.5 count
  std::string board;
  std::optional<Pose<frame::Camera, frame::Board>> camera_from_board;
  std::optional<double> rms_px;
  std::optional<double> weight;  // 0: dropped
  std::optional<Noise> noise;
  std::optional<Parameter> gain;  // factor on the simulated radiance, per image (free: unknown exposure)
  std::string group;              // recordings that belong together; held out together
  std::string shot;               // images of a rig's cameras that were taken at the same moment share it
  std::string robot;              // whose tool pose or joints follow
  std::optional<Pose<frame::Base, frame::Tool>> base_from_tool;  // as the robot's controller said
  std::vector<double> joints_rad;
  std::vector<SeenBoard> boards;  // instead of `board`, where it shows several
};
struct Mesh {  // "meshes": a PLY file or an analytic shape
  std::string file;
  std::optional<double> sphere_radius_m;            // {"sphere": {"radius_m": r}}, centred at the object's origin
  std::optional<std::vector<double>> plane_size_m;  // {"plane": {"size_m": [x, y]}}, in its own xy plane, normal +z
  std::string normals;  // "smooth" (default: the file's, else averaged by area and angle) | "flat"
};
struct LawUse {  // how a parameter varies over an object: a registered law (surface/law.h) and its parameters
  std::string law;
  Parameters parameters;
};
// "surfaces" and "lights": a registered model and its parameters, validated against the registry (manifest/model.h).
struct Surface {
  std::string model = "diffuse";
  Parameters parameters;
  std::map<std::string, std::string> textures;  // parameter -> file id
  Sigmas sigma;
  std::string file{};                             // models that read a table (MERL): file id
  std::string base{};                             // models that lie on another surface: its name
  std::map<std::string, std::string> spectra{};   // parameter -> file id: refractiveindex.info YAML, or CSV
  std::map<std::string, std::string> vertices{};  // parameter -> the vertices' property (R, G, B: x for x_r...)
  std::map<std::string, std::map<std::string, Parameter>> labels{};  // parameter -> face label -> value
  std::map<std::string, LawUse> laws{};                              // parameter -> how it varies over the object
};
struct Light {
  std::string model = "point";
  Parameters parameters;
  std::string file;  // picture or table of models that have one: file id
  Sigmas sigma;
};
struct Object {  // "objects"
  std::string id, mesh, surface;
  std::optional<Pose<frame::World, frame::Object>> world_from_object;
  std::optional<int> priority{};  // where objects that let light through overlap, the highest one fills the space
};
struct Table {  // "tables": one row per observation, in a CSV file or inline
  std::string file;
  Value rows;                                                // inline rows [[...], ...] in the order of `columns`
  std::string model;                                         // forward model that predicts it: "camera", "surface", ...
  std::vector<std::pair<std::string, std::string>> columns;  // name -> unit, in the file's order
  std::vector<std::string> observed, sigma;
  std::string camera, board;       // model "camera": whose corners these are
  std::string surface{}, light{};  // models "surface", "light": what the base model believes
  std::string group{};             // column whose equal values belong together: held out together
  std::string block{};             // column whose equal values share their noise; left out: single rows
  std::string expression{};        // model "expression": the forward model over columns and parameters
  Parameters parameters{};         // of the forward model: expressions, gains
  Sigmas sigmas{};                 // beside fitted parameters
};
// "mechanisms": optional physics that is switched on, by canonical id. `on` names the surfaces or lights it applies to
// (empty: all it can apply to); a parameter is one number, or one per name in `on`.
struct MechanismUse {
  std::vector<std::string> on;
  Parameters parameters;
  Sigmas sigma;
};
struct Rendering {  // "renderings"
  std::string image, file;
  std::optional<int> spp;
  std::optional<std::uint64_t> seed;
  std::vector<int> samples{};                  // [A, B]: the share of samples A to B - 1 of each pixel; left out: all
  std::optional<double> relative_error{};      // estimated, of the mean pixel
  std::vector<double> wavelengths_m{};         // spectral renderings: centres of the bins
  std::map<std::string, std::string> files{};  // further pictures by kind: "stokes", "mosaic", ... -> file id
};
struct Comparison {  // "comparisons"
  std::string image;
  std::optional<double> exposure_scale, rmse, relative_rmse, ssim, log10_error, z_rms;
  std::optional<double> z_above_3;  // share of |z| > 3
  std::optional<std::int64_t> pixels, not_finite;
  Sigmas sigma;
  Value files;  // {"report": file id, ...}
};

struct DhRow {  // standard Denavit-Hartenberg: T = Rz(theta) Tz(d) Tx(a) Rx(alpha)
  double a_m = 0, d_m = 0, alpha_rad = 0, theta_rad = 0;
};
struct Robot {              // "robots"
  std::string model;        // a known arm (robot/kinematics.h), or "dh" with `dh`
  std::vector<DhRow> dh;    // instead of the model's nominal values
  std::string calibration;  // file id of a UR controller's calibration.conf: deltas on the nominal values
};
struct HeldOut {  // of images that the fit did not see
  std::optional<double> rms_px, translation_m, rotation_rad;
};
// Where the scatter of a hand-eye calibration comes from, as standard deviations of the board's position.
struct ScatterParts {
  std::optional<double> robot_m, camera_m, board_m, unexplained_m;
};
// "mountings": what is fixed to a robot's tool or stands in its world, as handeye found it.
// eye-in-hand: tool_from_camera, base_from_board. eye-to-hand: base_from_camera, tool_from_board.
// light-in-hand: light_in_tool_m, world_from_base.
struct Mounting {
  std::string kind, robot, camera, board, light;
  std::optional<Pose<frame::Tool, frame::Camera>> tool_from_camera;
  std::optional<Pose<frame::Base, frame::Board>> base_from_board;
  std::optional<Pose<frame::Base, frame::Camera>> base_from_camera;
  std::optional<Pose<frame::Tool, frame::Board>> tool_from_board;
  std::optional<Pose<frame::World, frame::Base>> world_from_base;
  std::vector<double> light_in_tool_m;
  Sigmas sigma;
  std::string method;                                    // closed form and refinement
  std::optional<double> corner_px, robot_m, robot_rad;   // estimated noise, one coordinate
  std::optional<double> scatter_m, scatter_rad, rms_px;  // of the fit
  std::optional<HeldOut> held_out;
  std::optional<ScatterParts> parts;
  Value covariance;                                       // {"order": [...], "values": [[...]]} or null
  std::vector<std::string> unobservable, outliers, next;  // directions; image ids; poses to add, in words
};
struct LightPosition {  // "light_positions": where a light was while its robot stood at a pose
  std::string id, light, robot;
  std::optional<Pose<frame::Base, frame::Tool>> base_from_tool;
  std::vector<double> position_m, sigma_m;  // world; sigma: 1 or 3
};
struct AcceptanceResult {  // "acceptance": figures after VDI/VDE 2634 part 2 of an optical scanner
  std::string quantity;    // probing-form, probing-size, sphere-distance, flatness
  std::string file, unit;
  double value = 0;                                       // worst case, as the guideline asks
  std::optional<double> bias, sigma, limit, uncertainty;  // same unit
  std::optional<std::int64_t> count, rejected;
};

}  // namespace gonio::manifest
