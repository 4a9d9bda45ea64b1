// The command line of ct-mesh-clean.
#include <array>
#include <charconv>
#include <cmath>

#include "base/assignment.h"
#include "base/error.h"
#include "base/quantity.h"
#include "base/text.h"
#include "cli/common_options.h"
#include "tools/ct-mesh-clean/work.h"

namespace gonio::tools::ct_mesh_clean {
namespace {

using cli::Type;

std::size_t count_of(const std::string& text, const char* option, const std::string& whole, const char* remedy) {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value == 0)
    throw Error(Exit::usage, std::string("--") + option, "\"" + whole + "\" is not a list of counts", remedy);
  return value;
}

template <std::size_t N>
std::array<std::size_t, N> counts_of(const std::string& text, const char* option, const char* remedy) {
  const std::vector<std::string> parts = pieces(text, 'x');
  if (parts.size() != N)
    throw Error(Exit::usage, std::string("--") + option,
                "\"" + text + "\" has " + std::to_string(parts.size()) + " counts, needs " + std::to_string(N), remedy);
  std::array<std::size_t, N> counts{};
  for (std::size_t i = 0; i < N; ++i) counts[i] = count_of(parts[i], option, text, remedy);
  return counts;
}

Vec3 spacing_of(const std::string& text) {
  const std::vector<std::string> parts = pieces(text, ',');
  if (parts.size() != 1 && parts.size() != 3)
    throw Error(Exit::usage, "--voxel", "\"" + text + "\" has " + std::to_string(parts.size()) + " lengths",
                "give one, or three: --voxel 0.1mm,0.1mm,0.3mm");
  std::array<double, 3> length{};
  for (std::size_t i = 0; i < 3; ++i) {
    length[i] = parse_quantity(parts[parts.size() == 1 ? 0 : i], Dimension::length, "--voxel");
    if (!(length[i] > 0 && length[i] < 1))
      throw Error(Exit::usage, "--voxel", "\"" + text + "\" is not between 0 and 1 m",
                  "give the distance of voxel centres");
  }
  return {length[0], length[1], length[2]};
}

io::VoxelType type_of(const std::string& text) {
  for (const io::VoxelType type : {io::VoxelType::u8, io::VoxelType::i8, io::VoxelType::u16, io::VoxelType::i16,
                                   io::VoxelType::u32, io::VoxelType::i32, io::VoxelType::f32, io::VoxelType::f64})
    if (text == io::name_of(type)) return type;
  throw Error(Exit::usage, "--type", "\"" + text + "\" is no type of samples");
}

std::array<std::array<double, 3>, 2> box_of(const std::string& text) {
  const std::vector<std::string> parts = pieces(text, ',');
  std::array<std::array<double, 3>, 2> box{};
  if (parts.size() != 6)
    throw Error(Exit::usage, "--box", "\"" + text + "\" has " + std::to_string(parts.size()) + " numbers",
                "give i0,j0,k0,i1,j1,k1 in voxels");
  for (std::size_t n = 0; n < 6; ++n) {
    double& to = box[n / 3][n % 3];
    const auto [end, error] = std::from_chars(parts[n].data(), parts[n].data() + parts[n].size(), to);
    if (error != std::errc() || end != parts[n].data() + parts[n].size() || std::isnan(to))
      throw Error(Exit::usage, "--box", "\"" + parts[n] + "\" is no number", "give i0,j0,k0,i1,j1,k1 in voxels");
  }
  return box;
}

std::vector<cli::Option> file_options() {
  return {{.name = "specimen",
           .type = Type::choice,
           .help = "Write a volume to try things with, and end: a hollow sphere of glass with three markers of 0.8 mm.",
           .choices = {"ornament"}},
          {.name = "voxel",
           .type = Type::text,
           .help = "Distance of voxel centres, one length or three; needed where the file does not say.",
           .metavar = "LENGTH"},
          {.name = "size",
           .type = Type::text,
           .help = "Raw samples: voxels along a row, rows, slices.",
           .metavar = "IxJxK"},
          {.name = "type",
           .type = Type::choice,
           .help = "Raw samples: their type.",
           .choices = {"uint8", "int8", "uint16", "int16", "uint32", "int32", "float32", "float64"}},
          {.name = "big-endian", .type = Type::flag, .help = "Raw samples: the most significant byte comes first."},
          {.name = "skip",
           .type = Type::integer,
           .help = "Raw samples: bytes before the first.",
           .metavar = "BYTES",
           .lower = 0,
           .upper = 1e12},
          {.name = "tiles",
           .type = Type::text,
           .help = "The picture is an atlas: so many columns and rows of slices, from the top left.",
           .metavar = "CxR"},
          {.name = "accept-gap",
           .type = Type::flag,
           .help = "DICOM: where slices are missing, take the largest stack of equal spacing."}};
}

std::vector<cli::Option> surface_options() {
  return {
      {.name = "threshold",
       .type = Type::text,
       .help = "Where the surface is: gradient (half-way between materials, then moved to the steepest gradient), "
               "materials (half-way), otsu, reference (where the markers have their --markers diameter), or a value.",
       .metavar = "HOW",
       .preset = "gradient"},
      {.name = "connectivity",
       .type = Type::choice,
       .help = "Neighbours of a voxel inside: with 26, voxels that touch in a corner are joined.",
       .preset = "26",
       .choices = {"6", "26"}},
      {.name = "correct",
       .type = Type::choice,
       .help = "Take an artefact off before the threshold; may be given twice.",
       .choices = {"cupping", "rings"},
       .repeat = true},
      {.name = "denoise",
       .type = Type::choice,
       .help = "Smooth what is no edge before the threshold.",
       .preset = "none",
       .choices = {"none", "anisotropic", "non-local"}},
      {.name = "core",
       .type = Type::text,
       .help =
           "Before components are chosen, split off what is lighter than the object, as the table that it stands on: "
           "what is farther than --reach from any value above this; materials: half-way between the object's "
           "material and the next lighter one.",
       .metavar = "VALUE"},
      {.name = "reach",
       .type = Type::integer,
       .help = "Voxels within which an edge falls from --core to the threshold.",
       .metavar = "VOXELS",
       .preset = "3",
       .lower = 1,
       .upper = 64,
       .needs = {"core"}},
      {.name = "largest",
       .type = Type::integer,
       .help = "Keep so many of the largest components; 0: all.",
       .metavar = "N",
       .preset = "1",
       .lower = 0,
       .upper = 1e9},
      {.name = "at-least",
       .type = Type::integer,
       .help = "Keep components of so many voxels.",
       .metavar = "VOXELS",
       .lower = 0,
       .upper = 1e12},
      {.name = "brighter",
       .type = Type::number,
       .help = "Keep components whose mean value is above this.",
       .metavar = "VALUE"},
      {.name = "darker",
       .type = Type::number,
       .help = "Keep components whose mean value is below this.",
       .metavar = "VALUE"},
      {.name = "box",
       .type = Type::text,
       .help = "Keep components that touch this box of voxels.",
       .metavar = "I,J,K,I,J,K"},
      {.name = "drop-enclosed",
       .type = Type::flag,
       .help = "Drop components that another one encloses, or surrounds for nine tenths."},
      {.name = "drop-cut", .type = Type::flag, .help = "Drop components that the volume's border cuts."}};
}

std::vector<cli::Option> mesh_options() {
  return {
      {.name = "markers",
       .type = Type::text,
       .help = "Find spheres glued to the object, cut them off and close the holes: their diameter, or any.",
       .metavar = "DIAMETER"},
      {.name = "marker-threshold",
       .type = Type::number,
       .help = "Value above which a voxel belongs to a marker. Default: half-way between the densest two materials.",
       .metavar = "VALUE",
       .needs = {"markers"}},
      {.name = "eps",
       .type = Type::number,
       .help = "Cut the object within (1 + eps) radii of a marker.",
       .preset = "0.6",
       .lower = 0,
       .upper = 5},
      {.name = "clean",
       .type = Type::choice,
       .help = "Take the voxels' noise away: bounded (least noise of normals within --within of the data), subdivision "
               "(decimation and sqrt(3) subdivision in turn), taubin, none.",
       .preset = "bounded",
       .choices = {"bounded", "subdivision", "taubin", "none"}},
      {.name = "within",
       .type = Type::text,
       .help = "bounded: how far a vertex may move from the data: a length, or a share of a voxel.",
       .metavar = "DISTANCE",
       .preset = "0.2voxel"},
      {.name = "faces",
       .type = Type::integer,
       .help = "Decimate to so many triangles. Default: as many as there are.",
       .metavar = "N",
       .lower = 4,
       .upper = 4e9},
      {.name = "index",
       .type = Type::number,
       .help = "Refractive index for the verdict on rays, and of the glass that enters the scene.",
       .preset = "1.5",
       .lower = 1,
       .upper = 5},
      {.name = "limit-distance",
       .type = Type::text,
       .help =
           "Exit with 2 where the mesh is farther from the data (root mean square): a length, or a share of a voxel.",
       .metavar = "DISTANCE"},
      {.name = "limit-bend",
       .type = Type::quantity,
       .help = "Exit with 2 where rays through the object are bent wrongly by more (root mean square).",
       .dimension = Dimension::angle,
       .lower = 0,
       .upper = 3.2},
      {.name = "reference",
       .type = Type::input_file,
       .help =
           "A mesh of the same object from elsewhere, in the volume's frame (PLY, metres): how far from it, and what "
           "rays through both say."},
      {.name = "surface",
       .type = Type::text,
       .help = "Name in surfaces of the object; a dielectric of --index where there is none of the name.",
       .metavar = "NAME",
       .preset = "glass"}};
}

// "0.2voxel", or a length.
Length length_of(const std::string& text, const char* option) {
  constexpr std::string_view unit = "voxel";
  Length length;
  if (!text.ends_with(unit)) {
    length.m = parse_quantity(text, Dimension::length, std::string("--") + option);
    if (!(*length.m > 0)) throw Error(Exit::usage, std::string("--") + option, "\"" + text + "\" is not positive");
    return length;
  }
  const std::string number = text.substr(0, text.size() - unit.size());
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), length.voxels);
  if (error != std::errc() || end != number.data() + number.size() || !(length.voxels > 0))
    throw Error(Exit::usage, std::string("--") + option, "\"" + text + "\" is neither a length nor a share of a voxel",
                "as in 20um or 0.2voxel");
  return length;
}

