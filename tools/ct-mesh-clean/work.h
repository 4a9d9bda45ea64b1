// One run of ct-mesh-clean: what the user asked, and what its steps hand to one another.
//
// Volumes are in index coordinates (voxel centres at integers), meshes in metres in the volume's own frame, which
// becomes the object's: p_m = origin_m + axes * diag(spacing_m) * index (io/volume.h). A step reads what earlier ones
// left, leaves its own, and appends its entry of the manifest and its part of the page; each has a source of its own.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/program.h"
#include "io/ply.h"
#include "io/volume.h"
#include "manifest/sections/volume.h"
#include "mesh/carve.h"
#include "mesh/clean.h"
#include "mesh/verdict.h"
#include "report/page.h"
#include "volume/contour.h"
#include "volume/correct.h"
#include "volume/look.h"
#include "volume/markers.h"
#include "volume/threshold.h"
#include "volume/topology.h"

namespace gonio::tools::ct_mesh_clean {

enum class ThresholdBy { materials, otsu, gradient, reference, value };
enum class CleanBy { bounded, subdivision, taubin, none };

struct Length {  // as people say it: a length, or a share of a voxel
  double voxels = 0;
  std::optional<double> m;
  double metres(double voxel_m) const { return m ? *m : voxels * voxel_m; }
};

struct Asked {
  io::VolumeWish file;
  ThresholdBy threshold_by = ThresholdBy::gradient;
  double threshold = 0;  // ThresholdBy::value
  volume::Connectivity inside = volume::Connectivity::twenty_six;
  bool cupping = false, rings = false;
  volume::Denoise denoise = volume::Denoise::none;
  std::optional<volume::SplitWish> split;
  bool core_by_materials = false;
  volume::KeepRule keep;
  bool find_markers = false;
  std::optional<double> marker_radius_m, marker_threshold;
  double eps = 0.6;
  CleanBy clean = CleanBy::bounded;
  Length within;
  std::size_t faces = 0;  // decimated to this at the end; 0: as many as there are
  double index = 1.5;     // of refraction, for the rays' bend
  std::optional<Length> limit_distance;
  std::optional<double> limit_bend_rad;
  std::string surface;  // name in surfaces of the object that enters the scene
};

struct StepPicture {
  std::string step, title, caption, png;
};

// A surface on its way, for the viewer.
struct Stage {
  std::string name;
  std::vector<Vec3> positions_m;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

struct Work {
  Work(cli::Invocation& of, Asked what) : call(of), asked(std::move(what)) {}
  cli::Invocation& call;
  Asked asked;
  std::string name;                                        // of the volume, the mesh and the object
  std::string path;                                        // of the volume
  std::unique_ptr<io::VolumeSource> file;                  // as stored
  std::vector<std::unique_ptr<io::VolumeSource>> derived;  // corrected, cleared of other components
  io::VolumeSource* volume = nullptr;                      // as the steps so far left it
  io::VolumeGrid grid;
  double voxel_m() const { return grid.smallest_m(); }

  volume::Look look;
  volume::Threshold threshold;
  volume::Components components;
  volume::Kept kept;
  std::int64_t euler = 0;           // of the solid, from the voxels
  bool cut_by_border = false;       // the volume's border cuts a component that stays
  volume::Contour contour;          // of the object, until it is in metres
  std::vector<volume::Edge> edges;  // at its vertices, until they are cleaned
  volume::Markers markers;
  io::TriangleMesh data;  // the surface where the data put it, metres
  io::TriangleMesh mesh;  // what becomes of it
  io::TriangleMesh markers_mesh;
  mesh::Carved carved;
  bool sound = false;   // closed, 2-manifold, oriented, no self-intersection
  bool missed = false;  // not sound, or beyond a limit of the user

  std::vector<manifest::VolumeStep> steps;
  bool with_page = false;
  std::vector<Stage> stages;  // where there is a page
  std::vector<StepPicture> pictures;
  std::vector<report::Plot> plots;
};

// The contour in metres, counter-clockwise seen from outside, with unit normals.
io::TriangleMesh in_metres(const Work& work, const volume::Contour& contour);

// The object's material: what the look says or, where markers are asked for, which are the densest, of the others
// beside air the one with the most voxels. Equal to look.air: there is none.
std::size_t object_material(const Work& work);

manifest::VolumeStep& step(Work& work, const char* name, std::string how);
void show(Work& work, const char* stage, const io::TriangleMesh& mesh);

// The steps, in their order.
void open(Work& work);  // volume_from_index is complete, or Error(data) says what to give
void look(Work& work);
void correct(Work& work);
void cut(Work& work);      // the threshold
void select(Work& work);   // components
void contour(Work& work);  // the surface
void refine(Work& work);   // its edges; vertices at the steepest gradient where asked
void find_markers(Work& work);
void carve(Work& work);
void clean(Work& work);
void judge(Work& work);  // the verdict; sets `sound` and `missed`
void draw(Work& work);   // slices with the contour over them

void enter(Work& work);  // files and sections of the manifest
std::string page(const Work& work);

// The volume that is asked for: VOLUME, else that of the manifest which --name names, else its only one. Sets name,
// path, and what the manifest says of the file beside what the user says.
void choose(Work& work);
// The built-in volume: a hollow sphere of glass with three markers glued to it, blurred and with noise, as NRRD below
// --out.
void write_specimen(cli::Invocation& call);

Asked asked(const cli::Invocation& call);
std::vector<cli::Option> options();

}  // namespace gonio::tools::ct_mesh_clean
