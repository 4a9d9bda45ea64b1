// The manifest: one JSON document that flows through the pipe (gonio-manifest(5)). Programs read it into these typed
// sections, change their own, and write it; entries that did not change are written as they were read, key for key and
// digit for digit.
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "manifest/sections/forward.h"
#include "manifest/value.h"

namespace gonio::manifest {

// A section that is one object instead of many: absent, or one.
template <class T>
struct AtMostOne {
  std::vector<T> entry;
};

// The sections' types are only declared here, so that their fields stay out of sources that do not touch them
// (manifest/sections/forward.h). Containers of them are what GCC's and LLVM's libraries allow as members as long as no
// member function is called; those that every user of Document would call are therefore defined in document.cpp.
struct Document {
  Document();
  ~Document();
  Document(const Document& other);
  Document(Document&& other) noexcept;
  Document& operator=(const Document& other);
  Document& operator=(Document&& other) noexcept;

  std::map<std::string, File> files;
  std::vector<Link> frames;
  std::map<std::string, Board> boards;
  std::map<std::string, Camera> cameras;
  std::map<std::string, Rig> rigs;
  std::map<std::string, Robot> robots;
  std::vector<ImageEntry> images;
  std::map<std::string, ColourCorrection> colour;
  std::map<std::string, Mesh> meshes;
  std::map<std::string, Surface> surfaces;
  std::map<std::string, Environment> environments;
  std::map<std::string, Light> lights;
  std::vector<Object> objects;
  std::map<std::string, Table> tables;
  std::map<std::string, MechanismUse> mechanisms;
  std::vector<Rendering> renderings;
  std::vector<Comparison> comparisons;
  std::map<std::string, Mounting> mountings;
  std::vector<LightPosition> light_positions;
  std::vector<AcceptanceResult> acceptance;
  std::map<std::string, FlatPatch> goniometer;
  std::map<std::string, SurfaceFit> surface_fits;
  std::map<std::string, Pattern> patterns;
  std::map<std::string, Projection> projections;
  std::map<std::string, Cloud> clouds;
  AtMostOne<Registration> registration;
  std::vector<Outline> outlines;
  std::vector<Alignment> alignments;
  std::vector<Contrast> contrasts;
  std::map<std::string, ReliefMap> reliefs;
  std::map<std::string, GroundNoiseFit> ground_noises;
  std::map<std::string, Print> prints;
  std::map<std::string, Volume> volumes;
  std::vector<Marker> markers;
  std::vector<Placement> placements;
  AtMostOne<Laboratory> laboratory;
  std::vector<Plan> plans;
  std::vector<Run> runs;
  std::map<std::string, TrackSequence> sequences;
  std::vector<ShapeReconstruction> reconstructions;
  std::vector<Evaluation> evaluations;
  std::vector<Value> explanations;  // written by explain; its shape is checked against the field table
  Value provenance = Value::object();

  std::string name = "(empty)";        // file as the user typed it, "standard input", for messages
  std::filesystem::path folder = ".";  // relative paths of `files` start here
  bool allow_outside = false;          // may `files` leave the folder?
  Value original;                      // as read: source of the untouched entries and of x-* keys
};

struct ReadOptions {
  bool allow_outside = false;
};
// `path` "-" is standard input (relative paths then start at the working directory). Unknown keys (except x-*), wrong
// units, NaN, non-orthonormal rotations, dangling references are Error(data) at NAME#/json/pointer. No file is opened.
Document read_document(const std::filesystem::path& path, const ReadOptions& options = {});
Document parse_document(std::string_view text, const std::string& name, const std::filesystem::path& folder,
                        const ReadOptions& options = {});

// The document as it will be written, relative paths re-based from `document.folder` to `folder`.
Value to_value(const Document& document, const std::filesystem::path& folder);
std::string print_document(const Document& document, const std::filesystem::path& folder);

// Absolute path of a file the manifest names. `user` is the JSON pointer that asks for it, for messages. Refuses ids
// that do not exist, paths that leave the folder (unless allow_outside), missing files (no_input), other sizes or
// hashes (data).
std::filesystem::path resolve(const Document& document, const std::string& file_id, const std::string& user);
// Enters an existing file with its size and hash under `id` (made unique when taken by another file). Returns the id.
std::string add_file(Document& document, const std::filesystem::path& path, const std::string& id);

// For sources that ask no more of a section than who is in it, and so do not see its fields: the keys of the entries of
// `section` ("cameras", ...) or, where it is a list ("images", ...), their ids, in their order; whether `name` is one.
std::vector<std::string> names_in(const Document& document, std::string_view section);
bool has_entry(const Document& document, std::string_view section, const std::string& name);
const Camera* find_camera(const Document& document, const std::string& name);  // null where there is none

// "NAME#/cameras/c" for messages.
std::string place(const Document& document, const std::string& pointer);

// Provenance: a graph keyed by content. A step's key is the hash of program, version, canonical options and the hashes
// of its inputs; time and host stand beside it and do not enter the id: same inputs, same id.
struct Step {
  std::string program, version;
  Value options = Value::object();        // without --threads, --progress, --log-level, -i, -o, --out
  std::vector<std::string> input_hashes;  // SHA-256 of files read
  std::string input_id;                   // content id of the manifest read, empty for none
  // When and where, UTC; empty: not recorded, so that the same inputs give the same bytes.
  std::string time{}, host{};
};
void record_step(Document& document, const Step& step);
std::string content_id(const Document& document);  // of everything but provenance's times and hosts

}  // namespace gonio::manifest
