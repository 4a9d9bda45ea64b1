// See call.h.
#include "tools/nrsfm-make/call.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <set>

#include "base/error.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "base/text.h"
#include "manifest/sections/image.h"
#include "manifest/sections/sequence.h"
#include "nrsfm/files.h"
#include "nrsfm/make/factorial.h"
#include "nrsfm/make/flow.h"

namespace gonio::tools::nrsfm_make {

using namespace gonio::nrsfm;

namespace {

using cli::Type;

std::vector<std::string> kinds() {
  std::vector<std::string> ids;
  for (const Animatronic* animatronic : all_animatronics()) ids.push_back(animatronic->info().id);
  return ids;
}

const std::vector<std::string> cameras{"orthographic", "perspective"}, missing{"with", "without"};

std::vector<std::string> levels(const cli::Invocation& call, const char* option, const std::vector<std::string>& all) {
  return call.given(option) ? call.texts(option) : all;
}

// --seen-from: where the images were taken from, in the order of their names, about the world's origin and in units of
// their mean distance from there. Empty: not asked for.
std::vector<Vec3> places_asked(const cli::Invocation& call) {
  if (!call.given("seen-from")) return {};
  std::map<std::string, Vec3> eyes;
  for (const manifest::ImageEntry& image : call.document.images)
    if (image.world_from_camera) eyes[image.id] = image.world_from_camera->translation_m;
  double sum = 0;
  std::vector<Vec3> places;
  for (const auto& [id, eye] : eyes) places.push_back(eye), sum += norm(eye);
  if (places.size() < 2 || sum == 0)
    throw Error(Exit::data, manifest::place(call.document, "/images"),
                std::to_string(places.size()) + " of them say where their camera stood, two are needed",
                "take them with acquire, or leave --seen-from out");
  for (Vec3& place : places) place = place * (static_cast<double>(places.size()) / sum);
  return places;
}

Eigen::Index frames_asked(const cli::Invocation& call) {
  return call.given("seen-from") ? static_cast<Eigen::Index>(places_asked(call).size()) : call.integer("frames");
}

AnimatronicOptions size_asked(const cli::Invocation& call) {
  return {frames_asked(call), call.integer("points"), call.seed};
}

bool is_file_name(const std::string& name) {
  return !name.empty() && name.front() != '.' &&
         std::ranges::all_of(name, [](unsigned char c) { return std::isalnum(c) || c == '-' || c == '_' || c == '.'; });
}

bool by_flow(const cli::Invocation& call) {
  return call.text("tracks-from") == "optical-flow";
}

// What deforms: made where a file of it is to be written, all kinds at once, since that takes longer than everything
// after it.
class Stage {
 public:
  explicit Stage(cli::Invocation& call) : call_(call) {}
  void prepare(const std::vector<std::string>& kinds) {
    std::vector<Motion> made(kinds.size());
    parallel_for(0, kinds.size(), [&](std::size_t k) { made[k] = motion_named(kinds[k]); });
    for (std::size_t k = 0; k < kinds.size(); ++k) {
      for (const std::filesystem::path& file : made[k].files) call_.note_input(file);
      motions_[kinds[k]] = std::move(made[k]);
    }
  }
  const Motion& motion(const std::string& kind) {
    if (!motions_.contains(kind)) prepare({kind});
    return motions_.at(kind);
  }
  // Neighbouring cells share it.
  const Take& take(const Cell& cell, const ViewOptions& options) {
    const std::string name = cell.deformation + "/" + cell.path + "/" + cell.camera;
    if (name != taken_) take_ = take_of(motion(cell.deformation), cell.path, cell.camera, options), taken_ = name;
    return take_;
  }

 private:
  Motion motion_named(const std::string& kind) const {
    Motion motion = call_.given("meshes")
                        ? motion_of_scans(call_.text("meshes"), call_.text("tracks"), call_.number("unit"))
                        : motion_of(*find_animatronic(kind), size_asked(call_));
    motion.kind = kind;
    motion.one_sided = call_.flag("one-sided");
    motion.tolerance_m = call_.given("meshes") ? call_.number("tolerance") : 0;
    return motion;
  }

