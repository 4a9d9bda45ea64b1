// Volumes: samples on a regular grid, as tomographs and their software store them.
//
// One file a format in io/volumes/, gathered by the build: NRRD (.nrrd, .nhdr), MetaImage (.mha, .mhd), NIfTI-1 (.nii,
// .nii.gz), NumPy (.npy), DICOM series (a folder or one of its files), TIFF stacks (one file of many pages, or a folder
// of slices), an atlas (one picture of tiled slices) and raw samples. Which one a file is says its beginning, not its
// name; the last three do not describe themselves, and VolumeWish does.
//
// Indices count voxels: index (i, j, k) is the centre of a voxel, i along a row, j along the rows of a slice, k along
// the slices, the order in which they are read. `volume_from_index` takes an index to metres in the frame of the
// volume: p_m = origin_m + axes * diag(spacing_m) * index, columns of `axes` being unit vectors. Nothing of it is
// guessed: what neither the file nor the wish says is absent, and Error(data) says how to say it. A spacing counts as
// stated where the file says its unit, or its format's standard does: DICOM's and MetaImage's millimetres, NIfTI's
// xyzt_units, NRRD's units and space units; millimetres, too, in an NRRD with one of the patient's frames, as ITK and
// Slicer write them. All ones without a unit are what programs write that know no spacing: they state nothing.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geom/vector.h"

namespace gonio::io {

enum class VoxelType { u8, i8, u16, i16, u32, i32, f32, f64 };
std::size_t bytes_of(VoxelType type);
const char* name_of(VoxelType type);  // "uint16"

struct VolumeHead {
  std::array<std::size_t, 3> size{};           // voxels: i, j, k
  VoxelType type = VoxelType::u8;              // as stored
  std::optional<Vec3> spacing_m{};             // between centres, positive
  std::optional<Vec3> origin_m{};              // centre of voxel (0, 0, 0)
  std::optional<Mat3> axes{};                  // unit columns, right or left-handed, orthogonal within 1e-4
  double slope = 1, intercept = 0;             // value = slope * stored + intercept
  std::string value{};                         // what values mean, where the file says so: "hounsfield", ...
  std::string format{};                        // "NRRD, gzip"
  std::vector<std::filesystem::path> files{};  // all that were read, the head first
  std::string spacing_note{};  // what the file says of its spacing without stating one: "0.5 x 0.5 x 0.7 of no unit"
  std::size_t voxels() const { return size[0] * size[1] * size[2]; }
};
// The spacing, or Error(data) that says what the file has instead and how to say it.
Vec3 stated_spacing(const VolumeHead& head);

// Where voxels lie: p_m = origin_m + axes * diag(spacing_m) * index.
struct VolumeGrid {
  Vec3 spacing_m{1, 1, 1}, origin_m{};
  Mat3 axes{};
  Vec3 metres(Vec3 index) const { return origin_m + axes * (spacing_m * index); }
  Vec3 along_axes(Vec3 p_m) const { return transposed(axes) * (p_m - origin_m); }  // metres from voxel (0, 0, 0)
  Vec3 index(Vec3 p_m) const {
    const Vec3 along = along_axes(p_m);
    return {along.x / spacing_m.x, along.y / spacing_m.y, along.z / spacing_m.z};
  }
  Vec3 axis(int c) const { return {axes(0, c), axes(1, c), axes(2, c)}; }
  bool left_handed() const { return dot(cross(axis(0), axis(1)), axis(2)) < 0; }  // meshes turn inside out
  double smallest_m() const { return std::min({spacing_m.x, spacing_m.y, spacing_m.z}); }
};
VolumeGrid grid_of(const VolumeHead& head);  // Error(data) as stated_spacing; origin 0 and straight axes where not said

// What the user says beside the files. A statement that contradicts the file is Error(data).
struct VolumeWish {
  std::optional<Vec3> spacing_m{};                    // --voxel 120um or --voxel 0.1mm,0.1mm,0.3mm
  std::optional<std::array<std::size_t, 3>> size{};   // raw: --size 512x512x400
  std::optional<VoxelType> type{};                    // raw: --type uint16
  bool big_endian = false;                            // raw
  std::size_t skip_bytes = 0;                         // raw: before the first sample
  std::optional<std::array<std::size_t, 2>> tiles{};  // atlas: columns and rows of tiles, from the top left
  bool accept_gap = false;                            // DICOM: take the largest stack of equal spacing
};

// An open volume: reads slices in order as floats (value, i.e. after slope and intercept). Reading forwards is fast in
// every format; going back re-opens a compressed stream.
class VolumeSource {
 public:
  virtual ~VolumeSource() = default;
  const VolumeHead& head() const { return head_; }
  // Slices k = first .. first + count - 1 into `to` (count * size[0] * size[1] floats, i fastest). Error(data) where
  // the file ends early or holds what is no number (place: file and slice), Error(io). Not to be called from two
  // threads.
  virtual void read(std::size_t first, std::size_t count, std::span<float> to) = 0;

 protected:
  VolumeHead head_;
};

// Error(no_input | data). Sizes are checked against the file before anything is allocated. No sample is read yet where
// the format allows it.
std::unique_ptr<VolumeSource> open_volume(const std::filesystem::path& path, const VolumeWish& wish = {});

// A volume in memory, for tests, simulators and small crops.
struct VolumeData {
  VolumeHead head{};
  std::vector<float> values{};  // i fastest
  float at(std::size_t i, std::size_t j, std::size_t k) const {
    return values[(k * head.size[1] + j) * head.size[0] + i];
  }
};
VolumeData read_volume(const std::filesystem::path& path, const VolumeWish& wish = {});
std::unique_ptr<VolumeSource> source_of(VolumeData data);
// NRRD, values stored as head.type (Error(data) where one does not fit: out of range, or a fraction in a type of
// integers), raw or gzip; slope and intercept are applied already and not written. Slice by slice: `slice` is asked to
// fill k = 0, 1, ... in this order; the file appears whole or not at all.
void write_nrrd(const std::filesystem::path& path, const VolumeData& volume, bool gzip = false);
void write_nrrd(const std::filesystem::path& path, const VolumeHead& head,
                const std::function<void(std::size_t k, std::span<float> slice)>& slice, bool gzip = false);

// A member of the family: io/volumes/NAME.cpp defines `const VolumeFormat& NAME()`.
struct VolumeFormat {
  const char* name;      // "NRRD"
  const char* sentence;  // one line for the man page
  // Is it mine? `beginning` holds up to 1024 bytes of a file; empty for a folder.
  bool (*mine)(const std::filesystem::path& path, std::string_view beginning, const VolumeWish& wish);
  std::unique_ptr<VolumeSource> (*open)(const std::filesystem::path& path, const VolumeWish& wish);
  int order = 0;  // asked in ascending order; raw, which takes anything, last
};
std::span<const VolumeFormat* const> all_volume_formats();

}  // namespace gonio::io
