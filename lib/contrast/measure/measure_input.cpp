// The pattern, its two placements and their images, from the manifest (contrast/measure/measure_input.h).
#include "contrast/measure/measure_input.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "contrast/measure/matrix_code.h"
#include "contrast/measure/sample_outline.h"
#include "geom/luminance.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/pattern.h"
#include "photograph/linear_picture.h"
#include "photograph/mask.h"
#include "photograph/noise_variance.h"
#include "photograph/saturation.h"
#include "render/mechanisms/sensor_saturation.h"
#include "scene/mechanisms.h"

namespace gonio::contrast {
namespace {

const std::pair<const std::string, manifest::Pattern>& chosen(const manifest::Document& document,
                                                              const std::string& name) {
  const std::string place = manifest::place(document, "/patterns");
  if (document.patterns.empty())
    throw Error(Exit::data, place, "is empty: there is no pattern to measure",
                "enter its rows, columns, cell_m and placements (gonio-manifest(5))");
  if (name.empty()) {
    if (document.patterns.size() > 1)
      throw Error(Exit::usage, "--pattern",
                  "is needed: there are " + std::to_string(document.patterns.size()) + " patterns",
                  "name one: --pattern " + document.patterns.begin()->first);
    return *document.patterns.begin();
  }
  const auto found = document.patterns.find(name);
  if (found == document.patterns.end())
    throw Error(Exit::usage, "--pattern", "names \"" + name + "\", which is not in patterns",
                "there is \"" + document.patterns.begin()->first + "\"");
  return *found;
}

void enter_bits(const manifest::Document& document, const manifest::Pattern& section, Input& input,
                const MeasureOptions& options) {
  CellPattern& pattern = input.pattern;
  const std::string grid = std::to_string(pattern.rows) + " rows of " + std::to_string(pattern.columns) + " cells";
  if (!section.file.empty()) {
    const auto path = manifest::resolve(document, section.file, "/patterns/" + input.name + "/file");
    if (options.note_input) options.note_input(path);
    const Bits bits = read_bits(path);
    if (bits.rows != pattern.rows || bits.columns != pattern.columns)
      throw Error(Exit::data, path.string(),
                  "has " + std::to_string(bits.rows) + " rows of " + std::to_string(bits.columns) +
                      " cells, the pattern \"" + input.name + "\" has " + grid,
                  "correct rows and columns, or give the file of this pattern");
    pattern.bits = bits.bits;
  } else if (!section.text.empty()) {
    pattern.bits = write_matrix(section.text, pattern.rows, pattern.columns, input.place).modules.bits;
  }
  if (input.data_matrix && !matrix_size_exists(pattern.rows, pattern.columns))
    throw Error(Exit::data, input.place, "has " + grid + ", which no data matrix has",
                "data matrices are " + matrix_sizes() + "; other patterns are of kind grid");
  if (pattern.known() && (std::ranges::find(pattern.bits, 0) == pattern.bits.end() ||
                          std::ranges::find(pattern.bits, 1) == pattern.bits.end()))
    throw Error(Exit::data, input.place, "has cells of one kind only: there is nothing to compare",
                "give a pattern with cells of bit 1 and of bit 0");
}

std::vector<std::size_t> images_of(const manifest::Document& document, const manifest::PatternPlacement& placement,
                                   const std::string& place) {
  std::vector<std::size_t> images;
  for (const std::string& id : placement.images) {
    const auto listed = manifest::index_of_image(document, id);
    if (!listed)
      throw Error(Exit::data, place + "/images", "names \"" + id + "\", which is not in images",
                  document.images.empty() ? "" : "the first image is \"" + document.images.front().id + "\"");
    images.push_back(*listed);
  }
  if (placement.images.empty())
    for (std::size_t i = 0; i < document.images.size(); ++i)
      if (document.images[i].group == placement.name) images.push_back(i);
  if (images.empty())
    throw Error(Exit::data, place, "has no image of the placement \"" + placement.name + "\"",
                "list its images, or give those images \"group\": \"" + placement.name + "\"");
  return images;
}

double largest(const std::vector<double>& numbers, double preset) {
  return numbers.empty() ? preset : *std::ranges::max_element(numbers);
}

// From where the image was taken: its pose in the world, or else through the board that it shows, which then is the
// world.
std::optional<CameraPose> camera_pose(const manifest::ImageEntry& image, const MeasureOptions& options) {
  if (image.world_from_camera) {
    CameraPose pose{inverse(static_cast<const Rigid<frame::World, frame::Camera>&>(*image.world_from_camera)),
                    options.robot_sigma_rad, options.robot_sigma_m};
    if (image.world_from_camera->sigma) {
      pose.sigma_rad = largest(image.world_from_camera->sigma->rotation_rad, pose.sigma_rad);
      pose.sigma_m = largest(image.world_from_camera->sigma->translation_m, pose.sigma_m);
    }
    return pose;
  }
  if (!image.camera_from_board) return std::nullopt;
  CameraPose pose{{image.camera_from_board->rotation, image.camera_from_board->translation_m},
                  options.robot_sigma_rad,
                  options.robot_sigma_m};
  if (image.camera_from_board->sigma) {
    pose.sigma_rad = largest(image.camera_from_board->sigma->rotation_rad, pose.sigma_rad);
    pose.sigma_m = largest(image.camera_from_board->sigma->translation_m, pose.sigma_m);
  }
  return pose;
}

double full_scale_of(const manifest::Document& document, const std::string& camera, const MeasureOptions& options) {
  const mechanism::Mechanism& saturation = mechanism::sensor_saturation();
  const auto use = document.mechanisms.find(saturation.id);
  if (use == document.mechanisms.end()) return options.full_scale;
  const auto amounts =
      scene::camera_amounts(saturation, use->second, camera, manifest::place(document, "/mechanisms/" + saturation.id));
  return amounts ? std::min(options.full_scale, amounts->front()) : options.full_scale;
}

InputView view_of(const manifest::Document& document, std::size_t image, int placement,
                  const std::vector<CornerMark>& marks, const MeasureOptions& options) {
  const manifest::ImageEntry& entry = document.images[image];
  InputView view;
  view.image = image;
  view.id = entry.id;
  view.place = manifest::place(document, "/images/" + std::to_string(image));
  view.lights = entry.light;
  view.placement = placement;
  if (entry.file.empty())
    throw Error(Exit::data, view.place, "has no file: there is no picture \"" + entry.id + "\" to measure",
                "render or photograph it first, and enter the file");
  if (const manifest::Camera* camera = find_camera(document, entry.camera))
    view.camera.emplace(*camera, manifest::place(document, "/cameras/" + entry.camera));
  if (view.camera) view.pose = camera_pose(entry, options);
  view.full_scale = full_scale_of(document, entry.camera, options);
  for (const CornerMark& mark : marks)
    if (mark.image == entry.id)
      view.marks.push_back({0, mark.corner, mark.pixel, mark.sigma_px > 0 ? mark.sigma_px : options.corner_sigma_px});
  return view;
}

SamplePose stated_pose(const manifest::Pose<frame::World, frame::Object>& stated) {
  SamplePose pose;
  pose.world_from_pattern = stated;
  pose.stated = true;
  const double turn = stated.sigma ? largest(stated.sigma->rotation_rad, 0) : 0;
  const double shift = stated.sigma ? largest(stated.sigma->translation_m, 0) : 0;
  for (std::size_t k = 0; k < 6; ++k) pose.covariance[7 * k] = k < 3 ? turn * turn : shift * shift;
  return pose;
}

// Through the sample's pose where the camera's is known, else through the four corners marked in the image itself.
void place_views(const CellPattern& pattern, const std::optional<SamplePose>& pose, int placement, Input& input) {
  for (InputView& view : input.views) {
    if (view.placement != placement) continue;
    if (pose && view.pose) {
      view.map.emplace(*view.camera, view.pose->camera_from_world * pose->world_from_pattern);
      view.spread = place_covariance(pattern, *view.camera, *view.pose, *pose);
    } else if (view.marks.size() == 4) {
      std::array<Vec2, 4> corners, pixels;
      for (const PlacedMark& mark : view.marks) {
        corners[static_cast<std::size_t>(mark.corner)] = pattern.corner_m(mark.corner);
        pixels[static_cast<std::size_t>(mark.corner)] = mark.pixel;
        for (std::size_t k = 0; k < 2; ++k)
          view.spread[9 * (2 * static_cast<std::size_t>(mark.corner) + k)] = mark.sigma_px * mark.sigma_px;
      }
      view.map.emplace(homography(corners, pixels));
    } else {
      input.dropped.push_back(view.id +
                              ": neither a camera pose nor four marked corners say where the sample lies in it" +
                              (view.no_outline.empty() ? "" : "; " + view.no_outline));
    }
  }
}

// Marks from outlines, in views of the placement that have none and need them: those without a pose, and where nothing
// says where the sample lies, those with one.
void mark_outlines(const manifest::Document& document, const MeasureOptions& options, bool stated, int placement,
                   Input& input) {
  const bool marked = std::ranges::any_of(input.views, [&](const InputView& view) {
    return view.placement == placement && view.pose && !view.marks.empty();
  });
  int found = 0, looked = 0;
  double sigma_px = 0;
  for (InputView& view : input.views) {
    if (view.placement != placement || !view.marks.empty() || (view.pose && (stated || marked))) continue;
    ++looked;
    const GreyView grey = read_view(document, view, options);
    OutlineFound outline = find_outline(grey, view.camera, std::max(input.pattern.rows, input.pattern.columns));
    if (outline.corners) outline = number_corners(grey, input.pattern, input.data_matrix, *outline.corners);
    view.no_outline = outline.corners ? "" : outline.problem;
    if (!outline.corners) continue;
    for (std::size_t k = 0; k < 4; ++k) {
      view.marks.push_back({0, static_cast<int>(k), outline.corners->pixel[k], outline.corners->sigma_px[k]});
      sigma_px = std::max(sigma_px, outline.corners->sigma_px[k]);
    }
    ++found;
  }
  if (found > 0)
    input.notes.push_back(
        format("corners of \"%s\" were taken from the sample's outline in %d of %d images, to %.2g px "
               "or better: the pattern must reach the sample's edge",
               input.placement[static_cast<std::size_t>(placement)].c_str(), found, looked, sigma_px));
}

// The reason of the first view without an outline, for messages.
std::string why_no_outline(const Input& input, int placement) {
  for (const InputView& view : input.views)
    if (view.placement == placement && !view.no_outline.empty()) return " (" + view.id + ": " + view.no_outline + ")";
  return "";
}

void locate(const manifest::Document& document, const manifest::Pattern& section, int placement, Input& input) {
  const auto& stated = section.placements[static_cast<std::size_t>(placement)];
  auto& pose = input.pose[static_cast<std::size_t>(placement)];
  std::vector<camera::CameraModel> cameras;
  std::vector<CameraPose> poses;
  std::vector<PlacedMark> marks;
  bool posed = false;
  for (const InputView& view : input.views) {
    if (view.placement != placement || !view.pose) continue;
    posed = true;
    if (view.marks.empty()) continue;
    for (PlacedMark mark : view.marks) {
      mark.image = cameras.size();
      marks.push_back(mark);
    }
    cameras.push_back(*view.camera);
    poses.push_back(*view.pose);
  }
  if (stated.world_from_pattern)
    pose = stated_pose(*stated.world_from_pattern);
  else if (!marks.empty()) {
    if (!(input.pattern.cell_m.x > 0) || section.cell_m.empty())
      throw Error(Exit::data, input.place, "has no cell_m: the sample's size is needed to place it in the world",
                  "state width and height of a cell in metres");
    const std::string place =
        manifest::place(document, "/patterns/" + input.name + "/placements/" + std::to_string(placement));
    pose = locate_sample(input.pattern, cameras, poses, marks, place);
  } else if (posed) {
    throw Error(Exit::data,
                manifest::place(document, "/patterns/" + input.name + "/placements/" + std::to_string(placement)),
                "has neither world_from_pattern nor a marked corner in any image of \"" + stated.name + "\"" +
                    why_no_outline(input, placement),
                "mark the four corners in one or a few of its images (--corners FILE)");
  }
  place_views(input.pattern, pose, placement, input);
  const auto is_placed = [&](const InputView& view) { return view.placement == placement && view.map; };
  if (std::ranges::none_of(input.views, is_placed))
    throw Error(Exit::data, input.place,
                "has no image of \"" + stated.name + "\" in which the sample's place is known" +
                    why_no_outline(input, placement),
                "mark its four corners (--corners FILE), or state cameras and poses");
}

}  // namespace

Input read_input(const manifest::Document& document, const std::string& name, const std::vector<CornerMark>& marks,
                 const MeasureOptions& options) {
  const auto& [id, section] = chosen(document, name);
  Input input;
  input.name = id;
  input.place = manifest::place(document, "/patterns/" + id);
  input.data_matrix = section.kind == "data-matrix";
  input.pattern.rows = section.rows;
  input.pattern.columns = section.columns;
  const std::vector<double>& cell = section.cell_m;
  if (cell.size() > 2)
    throw Error(Exit::data, input.place + "/cell_m", "has more than two numbers", "width and height");
  input.pattern.cell_m = cell.empty() ? Vec2{1e-3, 1e-3} : Vec2{cell.front(), cell.back()};
  enter_bits(document, section, input, options);
  if (section.placements.size() != 2)
    throw Error(Exit::data, input.place + "/placements",
                "has " + std::to_string(section.placements.size()) + " placements",
                "contrast is measured before and after the sample was turned: enter these two");
  std::vector<CornerMark> all =
      section.corners.empty() ? std::vector<CornerMark>() : table_marks(document, section.corners);
  all.insert(all.end(), marks.begin(), marks.end());
  check_marks(all);
  for (int k = 0; k < 2; ++k) {
    const auto& placement = section.placements[static_cast<std::size_t>(k)];
    input.placement[static_cast<std::size_t>(k)] = placement.name;
    for (const std::size_t image : images_of(document, placement, input.place + "/placements/" + std::to_string(k))) {
      if (std::ranges::find(input.views, image, &InputView::image) != input.views.end())
        throw Error(Exit::data, input.place + "/placements/" + std::to_string(k),
                    "has the image \"" + document.images[image].id + "\" once more",
                    "an image shows the sample as it lay once");
      input.views.push_back(view_of(document, image, k, all, options));
    }
  }
  for (int k = 0; k < 2; ++k) {
    mark_outlines(document, options, section.placements[static_cast<std::size_t>(k)].world_from_pattern.has_value(), k,
                  input);
    locate(document, section, k, input);
  }
  std::erase_if(input.views, [](const InputView& view) { return !view.map; });
  return input;
}

GreyView read_view(const manifest::Document& document, const InputView& view, const MeasureOptions& options) {
  const manifest::ImageEntry& entry = document.images[view.image];
  const auto path = manifest::picture_path(document, view.image);
  if (options.note_input) options.note_input(path);
  const photograph::LinearPicture picture = photograph::read_linear(path, entry.response, view.place, entry.saturation);
  const io::Image& colour = picture.colour;
  if (view.camera && (colour.width != view.camera->width_px() || colour.height != view.camera->height_px()))
    throw Error(Exit::data, path.string(),
                format("has %d x %d px, its camera \"%s\" %d x %d px", colour.width, colour.height,
                       entry.camera.c_str(), view.camera->width_px(), view.camera->height_px()),
                "give the picture as the calibrated camera took it, neither cropped nor scaled");
  const std::size_t channels = colour.channels.size();
  GreyView grey{colour.width, colour.height, std::vector<float>(colour.pixels()), {}, picture.clipped, {}};
  const bool has_variance = picture.variance.pixels() == colour.pixels();
  if (has_variance || entry.noise) grey.variance.assign(colour.pixels(), 0);
  for (std::size_t i = 0; i < colour.pixels(); ++i)
    for (std::size_t c = 0; c < channels; ++c) {
      const float v = colour.data[i * channels + c];
      const float w = channels == 3 ? static_cast<float>(luminance_weights[c]) : 1.0f;
      grey.value[i] += w * v;
      if (has_variance) grey.variance[i] += w * w * picture.variance.data[i * channels + c];
      if (entry.noise) grey.variance[i] += w * w * static_cast<float>(photograph::noise_variance(*entry.noise, v));
      if (photograph::at_full_scale(v, view.full_scale)) grey.saturated[i] = 1;
    }
  if (const auto mask_file = manifest::mask_path(document, view.image); !mask_file.empty())
    grey.counts = photograph::read_mask_of(colour, mask_file, view.place + "/mask");
  return grey;
}

}  // namespace gonio::contrast