  cli::Invocation& call_;
  std::map<std::string, Motion> motions_;
  Take take_;
  std::string taken_;
};

ViewOptions view_asked(const cli::Invocation& call) {
  return {call.number("distance"), call.number("least-seen"),
          by_flow(call) ? static_cast<int>(call.integer("flow-width")) : 0, places_asked(call)};
}

// What decides the content of a file, for --resume: all options that do, with the scans' files.
std::string made_with(const cli::Invocation& call) {
  std::string said = "distance " + call.text("distance") + ", least seen " + call.text("least-seen");
  if (call.flag("one-sided")) said += ", one-sided";
  if (by_flow(call)) said += ", optical flow at " + call.text("flow-width");
  for (const Vec3& place : places_asked(call))
    said += ", from " + shortest_text(place.x) + " " + shortest_text(place.y) + " " + shortest_text(place.z);
  if (!call.given("meshes"))
    return said + ", frames " + std::to_string(frames_asked(call)) + ", points " + call.text("points") + ", seed " +
           std::to_string(call.seed);
  return said + ", meshes " + call.text("meshes") + ", tracks " + call.text("tracks") + ", unit " + call.text("unit") +
         ", tolerance " + call.text("tolerance");
}

// Everything that the entry says is known without a simulation, so that a resumed call writes the same.
void enter(cli::Invocation& call, Stage& stage, const Sequence& s, const std::filesystem::path& path) {
  const std::string& kind = s.factors.at("deformation");
  const bool scans = call.given("meshes");
  const Eigen::Index points = scans ? stage.motion(kind).points_m.cols() : call.integer("points");
  manifest::TrackSequence entry;
  entry.file = manifest::add_file(call.document, path, s.name);
  entry.frames = s.frames(), entry.points = s.points();
  entry.projection = s.projection == Projection::perspective ? "perspective" : "orthographic";
  entry.truth_frame = "object";
  entry.unit_m = s.unit_m;
  entry.missing_share = s.missing_share();
  entry.tracks_from = call.text("tracks-from");
  if (!scans) entry.seed = call.seed;
  entry.factors = s.factors;
  entry.source = scans ? stage.motion(kind).source : "simulated: " + find_animatronic(kind)->info().sentence;
  if (scans) entry.notes = stage.motion(kind).notes;
  if (s.points() < points)
    entry.notes.push_back(std::to_string(s.points()) + " points of " + std::to_string(points) + ": no more are " +
                          (by_flow(call) ? "found" : "seen") + " in " + call.text("least-seen") + " of the frames");
  if (by_flow(call)) {
    const TrackErrors errors = track_errors(s);
    const auto unit = [&s](double error) {
      const bool pixels = s.projection == Projection::perspective;
      return shortest_text(std::round((pixels ? 100 : 1e6) * error) / (pixels ? 100 : 1000)) + (pixels ? " px" : " mm");
    };
    entry.notes.push_back("the median error of the tracks is " + unit(errors.median) + ", 5 % exceed " +
                          unit(errors.upper));
  }
  call.document.sequences[s.name] = entry;
}

void make(cli::Invocation& call, Stage& stage, const Cell& cell, const std::filesystem::path& path) {
  if (call.resume && std::filesystem::exists(path)) {
    const std::string said = made_with_of(path);
    if (said != made_with(call))
      throw Error(Exit::cannot_create, path.string(),
                  said.empty() ? "is not a file of nrsfm-make" : "was made with " + said, "--force replaces it");
    enter(call, stage, read_sequence(path), path);
    return;
  }
  const ViewOptions view = view_asked(call);
  const Motion& motion = stage.motion(cell.deformation);
  const Sequence sequence = film(motion, stage.take(cell, view), cell, call.seed, view);
  write_sequence(sequence, path, made_with(call));
  enter(call, stage, sequence, path);
}

std::vector<std::string> deformations(const cli::Invocation& call) {
  if (!call.given("meshes")) return levels(call, "kind", kinds());
  if (call.given("name")) return {call.text("name")};
  return {"scans"};
}

}  // namespace

Exit run(cli::Invocation& call) {
  if (call.given("follow")) return follow_photographs(call);
  if (call.given("object")) return make_object(call);
  const auto cells =
      design(deformations(call), levels(call, call.given("seen-from") ? "seen-from" : "path", path_names()),
             levels(call, "camera", cameras),
             by_flow(call) ? std::vector<std::string>{"with"} : levels(call, "missing", missing));
  std::vector<std::filesystem::path> paths;  // refused before anything is simulated
  std::vector<std::string> needed;
  for (const Cell& cell : cells) {
    paths.push_back(call.output_path(name_of(cell, call.seed) + ".mat"));
    if (call.resume && std::filesystem::exists(paths.back())) continue;
    if (std::ranges::find(needed, cell.deformation) == needed.end()) needed.push_back(cell.deformation);
  }
  Stage stage(call);
  stage.prepare(needed);
  std::vector<NoTracks> left_out;
  std::set<std::string> why;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    try {
      make(call, stage, cells[k], paths[k]);
    } catch (const NoTracks& error) {
      left_out.push_back(error);
      why.insert(error.what());
    }
  }
  if (left_out.size() == cells.size()) throw left_out.front();
  for (const std::string& line : why) log(LogLevel::warning, line + "; left out");
  return left_out.empty() ? Exit::done : Exit::quality;
}

