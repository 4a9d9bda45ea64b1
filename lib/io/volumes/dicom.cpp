// A series of DICOM files: a folder of them, or one file, whose series is taken from its folder; or one file of many
// frames. Slices are put in order by their places along the normal, never by name (PS3.3, C.7.6.2.1.1: normal = row x
// column, and places are those of the first pixel's centre). Lengths are millimetres by the standard.
//
// What does not make one rectangular grid is refused: several series, sizes, types, spacings, orientations or scales;
// slices that are missing, twice there, or shifted sideways (a tilted gantry).
#include <algorithm>
#include <cmath>
#include <map>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/text.h"
#include "io/dicom_head.h"
#include "io/dicom_pixels.h"
#include "io/volume_bytes.h"
#include "io/volume_grid.h"
#include "io/volume_samples.h"

namespace gonio::io::volumes {
namespace {

constexpr double same_direction = 1e-4, same_step = 1e-2;  // the latter of the step, or of a pixel sideways

bool is_dicom_file(const std::filesystem::path& file) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(file, ignored) && begins_as_dicom(beginning_of_file(file, 132));
}

std::vector<std::filesystem::path> dicom_files_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code failure;
  for (std::filesystem::directory_iterator at(folder.empty() ? "." : folder, failure), end; !failure && at != end;
       at.increment(failure))
    if (at->path().filename() != "DICOMDIR" && is_dicom_file(at->path())) files.push_back(at->path());
  if (failure) throw Error(Exit::no_input, folder.string(), failure.message(), "check its permissions");
  std::sort(files.begin(), files.end());
  return files;
}

bool may_be_dicom(const std::filesystem::path& path, std::string_view beginning, const VolumeWish&) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(path, ignored)) return begins_as_dicom(beginning);
  return !dicom_files_in(path).empty();
}

void refuse_fault(const DicomFile& file) {
  if (!file.fault.empty()) refuse_volume(file.path.string(), file.fault, file.remedy);
}

// The series of one file; its neighbours' faults matter where they belong to it.
std::vector<DicomFile> series_of_file(const std::filesystem::path& path) {
  std::vector<DicomFile> series{read_dicom_head(path)};
  refuse_fault(series[0]);
  if (series[0].series.empty() || series[0].frames > 1) return series;
  for (const auto& other : dicom_files_in(path.parent_path())) {
    std::error_code ignored;
    if (std::filesystem::equivalent(other, path, ignored)) continue;
    DicomFile file = read_dicom_head(other);
    if (file.series != series[0].series) continue;
    refuse_fault(file);
    series.push_back(std::move(file));
  }
  return series;
}

std::vector<DicomFile> series_of_folder(const std::filesystem::path& folder) {
  std::vector<DicomFile> files;
  std::map<std::string, std::pair<std::size_t, std::string>> found;  // how many, and the first one's name
  for (const auto& path : dicom_files_in(folder)) {
    files.push_back(read_dicom_head(path));
    refuse_fault(files.back());
    auto& [count, first] = found[files.back().series];
    if (count++ == 0) first = path.filename().string();
  }
  if (found.size() > 1) {
    std::string each;
    for (const auto& [series, of] : found)
      each += (each.empty() ? "" : ", ") + of.second + " begins one of " + std::to_string(of.first);
    refuse_volume(folder.string(), "holds " + std::to_string(found.size()) + " series: " + each,
                  "name one file of the series that you mean");
  }
  return files;
}

void check_alike(const DicomFile& first, const DicomFile& other) {
  const auto differ = [&](const std::string& what, const std::string& a, const std::string& b) {
    refuse_volume(other.path.string(),
                  "has " + what + " " + b + ", and " + first.path.filename().string() + " of its series " + a,
                  "leave out what is no slice of the volume");
  };
  const auto size = [](const DicomFile& f) { return std::to_string(f.columns) + " x " + std::to_string(f.rows); };
  if (first.rows != other.rows || first.columns != other.columns) differ("pixels", size(first), size(other));
  if (first.type() != other.type()) differ("samples", name_of(first.type()), name_of(other.type()));
  for (const DicomFile* file : {&first, &other})
    if (file->frames > 1)
      refuse_volume(file->path.string(), "has several frames, and is not alone in its folder's series",
                    "name it itself");
  const auto spacing = [](const DicomFile& f) {
    return f.spacing_mm ? format("%.6g x %.6g mm", (*f.spacing_mm)[1], (*f.spacing_mm)[0]) : std::string("unsaid");
  };
  const auto off = [](double a, double b) { return std::abs(a - b) > 1e-5 * std::abs(a); };
  if (first.spacing_mm.has_value() != other.spacing_mm.has_value() ||
      (first.spacing_mm &&
       (off((*first.spacing_mm)[0], (*other.spacing_mm)[0]) || off((*first.spacing_mm)[1], (*other.spacing_mm)[1]))))
    differ("a spacing of pixels of", spacing(first), spacing(other));
  if (first.directions && other.directions)
    for (std::size_t a = 0; a < 2; ++a)
      if (norm((*first.directions)[a] - (*other.directions)[a]) > same_direction) {
        const auto text = [&](Vec3 v) { return format("(%.5g, %.5g, %.5g)", v.x, v.y, v.z); };
        differ(a == 0 ? "rows along" : "columns along", text((*first.directions)[a]), text((*other.directions)[a]));
      }
}

