// One run of reassemble: what the user asked, and what its steps hand to one another. World frame, metres, radians.
//
// A step reads what earlier ones left, leaves its own, and enters it into the manifest; each has a source of its own.
#pragma once
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/program.h"
#include "io/ply.h"
#include "mesh/mesh.h"
#include "mesh/triangle_tree.h"
#include "reassembly/contact.h"
#include "reassembly/detect.h"
#include "reassembly/labels.h"
#include "reassembly/marker_rows.h"
#include "reassembly/piece_document.h"
#include "reassembly/place.h"

namespace gonio::tools::reassemble {

struct AskedPiece {
  std::string name, file, object;  // NAME=FILE#OBJECT
};
struct Asked {
  std::vector<AskedPiece> pieces;
  std::vector<std::string> images;  // empty: all
  reassembly::DetectWish detect;
  reassembly::PlaceWish place;
  std::optional<double> marker_radius_m, max_error_m;
  std::string marker_surface;                  // empty: markers do not enter the scene
  std::string background, background_surface;  // PLY file; surface of what no label says
  bool labels = false;
  std::vector<std::string> label_surfaces;                 // surfaces that the background may have
  std::vector<std::pair<std::string, std::string>> seeds;  // image, file
  int shading_spp = 0;                                     // 0: by chromaticity alone
  std::optional<reassembly::Yield> contact;                // none
  double deepest_m = 0;
  bool settle = false;
  Vec3 down{0, 0, -1};
};

struct PlacedPiece {  // with its mesh, in its own frame
  const reassembly::Piece* piece = nullptr;
  const reassembly::Placed* placed = nullptr;
  mesh::Mesh mesh;
  std::unique_ptr<mesh::TriangleTree> tree;
};
using PlacedPieces = std::vector<std::unique_ptr<PlacedPiece>>;

struct BehindGlass {  // an outline that was taken for a marker which something stands before
  std::size_t view = 0;
  reassembly::Outline outline;
};
struct LabelledView {
  std::string image, labels_png, confidence_png;
};
struct ContactNote {  // for the page
  std::string piece, other, how, words;
};

struct Work {
  Work(cli::Invocation& of, Asked what) : call(of), asked(std::move(what)) {}
  cli::Invocation& call;
  Asked asked;
  std::vector<reassembly::Piece> pieces;
  reassembly::SeenViews seen;
  std::vector<BehindGlass> behind;  // taken out of `seen`
  reassembly::Bundles bundles;
  reassembly::Placement placement;
  std::vector<std::string> ties;  // what renderings of ambiguous pieces said
  std::string loops;              // what frame loops complain of; empty: nothing

  io::TriangleMesh background;  // as scanned, then as it gave way and was labelled
  std::vector<LabelledView> label_pictures;
  std::vector<float> label_confidence;
  std::size_t unseen_faces = 0, split_faces = 0;
  std::vector<ContactNote> contacts;
  std::map<std::string, std::filesystem::path> written;  // meshes of this run, by name: a later step may replace them
  std::vector<std::string> complaints;                   // what makes the run leave with 2
};

// The steps, in their order.
void take_pieces(Work& work);
void see(Work& work);  // markers in the photographs
void put(Work& work);  // pieces in the world
void check_frames(Work& work);
void take_background(Work& work);
void settle(Work& work);         // pieces on pieces
void press(Work& work);          // the background gives way
void label(Work& work);          // surfaces of the background
void enter_markers(Work& work);  // as objects, and their sightings as a table
std::string page(const Work& work);

PlacedPieces placed_pieces(const Work& work);
std::vector<reassembly::PosedMesh> posed(const PlacedPieces& pieces);

// The mesh of an object of the manifest, in its own frame.
io::TriangleMesh mesh_of(const Work& work, const std::string& object);
// In the world, where the object has a pose.
io::TriangleMesh placed_mesh(const Work& work, const std::string& object);
// Writes it as PLY below --out and enters it; with the object that shows it where `surface` is given.
void enter_mesh(Work& work, const std::string& name, const io::TriangleMesh& mesh, const std::string& surface);

Asked asked(const cli::Invocation& call);
std::vector<cli::Option> options();

}  // namespace gonio::tools::reassemble