void check(cli::Invocation& call) {
  if (call.out.empty() && !call.given("out"))
    throw Error(Exit::usage, "--out", "is missing", "name the folder for the sequences: --out sequences");
  if (call.given("name") && !is_file_name(call.text("name")))
    throw Error(Exit::usage, "--name", "is \"" + call.text("name") + "\", which no file can be called",
                "take letters, digits, -, _ and dots");
  if (by_flow(call) && call.given("meshes"))
    throw Error(Exit::usage, "--tracks-from", "is optical-flow of scans, whose paint is not known",
                "leave it out beside --meshes");
  if (by_flow(call) && call.given("missing") && std::ranges::count(call.texts("missing"), "without") > 0)
    throw Error(Exit::usage, "--missing", "is without, which optical flow has not", "leave it out: tracks get lost");
  if (call.given("seen-from") && !is_file_name(call.text("seen-from")))
    throw Error(Exit::usage, "--seen-from", "is \"" + call.text("seen-from") + "\", which no file can be called",
                "take letters, digits, -, _ and dots");
  if (call.given("follow") && !is_file_name(call.text("follow")))
    throw Error(Exit::usage, "--follow", "is \"" + call.text("follow") + "\", which no file can be called",
                "take letters, digits, -, _ and dots");
  if (call.given("object") && !is_file_name(call.text("object")))
    throw Error(Exit::usage, "--object", "is \"" + call.text("object") + "\", which no file can be called",
                "take letters, digits, -, _ and dots");
  if (call.given("object") && !call.given("follow") && call.texts("kind").size() != 1)
    throw Error(Exit::usage, "--object", format("is one thing, and %zu kinds are named", call.texts("kind").size()),
                "name one: --kind bending");
  for (const char* option : {"frames", "points", "kind"})
    if (call.given("meshes") && call.given(option))
      throw Error(Exit::usage, std::string("--") + option, "is that of the scans", "leave it out beside --meshes");
}