struct Stack {
  std::vector<DicomFile> files;  // in order
  StatedGrid grid;
};

Mat3 axes_of(const DicomFile& file) {
  const auto [u, v] = *file.directions;
  if (std::abs(norm(u) - 1) > 1e-3 || std::abs(norm(v) - 1) > 1e-3)
    refuse_volume(file.path.string(), "states directions of rows and columns that have not the length 1");
  const Vec3 i = normalized(u), j = normalized(v), k = normalized(cross(i, j));
  return {{i.x, j.x, k.x, i.y, j.y, k.y, i.z, j.z, k.z}};
}

// A file of many frames, or one slice alone: the step along the normal only where it is stated.
StatedGrid grid_of_one(const DicomFile& file, VolumeHead& head) {
  StatedGrid grid{.unit_m = 1e-3};
  double step = file.between_mm.value_or(0);
  if (file.frames > 1 && file.offsets_mm.size() == file.frames) {
    step = file.offsets_mm[1] - file.offsets_mm[0];
    for (std::size_t f = 1; f < file.frames; ++f)
      if (std::abs(file.offsets_mm[f] - file.offsets_mm[f - 1] - step) > same_step * std::abs(step))
        refuse_volume(file.path.string(),
                      "has frames " + std::to_string(f) + " and " + std::to_string(f + 1) + " " +
                          shortest_text(file.offsets_mm[f] - file.offsets_mm[f - 1]) + " mm apart, and the first two " +
                          shortest_text(step) + " mm",
                      "resample it to equal steps");
  }
  if (file.directions) {
    grid.axes = axes_of(file);
    if (step < 0)
      for (int r = 0; r < 3; ++r) (*grid.axes)(r, 2) = -(*grid.axes)(r, 2);
  }
  if (file.spacing_mm && step != 0)
    grid.spacing = Vec3{(*file.spacing_mm)[1], (*file.spacing_mm)[0], std::abs(step)};
  else if (file.spacing_mm)
    head.spacing_note = format("%.6g x %.6g mm in its slices", (*file.spacing_mm)[1], (*file.spacing_mm)[0]);
  grid.origin = file.position_mm;
  return grid;
}

// First and count of the longest row of steps that are equal to the usual one.
std::pair<std::size_t, std::size_t> longest_row(const std::vector<double>& along, double step) {
  std::size_t best = 0, best_count = 1;
  for (std::size_t first = 0; first < along.size();) {
    std::size_t last = first;
    while (last + 1 < along.size() && std::abs(along[last + 1] - along[last] - step) <= same_step * step) ++last;
    if (last - first + 1 > best_count) best = first, best_count = last - first + 1;
    first = last + 1;
  }
  return {best, best_count};
}

void check_steps(std::vector<DicomFile>& files, const std::vector<double>& along, double step, const std::string& place,
                 bool accept_gap) {
  const auto name = [&](std::size_t n) { return files[n].path.filename().string(); };
  for (std::size_t n = 1; n < files.size(); ++n)
    if (along[n] - along[n - 1] < 1e-3)
      refuse_volume(place, "has two slices at one place, " + name(n - 1) + " and " + name(n), "leave one of them out");
  const auto [first, count] = longest_row(along, step);
  if (count == files.size()) return;
  if (accept_gap) {
    files = std::vector<DicomFile>(files.begin() + static_cast<std::ptrdiff_t>(first),
                                   files.begin() + static_cast<std::ptrdiff_t>(first + count));
    return;
  }
  for (std::size_t n = 1; n < files.size(); ++n)
    if (const double gap = along[n] - along[n - 1]; std::abs(gap - step) > same_step * step)
      refuse_volume(
          place,
          format("has a gap of %.6g mm between slices %zu and %zu (%s, %s), where %.6g mm are usual", gap, n, n + 1,
                 name(n - 1).c_str(), name(n).c_str(), step),
          format("add what is missing, or take the %zu slices of the longest equal row with --accept-gap", count));
}