void threshold_asked(const std::string& text, Asked& a) {
  if (text == "gradient")
    a.threshold_by = ThresholdBy::gradient;
  else if (text == "materials")
    a.threshold_by = ThresholdBy::materials;
  else if (text == "otsu")
    a.threshold_by = ThresholdBy::otsu;
  else if (text == "reference")
    a.threshold_by = ThresholdBy::reference;
  else {
    a.threshold_by = ThresholdBy::value;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), a.threshold);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(a.threshold))
      throw Error(Exit::usage, "--threshold", "\"" + text + "\" is neither a value nor a way to find one",
                  "gradient, materials, otsu, reference, or a number");
  }
}

double core_of(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size())
    throw Error(Exit::usage, "--core", "\"" + text + "\" is no value", "give a number, or materials");
  return value;
}

}  // namespace

std::vector<cli::Option> options() {
  std::vector<cli::Option> all;
  for (const auto& part : {file_options(), surface_options(), mesh_options()})
    all.insert(all.end(), part.begin(), part.end());
  all.push_back({.name = "name",
                 .type = Type::text,
                 .help = "Of the volume, the mesh and the object. Default: the file's.",
                 .metavar = "NAME"});
  all.push_back({.name = "csv", .type = Type::output_file, .help = "Write the steps' figures as a table."});
  all.push_back(cli::report_option());
  return all;
}

