// Field tables of the sections that most manifests have: files, frames, boards, cameras, images, objects, pictures.
#include <algorithm>

#include "base/error.h"
#include "manifest/field_makers.h"
#include "manifest/section_tables.h"
#include "manifest/sections/board.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/comparison.h"
#include "manifest/sections/file.h"
#include "manifest/sections/frame_link.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/rendering.h"
#include "manifest/sections/table.h"

namespace gonio::manifest {
namespace {

std::vector<std::string> words_of(const auto& names) {
  return {names.begin(), names.end()};
}

Value shape_schema(const char* key, Value schema) {
  return object_schema(Value::object({{key, std::move(schema)}}), {key});
}

}  // namespace

const std::vector<Field<File>>& file_fields() {
  static const std::vector<Field<File>> table{
      field("path", &File::path, "", "where it lies, relative to the manifest's folder, with forward slashes").needed(),
      field("bytes", &File::bytes, "B", "its size; checked before it is read"),
      field("sha256", &File::sha256, "", "its SHA-256, 64 hexadecimal digits; checked before it is used")};
  return table;
}

const std::vector<Field<Link>>& link_fields() {
  static const std::vector<Field<Link>> table{
      field("to", &Link::to, "", "frame in which the result is expressed").needed(),
      field("from", &Link::from, "", "frame in which the argument is expressed").needed(),
      field("rotation", &Link::rotation, "", "unit quaternion [w, x, y, z]"),
      field("translation_m", &Link::translation_m, "m", "origin of `from`, in `to`"),
      field("sigma", &Link::sigma, "", "one standard deviation of the motion")};
  return table;
}

const std::vector<Field<Board>>& board_fields() {
  static const std::vector<Field<Board>> table{
      field("kind", &Board::kind, "", "checkerboard or charuco").one_of({"checkerboard", "charuco"}).needed(),
      field("inner_corners", &Board::inner_corners, "", "checkerboard: columns and rows of inner corners")
          .range(2, 1000),
      field("squares", &Board::squares, "", "charuco: columns and rows of squares").range(2, 1000),
      field("square_m", &Board::square_m, "m", "side of a square").positive().needed(),
      field("marker_m", &Board::marker_m, "m", "charuco: side of a marker").positive(),
      field("dictionary", &Board::dictionary, "", "charuco: 4X4_50, 5X5_1000, ..."),
      field("legacy_layout", &Board::legacy_layout, "",
            "charuco: the layout of OpenCV before 4.6; left out: found from the pictures"),
      field("warp", &Board::warp, "m", "board.warp: sag_x_m and sag_y_m of the middle against the edges"),
      sigma_field(&Board::sigma),
      field("dictionary_file", &Board::dictionary_file, "", "charuco: file id of a dictionary of one's own"),
      field("flatness_m", &Board::flatness_m, "m", "estimated peak to valley height over the corners")
          .range(0, infinite)};
  return table;
}

const std::vector<Field<CameraQuality>>& camera_quality_fields() {
  static const std::vector<Field<CameraQuality>> table{
      field("predicts_within_px", &CameraQuality::predicts_within_px, "px",
            "at 95 %, over the image at the distances below; what the fit's covariance expects")
          .range(0, infinite),
      field("distances_m", &CameraQuality::distances_m, "m", "from the camera"),
      field("halves_differ_px", &CameraQuality::halves_differ_px, "px",
            "root mean square over the image of the difference between calibrations of either half of the views")
          .range(0, infinite),
      field("halves_expected_px", &CameraQuality::halves_expected_px, "px", "what their covariances expect of it")
          .range(0, infinite),
      field("halves_agree", &CameraQuality::halves_agree, "", "false: something is not modelled"),
      field("coverage", &CameraQuality::coverage, "", "share of the image that corners reach").range(0, 1),
      field("next", &CameraQuality::next, "", "what to photograph next, one sentence each"),
      field("files", &CameraQuality::files, "", "maps and pictures by name: projection-sigma, ...; file ids")};
  return table;
}

const std::vector<Field<Camera>>& camera_fields() {
  static const std::vector<Field<Camera>> table{
      field("model", &Camera::model, "", "how rays map to pixels")
          .one_of({"pinhole", "radial-tangential", "rational", "thin-prism", "fisheye", "orthographic"}),
      field("width_px", &Camera::width_px, "px", "columns").range(1, 1 << 20),
      field("height_px", &Camera::height_px, "px", "rows").range(1, 1 << 20),
      field("fx_px", &Camera::fx_px, "px", "focal length along x").positive(),
      field("fy_px", &Camera::fy_px, "px", "focal length along y").positive(),
      field("cx_px", &Camera::cx_px, "px", "principal point; pixel centres lie at integers"),
      field("cy_px", &Camera::cy_px, "px", "principal point; pixel centres lie at integers"),
      field("px_per_m", &Camera::px_per_m, "px/m", "orthographic: pixels per metre").positive(),
      field("distortion", &Camera::distortion, "", "coefficients by name, left out: 0"),
      sigma_field(&Camera::sigma),
      field("rms_px", &Camera::rms_px, "px", "root mean square of the reprojection error of the fit")
          .range(0, infinite),
      field("covariance", &Camera::covariance, "", "of the fit: {\"order\": [names], \"values\": [[...]]}"),
      field("quality", &Camera::quality, "", "how well it predicts pixels"),
      field("held", &Camera::held, "",
            "true: calibrated on other views (--fix intrinsics); explain keeps to its sigmas"),
      field("mosaic", &Camera::mosaic, "",
            "filters over the pixels; polarizers: [90 45; 135 0] degrees, rows from the top")
          .one_of({"RGGB", "GRBG", "GBRG", "BGGR", "polarizers"})};
  return table;
}

const std::vector<Field<SeenBoard>>& seen_board_fields() {
  static const std::vector<Field<SeenBoard>> table{
      field("board", &SeenBoard::board, "", "name of the board").needed(),
      field("camera_from_board", &SeenBoard::camera_from_board, "", "takes board to camera coordinates"),
      field("rms_px", &SeenBoard::rms_px, "px", "root mean square of the reprojection error").range(0, infinite),
      field("weight", &SeenBoard::weight, "", "in fits; 0: dropped").range(0, 1)};
  return table;
}

const std::vector<Field<DevelopedStep>>& developed_step_fields() {
  static const std::vector<Field<DevelopedStep>> table{
      field("step", &DevelopedStep::step, "", "what was done").one_of(words_of(develop_step::all)).needed(),
      field("by", &DevelopedStep::by, "",
            "demosaic: bilinear or gradient; colour: name of the correction; undistort: kernel of the interpolation"),
      field("frames", &DevelopedStep::frames, "", "how many it is made of: dark, flat, or exposures that were merged")
          .range(1, infinite),
      field("exposures_s", &DevelopedStep::exposures_s, "s", "merge: exposure times as they were used").positive(),
      sigma_field(&DevelopedStep::sigma)};
  return table;
}

const std::vector<Field<ImageEntry>>& image_fields() {
  static const std::vector<Field<ImageEntry>> table{
      field("id", &ImageEntry::id, "", "name, unique among images").needed(),
      field("file", &ImageEntry::file, "", "file id of the recording"),
      field("camera", &ImageEntry::camera, "", "name of its camera"),
      field("world_from_camera", &ImageEntry::world_from_camera, "",
            "takes camera to world coordinates; left out: identity"),
      custom<ImageEntry>(
          "light", "", "name or names of the lights that are on; left out: all of the scene", defined("names"),
          [](ImageEntry& r, const Value& v, const std::string& place) { r.light = read_names(v, place); },
          [](const ImageEntry& r) {
            return r.light.empty() ? Value() : r.light.size() == 1 ? Value(r.light[0]) : Value(r.light);
          }),
      field("dark", &ImageEntry::dark, "", "true: no light of the scene is on"),
      field("exposure_s", &ImageEntry::exposure_s, "s", "exposure time").positive(),
      field("f_number", &ImageEntry::f_number, "", "of the aperture, as the lens says").positive(),
      field("time_s", &ImageEntry::time_s, "s", "when it was taken, counted from any moment common to all images"),
      field("temperature_K", &ImageEntry::temperature_K, "K", "of the instrument at that moment").positive(),
      field("saturation", &ImageEntry::saturation, "",
            "stored value from which on a pixel is saturated, 1 for a file's highest code; left out: that code")
          .positive(),
      field("response", &ImageEntry::response, "", "linear, srgb, or a table [[code, linear], ...]"),
      field("mask", &ImageEntry::mask, "", "file id; pixels above 0.5 count"),
      field("board", &ImageEntry::board, "", "name of the board it shows"),
      field("camera_from_board", &ImageEntry::camera_from_board, "", "takes board to camera coordinates"),
      field("rms_px", &ImageEntry::rms_px, "px", "root mean square of the reprojection error in this image")
          .range(0, infinite),
      field("weight", &ImageEntry::weight, "", "in fits; 0: dropped").range(0, 1),
      field("noise", &ImageEntry::noise, "", "of a linear value v: variance v / gain + read^2"),
      field("gain", &ImageEntry::gain, "", "factor on the simulated radiance; free: unknown exposure"),
      field("group", &ImageEntry::group, "", "recordings that belong together are held out together"),
      field("shot", &ImageEntry::shot, "", "images of a rig's cameras taken at the same moment share it"),
      field("robot", &ImageEntry::robot, "", "name of the robot that held the tool"),
      field("base_from_tool", &ImageEntry::base_from_tool, "",
            "takes tool to robot base coordinates, as the controller said"),
      field("joints_rad", &ImageEntry::joints_rad, "rad", "joint angles of the robot"),
      field("shapes", &ImageEntry::shapes, "",
            "by object: how far it was through its mesh's shapes, 0 the first, 1 the last; left out: at the first"),
      field("projection", &ImageEntry::projection, "", "what the projector shows in it: name in projections"),
      field("shows", &ImageEntry::shows, "", "place in the frames of the projection, from 0").range(0, 4095),
      field("boards", &ImageEntry::boards, "", "instead of board, where it shows several: one entry each"),
      field(
          "developed", &ImageEntry::developed, "",
          "what was done to the picture on the way from the sensor, in order; left out: nothing, or it is not known")};
  return table;
}

const std::vector<Field<Mesh>>& mesh_fields() {
  const auto nested = [](const Value& v, const char* key, const std::string& place) -> const Value& {
    expect_object(v, place);
    for (const auto& [name, member] : v.as_object())
      if (name != key && !name.starts_with("x-")) unknown_key(name, {key}, place);
    if (v.find(key) == nullptr) missing_key(key, "the shape's size", place);
    return *v.find(key);
  };
  static const std::vector<Field<Mesh>> table{
      field("file", &Mesh::file, "", "file id of a PLY mesh"),
      custom<Mesh>(
          "sphere", "", "{\"radius_m\": r}: a sphere about the object's origin",
          shape_schema("radius_m", Value::object({{"type", "number"}, {"exclusiveMinimum", 0}})),
          [nested](Mesh& m, const Value& v, const std::string& place) {
            const Value& r = nested(v, "radius_m", place);
            m.sphere_radius_m = Codec<double>::read(r, place + "/radius_m");
            check_range(r, tiny, infinite, "m", place + "/radius_m");
          },
          [](const Mesh& m) {
            return m.sphere_radius_m ? Value::object({{"radius_m", *m.sphere_radius_m}}) : Value();
          }),
      custom<Mesh>(
          "plane", "", "{\"size_m\": [x, y]}: a rectangle in its own xy plane about its origin, normal +z",
          shape_schema("size_m", Codec<std::vector<double>>::schema()),
          [nested](Mesh& m, const Value& v, const std::string& place) {
            const Value& s = nested(v, "size_m", place);
            m.plane_size_m = Codec<std::vector<double>>::read(s, place + "/size_m");
            check_range(s, tiny, infinite, "m", place + "/size_m");
            if (m.plane_size_m->size() != 2) wrong_type(s, "two lengths [x, y]", place + "/size_m");
          },
          [](const Mesh& m) {
            return m.plane_size_m ? Value::object({{"size_m", *m.plane_size_m}}) : Value();
          }),
      field(
          "shapes", &Mesh::shapes, "",
          "of a thing that deforms: file ids of PLY meshes with the vertices of `file` at other places, one after the "
          "other; an image's `shapes` says how far it is through them, straight lines between; left out: rigid"),
      field("normals", &Mesh::normals, "", "smooth (the file's, else averaged by area and angle) or flat")
          .one_of({"smooth", "flat"})};
  return table;
}

const std::vector<Field<Object>>& object_fields() {
  static const std::vector<Field<Object>> table{field("id", &Object::id, "", "name, unique among objects").needed(),
                                                field("mesh", &Object::mesh, "", "name of its mesh").needed(),
                                                field("surface", &Object::surface, "", "name of its surface").needed(),
                                                field("world_from_object", &Object::world_from_object, "",
                                                      "takes object to world coordinates; left out: identity"),
                                                field("priority", &Object::priority, "",
                                                      "where objects that let light through overlap, the highest one "
                                                      "fills the space; default 0")};
  return table;
}

const std::vector<Field<Table>>& table_fields() {
  static const std::vector<Field<Table>> table{
      field("file", &Table::file, "", "file id of a CSV file with a header line"),
      field("rows", &Table::rows, "", "the rows themselves, [[...], ...], in the order of `columns`"),
      field("model", &Table::model, "",
            "forward model that predicts it: camera, surface, sensor, light, volume, tracks, markers, temperature or "
            "expression"),
      custom<Table>(
          "columns", "", "name to unit, in the file's order", Codec<std::map<std::string, std::string>>::schema(),
          [](Table& t, const Value& v, const std::string& place) {
            expect_object(v, place);
            for (const auto& [name, unit] : v.as_object())
              t.columns.emplace_back(name, Codec<std::string>::read(unit, place + "/" + name));
          },
          [](const Table& t) {
            Value out;
            for (const auto& [name, unit] : t.columns) out[name] = unit;
            return out;
          }),
      field("observed", &Table::observed, "", "columns that were measured"),
      field("sigma", &Table::sigma, "", "columns with one standard deviation of them"),
      field("camera", &Table::camera, "", "model camera: name of the camera"),
      field("board", &Table::board, "", "model camera: name of the board"),
      field("surface", &Table::surface, "", "model surface: name of the surface"),
      field("light", &Table::light, "", "model light: name of the light"),
      field("group", &Table::group, "", "column whose equal values are held out together"),
      field("block", &Table::block, "", "column whose equal values share their noise; left out: single rows"),
      field("expression", &Table::expression, "", "model expression: a*cos(theta)+b over columns and parameters"),
      field("parameters", &Table::parameters, "", "of the forward model"),
      field("parameter_sigma", &Table::sigmas, "", "one standard deviation of fitted parameters, by name")};
  return table;
}

const std::vector<Field<Rendering>>& rendering_fields() {
  static const std::vector<Field<Rendering>> table{
      field("image", &Rendering::image, "", "id of the image that was simulated").needed(),
      field("file", &Rendering::file, "", "file id of the EXR").needed(),
      field("spp", &Rendering::spp, "", "samples per pixel").range(1, 1e9),
      field("seed", &Rendering::seed, "", "of the random numbers"),
      field("samples", &Rendering::samples, "", "[A, B]: holds samples A to B - 1 of every pixel; left out: all"),
      field("relative_error", &Rendering::relative_error, "", "estimated, of the mean pixel").range(0, infinite),
      field("wavelengths_m", &Rendering::wavelengths_m, "m", "of spectral renderings: centres of the bins"),
      field("files", &Rendering::files, "", "further pictures by kind; file ids")};
  return table;
}

const std::vector<Field<Comparison>>& comparison_fields() {
  static const std::vector<Field<Comparison>> table{
      field("image", &Comparison::image, "", "id of the image").needed(),
      field("exposure_scale", &Comparison::exposure_scale, "", "factor on the rendering that was fitted"),
      field("rmse", &Comparison::rmse, "", "root mean square difference, in the recording's unit"),
      field("relative_rmse", &Comparison::relative_rmse, "", "rmse over the root mean square of the recording"),
      field("ssim", &Comparison::ssim, "", "mean structural similarity (Wang et al. 2004)"),
      field("log10_error", &Comparison::log10_error, "",
            "mean of log10 |difference|, floor 1e-4 of the recording's rms"),
      field("z_rms", &Comparison::z_rms, "", "root mean square of difference over its standard deviation"),
      field("z_above_3", &Comparison::z_above_3, "", "share of samples more than three standard deviations off"),
      field("not_finite", &Comparison::not_finite, "",
            "pixels with a NaN or an infinity; every measure is then left out"),
      field("pixels", &Comparison::pixels, "", "pixels that counted"),
      sigma_field(&Comparison::sigma),
      field("files", &Comparison::files, "", "file ids of what was written beside it")};
  return table;
}

GONIO_RECORD(File, file_fields);
GONIO_RECORD(Link, link_fields);
GONIO_RECORD(Board, board_fields);
GONIO_RECORD(CameraQuality, camera_quality_fields);
GONIO_RECORD(Camera, camera_fields);
GONIO_RECORD(SeenBoard, seen_board_fields);
GONIO_RECORD(DevelopedStep, developed_step_fields);
GONIO_RECORD(ImageEntry, image_fields);
GONIO_RECORD(Mesh, mesh_fields);
GONIO_RECORD(Object, object_fields);
GONIO_RECORD(Table, table_fields);
GONIO_RECORD(Rendering, rendering_fields);
GONIO_RECORD(Comparison, comparison_fields);

}  // namespace gonio::manifest