// PS3.3, C.7.6.2: slices in order along the normal.
Stack stack_of(std::vector<DicomFile> files, const std::string& place, bool accept_gap) {
  for (const DicomFile& file : files)
    if (!file.position_mm || !file.directions)
      refuse_volume(
          file.path.string(),
          "does not state its place and directions, and is one of " + std::to_string(files.size()) + " slices",
          "export the series anew, with ImagePositionPatient and ImageOrientationPatient");
  Stack stack{.files = {}, .grid = {.unit_m = 1e-3}};
  stack.grid.axes = axes_of(files[0]);
  const Mat3& axes = *stack.grid.axes;
  const Vec3 normal{axes(0, 2), axes(1, 2), axes(2, 2)};
  const auto place_along = [&](const DicomFile& file) { return dot(normal, *file.position_mm); };
  std::stable_sort(files.begin(), files.end(),
                   [&](const DicomFile& a, const DicomFile& b) { return place_along(a) < place_along(b); });
  std::vector<double> along, steps;
  for (const DicomFile& file : files) along.push_back(place_along(file));
  for (std::size_t n = 1; n < along.size(); ++n) steps.push_back(along[n] - along[n - 1]);
  std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2), steps.end());
  const double usual = steps[steps.size() / 2];
  check_steps(files, along, usual, place, accept_gap);
  if (files.size() < 2) refuse_volume(place, "has no two slices at the usual distance");
  const Vec3 first = *files.front().position_mm, last = *files.back().position_mm;
  const double step = dot(normal, last - first) / static_cast<double>(files.size() - 1);
  const double pixel = files[0].spacing_mm ? std::min((*files[0].spacing_mm)[0], (*files[0].spacing_mm)[1]) : step;
  for (const DicomFile& file : files) {
    const Vec3 offset = *file.position_mm - first, sideways = offset - normal * dot(normal, offset);
    if (norm(sideways) > same_step * pixel)
      refuse_volume(file.path.string(),
                    format("lies %.4g mm sideways of the first slice: its axes are not orthogonal (a tilted gantry?)",
                           norm(sideways)),
                    "resample it on a rectangular grid");
  }
  if (files[0].spacing_mm) stack.grid.spacing = Vec3{(*files[0].spacing_mm)[1], (*files[0].spacing_mm)[0], step};
  stack.grid.origin = first;
  stack.files = std::move(files);
  return stack;
}

class DicomVolume : public VolumeSource {
 public:
  DicomVolume(VolumeHead head, std::vector<DicomFile> files) : files_(std::move(files)) {
    head_ = std::move(head);
    for (std::size_t f = 0; f < files_.size(); ++f)
      for (DicomPieces& pieces : dicom_frames(files_[f])) slices_.emplace_back(f, std::move(pieces));
  }
  void read(std::size_t first, std::size_t count, std::span<float> to) override {
    check_slices(head_, first, count, to);
    const std::size_t slice = head_.size[0] * head_.size[1];
    for (std::size_t k = first; k < first + count; ++k) {
      throw_if_interrupted();
      const auto& [f, pieces] = slices_[k];
      const DicomFile& file = files_[f];
      decode_samples(dicom_frame(file, pieces), file.type(), false, file.slope, file.intercept,
                     to.subspan((k - first) * slice, slice));
    }
    check_samples(to, head_, first);
  }

 private:
  std::vector<DicomFile> files_;
  std::vector<std::pair<std::size_t, DicomPieces>> slices_;
};

// Slope and intercept, where all slices have the same; what values mean, where they say so (PS3.3, C.8.2.1: of a CT,
// Hounsfield units unless another type is stated).
void set_scale(const std::vector<DicomFile>& files, VolumeHead& head) {
  const DicomFile& first = files[0];
  const bool same = std::all_of(files.begin(), files.end(), [&](const DicomFile& f) {
    return f.slope == first.slope && f.intercept == first.intercept;
  });
  if (same) {
    head.slope = first.slope;
    head.intercept = first.intercept;
  } else {
    head.type = VoxelType::f32;  // each slice has its own, and the values are what they have in common
  }
  if (first.rescale_type == "HU" || (first.modality == "CT" && first.rescaled && first.rescale_type.empty()))
    head.value = "hounsfield";
}

std::unique_ptr<VolumeSource> open_dicom(const std::filesystem::path& path, const VolumeWish& wish) {
  const std::string place = path.string();
  std::error_code ignored;
  std::vector<DicomFile> files =
      std::filesystem::is_directory(path, ignored) ? series_of_folder(path) : series_of_file(path);
  for (std::size_t n = 1; n < files.size(); ++n) check_alike(files[0], files[n]);
  VolumeHead head{
      .size = {files[0].columns, files[0].rows, 1}, .type = files[0].type(), .format = "DICOM, " + files[0].syntax};
  StatedGrid grid;
  if (files.size() > 1) {
    Stack stack = stack_of(std::move(files), place, wish.accept_gap);
    files = std::move(stack.files);
    grid = stack.grid;
    head.size[2] = files.size();
  } else {
    grid = grid_of_one(files[0], head);
    head.size[2] = files[0].frames;
  }
  for (std::size_t a = 0; a < 3; ++a) checked_side(static_cast<std::int64_t>(head.size[a]), place);
  checked_volume_bytes(head, place);
  for (const DicomFile& file : files) head.files.push_back(file.path);
  check_wish_of_described(head, wish, place);
  settle_grid(grid, wish, head, place);
  set_scale(files, head);
  return std::make_unique<DicomVolume>(std::move(head), std::move(files));
}

}  // namespace

const VolumeFormat& dicom() {
  static const VolumeFormat format{
      .name = "DICOM",
      .sentence =
          "a folder of a series' files, one of them, or a file of many frames: lengths in mm by the standard, "
          "slices in order by their places",
      .mine = may_be_dicom,
      .open = open_dicom,
      .order = 5};
  return format;
}

}  // namespace gonio::io::volumes