Asked asked(const cli::Invocation& call) {
  Asked a;
  if (call.given("voxel")) a.file.spacing_m = spacing_of(call.text("voxel"));
  if (call.given("size")) a.file.size = counts_of<3>(call.text("size"), "size", "as in 512x512x400");
  if (call.given("type")) a.file.type = type_of(call.text("type"));
  a.file.big_endian = call.flag("big-endian");
  if (call.given("skip")) a.file.skip_bytes = static_cast<std::size_t>(call.integer("skip"));
  if (call.given("tiles")) a.file.tiles = counts_of<2>(call.text("tiles"), "tiles", "as in 16x16");
  a.file.accept_gap = call.flag("accept-gap");
  threshold_asked(call.text("threshold"), a);
  a.inside = call.text("connectivity") == "6" ? volume::Connectivity::six : volume::Connectivity::twenty_six;
  for (const std::string& what : call.texts("correct")) (what == "rings" ? a.rings : a.cupping) = true;
  const std::string& denoise = call.text("denoise");
  a.denoise = denoise == "anisotropic" ? volume::Denoise::anisotropic
              : denoise == "non-local" ? volume::Denoise::non_local
                                       : volume::Denoise::none;
  if (call.given("core")) {
    a.core_by_materials = call.text("core") == "materials";
    volume::SplitWish& split = a.split.emplace();
    split.reach = static_cast<std::size_t>(call.integer("reach"));
    if (!a.core_by_materials) split.core = core_of(call.text("core"));
  }
  a.keep.largest = static_cast<std::size_t>(call.integer("largest"));
  if (call.given("at-least")) a.keep.at_least_voxels = static_cast<std::uint64_t>(call.integer("at-least"));
  if (call.given("brighter")) a.keep.above_mean = call.number("brighter");
  if (call.given("darker")) a.keep.below_mean = call.number("darker");
  if (call.given("box")) a.keep.touching_box = box_of(call.text("box"));
  a.keep.drop_enclosed = call.flag("drop-enclosed"), a.keep.drop_touching_border = call.flag("drop-cut");
  a.find_markers = call.given("markers");
  if (a.find_markers && call.text("markers") != "any")
    a.marker_radius_m = 0.5 * parse_quantity(call.text("markers"), Dimension::length, "--markers");
  if (a.marker_radius_m && !(*a.marker_radius_m > 0))
    throw Error(Exit::usage, "--markers", "is not a positive diameter");
  if (call.given("marker-threshold")) a.marker_threshold = call.number("marker-threshold");
  if (a.threshold_by == ThresholdBy::reference && !a.marker_radius_m)
    throw Error(Exit::usage, "--threshold", "reference needs spheres of known diameter", "give --markers DIAMETER");
  a.eps = call.number("eps");
  const std::string& clean = call.text("clean");
  a.clean = clean == "subdivision" ? CleanBy::subdivision
            : clean == "taubin"    ? CleanBy::taubin
            : clean == "none"      ? CleanBy::none
                                   : CleanBy::bounded;
  a.within = length_of(call.text("within"), "within");
  if (call.given("limit-distance")) a.limit_distance = length_of(call.text("limit-distance"), "limit-distance");
  if (call.given("faces")) a.faces = static_cast<std::size_t>(call.integer("faces"));
  a.index = call.number("index");
  if (call.given("limit-bend")) a.limit_bend_rad = call.number("limit-bend");
  a.surface = call.text("surface");
  return a;
}

}  // namespace gonio::tools::ct_mesh_clean