std::vector<cli::Option> options() {
  return {
      {.name = "kind",
       .type = Type::choice,
       .help = "Animatronic; may be repeated. Left out: all.",
       .choices = kinds(),
       .repeat = true},
      {.name = "path",
       .type = Type::choice,
       .help = "Path of the camera; may be repeated. Left out: all.",
       .choices = path_names(),
       .repeat = true},
      {.name = "seen-from",
       .type = Type::text,
       .help = "Instead of a path by name: the camera stands where the manifest's images were taken from, in the order "
               "of their names, about the world's origin; the path is called NAME.",
       .metavar = "NAME",
       .conflicts = {"path", "frames", "meshes"}},
      {.name = "follow",
       .type = Type::text,
       .help = "Instead of simulating: follow points through the manifest's images, in the order of their names; the "
               "path is called NAME. --points are followed at once, lost ones replaced.",
       .metavar = "NAME",
       .conflicts = {"path", "seen-from", "kind", "frames", "meshes"}},
      {.name = "every",
       .type = Type::integer,
       .help = "--follow: of the images one makes a frame; those between are followed through.",
       .preset = "1",
       .lower = 1,
       .upper = 1000,
       .needs = {"follow"}},
      {.name = "truth",
       .type = Type::input_file,
       .help = "--follow: what really stood there, as acquire --truth read it; adds the truth, and the same points' "
               "tracks as geometry has them.",
       .needs = {"follow", "object"}},
      {.name = "object",
       .type = Type::text,
       .help = "Instead of tracks: enter the thing itself, painted, as object NAME of the scene; its mesh goes through "
               "--frames shapes (acquire --truth). With --follow: what is followed.",
       .metavar = "NAME",
       .conflicts = {"path", "seen-from", "meshes"}},
      {.name = "grain",
       .type = Type::quantity,
       .help = "--object: the finest of its paint.",
       .preset = "3mm",
       .dimension = Dimension::length,
       .lower = 1e-5,
       .upper = 1,
       .needs = {"object"}},
      {.name = "camera",
       .type = Type::choice,
       .help = "Projection; may be repeated. Left out: both.",
       .choices = cameras,
       .repeat = true},
      {.name = "missing",
       .type = Type::choice,
       .help = "With or without the points that the surface hides from the camera; may be repeated. Left out: both.",
       .choices = missing,
       .repeat = true},
      {.name = "frames",
       .type = Type::integer,
       .help = "Of each simulated sequence.",
       .preset = "60",
       .lower = 2,
       .upper = 10000},
      {.name = "points",
       .type = Type::integer,
       .help = "That are followed on each animatronic.",
       .preset = "100",
       .lower = 4,
       .upper = 10000},
      {.name = "distance",
       .type = Type::number,
       .help = "Of the camera from the middle, over the radius of the scene.",
       .preset = "4.3",
       .lower = 2,
       .upper = 1000},
      {.name = "least-seen",
       .type = Type::quantity,
       .help = "Points that a smaller share of the frames sees are not followed.",
       .preset = "10%",
       .dimension = Dimension::ratio,
       .lower = 0,
       .upper = 1},
      {.name = "meshes",
       .type = Type::text,
       .help = "Instead of animatronics: folder or pattern of PLY meshes, one per frame.",
       .metavar = "PATH",
       .conflicts = {"kind"},
       .needs = {"tracks"}},
      {.name = "tracks",
       .type = Type::text,
       .help = "Points that are followed on the meshes: .mat, .npz, or PLY files per frame.",
       .metavar = "PATH",
       .needs = {"meshes"}},
      {.name = "name",
       .type = Type::text,
       .help = "Of the scans: level of the factor deformation.",
       .needs = {"meshes"}},
      {.name = "unit",
       .type = Type::quantity,
       .help = "Length of the unit of meshes and tracks.",
       .preset = "1m",
       .dimension = Dimension::length,
       .lower = 1e-9,
       .upper = 1e6,
       .needs = {"meshes"}},
      {.name = "tolerance",
       .type = Type::quantity,
       .help = "Tracked points may lie this far behind the mesh and still be seen.",
       .preset = "0.5mm",
       .dimension = Dimension::length,
       .lower = 0,
       .needs = {"meshes"}},
      {.name = "tracks-from",
       .type = Type::choice,
       .help = "Whether tracks are the points themselves, or what a tracker finds of them in rendered pictures.",
       .preset = "geometry",
       .choices = {"geometry", "optical-flow"}},
      {.name = "flow-width",
       .type = Type::integer,
       .help = "Pixels of the rendered pictures' width; their height is three quarters of it.",
       .preset = "640",
       .lower = 64,
       .upper = 8192,
       .needs = {"tracks-from"}},
      {.name = "one-sided",
       .type = Type::flag,
       .help = "Hide points of open sheets from behind; without it they show on both sides."}};
}

}  // namespace gonio::tools::nrsfm_make
